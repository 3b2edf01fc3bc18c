"""Reads the VTK files with PyVista, and compares points, lines, arrays, times and metadata with the CSV files."""

import sys

import numpy
import pyvista

from recording import OF_FRAME, codes, flags, frames, kinds, table

# Columns that are components of a vector: name of the vector, and number of the component.
VECTORS = {
    "vx": ("velocity", 0), "vy": ("velocity", 1), "nx": ("normal", 0), "ny": ("normal", 1),
    "fx": ("force", 0), "fy": ("force", 1),
}
POINT = {"x": ("point", 0), "y": ("point", 1)}


def main(recording):
    tables = {name: table(recording, name) for name in ["grains", "contacts"]}
    all_flags = {column for name in tables for column, kind in kinds(recording, name).items() if kind == "flag"}
    measures = table(recording, "measures")
    wanted = frames(recording)
    readers = {name: pyvista.get_reader(f"{recording}/vtk/{name}.pvd") for name in tables}
    for name, reader in readers.items():
        assert list(reader.time_values) == list(wanted["time"]), name
    for _, (step, time, _) in wanted.iterrows():
        grains, contacts = (read(readers[name], time) for name in tables)
        rows = {name: every[every["step"] == step] for name, every in tables.items()}
        for mesh in [grains, contacts]:
            assert mesh.field_data["step"][0] == step and mesh.field_data["TimeValue"][0] == time
            described(mesh)
        assert grains.n_points == grains.n_cells == len(rows["grains"]) and grains.n_lines == 0
        assert same(grains.points[:, :2], rows["grains"][["x", "y"]].to_numpy()) and not grains.points[:, 2].any()
        compare(grains, grains.point_data, rows["grains"].drop(columns=["x", "y"]), VECTORS, all_flags)
        of_pile = measures[measures["step"] == step].drop(columns=OF_FRAME).iloc[0]
        for column, value in of_pile.items():
            assert same(grains.field_data[f"pile_{column}"], [value]), column
        assert contacts.n_lines == contacts.n_cells == len(rows["contacts"]) > 0
        compare(contacts, contacts.cell_data, rows["contacts"], VECTORS | POINT, all_flags)
        ends(contacts, grains, rows["contacts"])
        assert grains.active_scalars_name == "radius" and contacts.active_scalars_name == "normal_force"
    fields(recording, wanted, tables["grains"], table(recording, "contacts"))
    glyphs = grains.glyph(scale="radius", orient=False, geom=pyvista.Disc(inner=0, outer=1, c_res=12))
    assert glyphs.n_cells == 12 * grains.n_points
    print(f"PyVista {pyvista.__version__} with VTK {pyvista.vtk_version_info} reads {recording}")


def fields(recording, wanted, of_grains, of_contacts):
    reader = pyvista.get_reader(f"{recording}/fields/fields.pvd")
    assert list(reader.time_values) == list(wanted["time"])
    for _, (step, time, _) in wanted.iterrows():
        image = read(reader, time)
        assert isinstance(image, pyvista.ImageData) and image.field_data["step"][0] == step
        described(image)
        rows = of_grains[(of_grains["step"] == step) & (of_grains["kind"] == "grain")]
        area = image.spacing[0] * image.spacing[1]
        assert numpy.isclose(image.spacing, [*2 * [image.field_data["smoothing_width"][0] / 2], 1], rtol=0.1).all()
        masses = rows["mass"].to_numpy()
        assert numpy.isclose(area * image["density"].sum(), masses.sum(), rtol=1e-12)
        # The grid of the fields must be at the position of the grains.
        centre = (image["density"][:, None] * image.cell_centers().points).sum(axis=0) / image["density"].sum()
        off = numpy.abs(centre[:2] - numpy.average(rows[["x", "y"]], axis=0, weights=masses))
        if (rows[["x", "y"]] == rows[["x_unwrapped", "y_unwrapped"]].to_numpy()).all(axis=None):
            assert (off < 0.02 * image.spacing[0]).all(), off
        rows = of_contacts[of_contacts["step"] == step]
        assert image["contact_stress_yy"].any() == bool(rows["fy"].any())


def read(reader, time):
    reader.set_active_time_value(time)
    return reader.read()[0]


def same(found, wanted):
    """Return true if numbers are bitwise equal, including missing values."""
    found, wanted = (numpy.ascontiguousarray(it, dtype=float) for it in (found, wanted))
    return found.shape == wanted.shape and (
        (found.view(numpy.int64) == wanted.view(numpy.int64)) | (numpy.isnan(found) & numpy.isnan(wanted))
    ).all()


def compare(mesh, arrays, rows, vectors, all_flags):
    names = set()
    for column in rows.columns.difference(OF_FRAME):
        name, component = vectors.get(column, (column, None))
        names.add(name)
        values = arrays[name] if component is None else arrays[name][:, component]
        if f"{column}_words" in mesh.field_data:
            wanted = codes(list(mesh.field_data[f"{column}_words"]), rows[column])
        elif column in all_flags:
            wanted = flags(rows[column])
        else:
            wanted = rows[column].to_numpy()
        assert same(values, wanted), (column, values[:3], wanted[:3])
        if component is not None:
            assert not arrays[name][:, 2].any(), name
    assert names == set(arrays.keys()), (names, arrays.keys())


def described(mesh):
    said = list(mesh.field_data["columns"])
    assert any(words.startswith(("radius [m]:", "gap [m]:", "density [kg")) for words in said), said
    about = list(mesh.field_data["about"])
    assert about[0].startswith("program: slump "), about
    assert any(words.startswith("parameters.time_step_secs: ") for words in about), about


def ends(contacts, grains, rows):
    """Check that lines go from grain i to disc j, or to a point of a boundary near the contact point."""
    lines = contacts.lines.reshape(-1, 3)[:, 1:]
    assert (lines.ravel() == numpy.arange(2 * len(rows))).all()
    starts, stops = contacts.points[lines[:, 0]], contacts.points[lines[:, 1]]
    assert same(starts, grains.points[rows["id_i"].to_numpy()])
    on_discs = (rows["kind_j"] != "boundary").to_numpy()
    assert same(stops[on_discs], grains.points[rows["id_j"].to_numpy()[on_discs]])
    near = numpy.linalg.norm(stops - contacts.cell_data["point"], axis=1)[~on_discs]
    radii = grains.point_data["radius"][rows["id_i"].to_numpy()[~on_discs]]
    assert (near < 0.1 * radii).all(), near


main(sys.argv[1])
