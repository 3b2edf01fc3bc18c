//! Tests of `.vtp` files: the XML, and bitwise equality of all numbers.

use glam::DVec2;
use slump::world::Boundary;

use super::{THIRD, after, go_on, moment, start, write_frames};
use crate::program::*;

const GRAINS: &str = r#"<?xml version="1.0"?>
<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian" header_type="UInt64">
  <PolyData>
    <FieldData>
      <DataArray type="Int64" Name="step" NumberOfTuples="1" format="ascii">10</DataArray>
      <DataArray type="Float64" Name="TimeValue" NumberOfTuples="1" format="ascii">1.0</DataArray>
      <Array type="String" Name="columns" NumberOfTuples="27" format="appended" offset="…
      <Array type="String" Name="about" NumberOfTuples="2" format="appended" offset="…
      <Array type="String" Name="kind_words" NumberOfTuples="3" format="appended" offset="…
      <Array type="String" Name="material_words" NumberOfTuples="1" format="appended" offset="…
      <DataArray type="Int64" Name="pile_grains" NumberOfTuples="1" format="appended" offset="…
…
      <DataArray type="Float64" Name="pile_mean_stress_yy" NumberOfTuples="1" format="appended" offset="…
      <DataArray type="Int64" Name="wall_id" NumberOfTuples="2" format="appended" offset="…
…
      <DataArray type="Float64" Name="wall_work_between" NumberOfTuples="2" format="appended" offset="…
    </FieldData>
    <Piece NumberOfPoints="4" NumberOfVerts="4" NumberOfLines="0" NumberOfStrips="0" NumberOfPolys="0">
      <PointData Scalars="radius">
        <DataArray type="Int64" Name="id" NumberOfComponents="1" format="appended" offset="…
        <DataArray type="Float64" Name="angle" NumberOfComponents="1" format="appended" offset="…
        <DataArray type="Float64" Name="velocity" NumberOfComponents="3" ComponentName0="vx" ComponentName1="vy" ComponentName2="z" format="appended" offset="…
        <DataArray type="Float64" Name="omega" NumberOfComponents="1" format="appended" offset="…
        <DataArray type="Float64" Name="radius" NumberOfComponents="1" format="appended" offset="…
        <DataArray type="Float64" Name="mass" NumberOfComponents="1" format="appended" offset="…
        <DataArray type="Int32" Name="kind" NumberOfComponents="1" format="appended" offset="…
        <DataArray type="Float64" Name="x_unwrapped" NumberOfComponents="1" format="appended" offset="…
        <DataArray type="Float64" Name="y_unwrapped" NumberOfComponents="1" format="appended" offset="…
        <DataArray type="Int32" Name="material" NumberOfComponents="1" format="appended" offset="…
        <DataArray type="Float64" Name="coordination" NumberOfComponents="1" format="appended" offset="…
        <DataArray type="Int8" Name="rattler" NumberOfComponents="1" format="appended" offset="…
…
      </PointData>
      <CellData></CellData>
      <Points>
        <DataArray type="Float64" Name="Points" NumberOfComponents="3" ComponentName0="x" ComponentName1="y" ComponentName2="z" format="appended" offset="0"/>
      </Points>
      <Verts>
        <DataArray type="Int64" Name="connectivity" NumberOfComponents="1" format="appended" offset="…
        <DataArray type="Int64" Name="offsets" NumberOfComponents="1" format="appended" offset="…
      </Verts>
    </Piece>
  </PolyData>
  <AppendedData encoding="raw">
   _"#;

/// A `.vtp` file: its XML text, and the binary data that follow the XML.
struct File {
    xml: String,
    data: Vec<u8>,
}

impl File {
    fn read(path: &Path) -> Self {
        let bytes = bytes(path);
        let start = bytes.windows(2).position(|two| two == b"_\x60" || two == b"_\x90");
        let start = start.expect("the points' length behind the underscore") + 1;
        let xml = String::from_utf8(bytes[..start].to_vec()).expect("text");
        let data = bytes[start..].strip_suffix(b"\n  </AppendedData>\n</VTKFile>\n");
        Self { xml, data: data.expect("the closing tags").to_vec() }
    }

    fn bytes(&self, name: &str) -> &[u8] {
        let line = self.xml.lines().find(|line| line.contains(&format!("Name=\"{name}\"")));
        let (_, offset) = line.expect(name).split_once("offset=\"").expect("an offset");
        let offset: usize = offset.trim_end_matches("\"/>").parse().expect("an offset");
        let (length, rest) = self.data[offset..].split_at(8);
        let length = u64::from_le_bytes(length.try_into().expect("8 bytes"));
        &rest[..length as usize]
    }

    fn numbers(&self, name: &str) -> Vec<f64> {
        let (numbers, rest) = self.bytes(name).as_chunks();
        assert!(rest.is_empty(), "{name}");
        numbers.iter().map(|&number| f64::from_le_bytes(number)).collect()
    }

    fn wholes(&self, name: &str) -> Vec<i64> {
        self.bytes(name).as_chunks().0.iter().map(|&number| i64::from_le_bytes(number)).collect()
    }

    fn words(&self, name: &str) -> Vec<String> {
        let text = String::from_utf8(self.bytes(name).to_vec()).expect("text");
        text.strip_suffix('\0').expect("an end").split('\0').map(str::to_owned).collect()
    }
}

fn second_frame(kind: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = folder();
    write_frames(&mut start(folder.path()), 0..2);
    let path = folder.path().join(format!("vtk/{kind}_000001.vtp"));
    (folder, path)
}

/// Checks that two lists of numbers have the same bit patterns, so that −0 differs from 0.
fn assert_same(found: &[f64], expected: &[f64], name: &str) {
    let bits = |numbers: &[f64]| numbers.iter().map(|number| number.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(found), bits(expected), "{name}: {found:?} of {expected:?}");
}

#[test]
fn grains_are_points_with_every_column() {
    let (_folder, path) = second_frame("grains");
    let file = File::read(&path);
    assert_eq!(after(&(file.xml.clone() + "\n"), GRAINS), "");
    let points = [0.0, 0.25, 0.0, 1.0, 0.25, 0.0, -1e6, 0.0, 0.0, 0.0, -1.0, 0.0];
    assert_same(&file.numbers("Points"), &points, "Points");
    assert_same(&file.numbers("radius"), &[0.5, THIRD, 0.5, 0.75], "radius");
    assert_same(&file.numbers("angle"), &[-0.0, -0.0, -0.0, 0.0], "angle");
    assert_same(&file.numbers("velocity")[..4], &[THIRD, -2e-9, 0.0, THIRD], "velocity");
    assert_same(&file.numbers("omega"), &[1e22, 1e22, 1e22, 0.0], "omega");
    assert_same(&file.numbers("mass"), &[0.125, 0.125, 0.125, f64::NAN], "mass");
    assert_eq!(file.wholes("id"), [0, 1, 2, 3]);
    assert_eq!(file.wholes("offsets"), [1, 2, 3, 4]);
    assert_eq!(file.words("about"), ["program: slump", "bond: 20 <&> 30"]);
    assert_eq!(file.words("columns")[1], "x [m]: centre");
    assert_eq!(file.words("kind_words"), ["grain", "fixed", "lost"]);
    assert_eq!(file.bytes("kind"), [0, 0, 2, 1].map(i32::to_le_bytes).concat());
    assert_eq!(file.wholes("pile_grains"), [2]);
    assert_eq!(file.numbers("pile_coordination"), [2.0]);
    assert_same(&file.numbers("coordination"), &[2.0, 2.0, 0.0, f64::NAN], "coordination");
}

#[test]
fn contacts_are_lines_from_centre_to_centre_or_to_the_touched_point() {
    let (_folder, path) = second_frame("contacts");
    let file = File::read(&path);
    let lines = [
        [0.0, 0.25, 0.0, 1.0, 0.25, 0.0],
        [0.0, 0.25, 0.0, 0.0, -1.0, 0.0],
        [1.0, 0.25, 0.0, 1.0, -0.25, 0.0],
    ];
    assert_same(&file.numbers("Points"), &lines.concat(), "Points");
    assert_eq!(file.wholes("connectivity"), [0, 1, 2, 3, 4, 5]);
    assert_eq!(file.wholes("offsets"), [2, 4, 6]);
    assert!(file.xml.contains("NumberOfLines=\"3\""), "{}", file.xml);
    assert_same(&file.numbers("gap"), &[-5e-324; 3], "gap");
    assert_same(&file.numbers("normal_force"), &[THIRD; 3], "normal_force");
    assert_same(&file.numbers("tangential_force"), &[-1.5; 3], "tangential_force");
    assert_same(&file.numbers("point")[..3], &[0.5, 0.25, 0.0], "point");
    assert_same(&file.numbers("normal")[3..6], &[0.0, 1.0, 0.0], "normal");
    assert_eq!(file.wholes("id_j"), [1, 3, 4]);
    assert_eq!(file.wholes("age"), [10; 3]);
    assert_eq!(file.bytes("bond"), [0xff; 3], "a law without bonds");
    assert_eq!(file.words("status_words"), ["open", "stick", "slip"]);
    assert_eq!(file.words("name_j_words"), ["", "half-space 0"]);
    assert_eq!(file.bytes("name_j"), [0, 0, 1].map(i32::to_le_bytes).concat());
}

const DUMPED_GRAINS: &str = "\
ITEM: TIMESTEP
0
ITEM: NUMBER OF ATOMS
4
ITEM: BOX BOUNDS ss ss ss
-0.75 1.3333333333333333
-1.75 0.75
-0.75 0.75
ITEM: ATOMS id type element x y z radius vx vy vz omegaz coordination_number angle mass …
0 1 H 0.0 0.25 0.0 0.5 0.3333333333333333 -2e-9 0.0 1e22 2.0 -0.0 0.125 …
1 1 H 1.0 0.25 0.0 0.3333333333333333 0.3333333333333333 -2e-9 0.0 1e22 2.0 -0.0 0.125 …
2 3 Li -1000000.0 0.0 0.0 0.5 0.3333333333333333 -2e-9 0.0 1e22 0.0 -0.0 0.125 …
3 2 He 0.0 -1.0 0.0 0.75 0.0 0.0 0.0 0.0 NaN 0.0 NaN …
";
/// First lines of the second frame in a dump of grains. A frame has eight head lines, a line with the names of the
/// columns, and one line per disc. The program MDAnalysis finds frames by this number of lines.
const SECOND_HEAD: &str = "ITEM: TIMESTEP\n10\nITEM: NUMBER OF ATOMS\n4\n";

const DUMPED_CONTACTS: &str = "\
ITEM: TIME
0.0
ITEM: TIMESTEP
0
ITEM: NUMBER OF BONDS
2
ITEM: BOX BOUNDS ss ss ss
-0.75 1.3333333333333333
-1.75 0.75
-0.75 0.75
ITEM: BONDS batom1 batom2 kind_j x y nx ny gap normal_force tangential_force status bond stretch age fx fy
0 1 0 0.5 0.25 -1.0 -0.0 -5e-324 0.3333333333333333 -1.5 2 -1 NaN 0 -0.3333333333333333 1.5
0 3 1 0.5 0.25 0.0 1.0 -5e-324 0.3333333333333333 -1.5 2 -1 NaN 0 -0.3333333333333333 1.5
";

#[test]
fn dumps_say_this() {
    let folder = folder();
    write_frames(&mut start(folder.path()), 0..2);
    let read = |name: &str| read(folder.path().join("ovito").join(name));
    let grains = read("grains.dump");
    let rest = after(&grains, DUMPED_GRAINS);
    assert!(rest.starts_with(SECOND_HEAD), "{rest}");
    assert_eq!(rest.lines().count(), 9 + 4);
    let contacts = read("contacts.dump");
    let words = "status: status under the contact law and friction (0 open, 1 stick, 2 slip)";
    assert!(contacts.contains(&format!("; {words}; ")), "{contacts}");
    after(
        &contacts,
        &format!(
            "ITEM: UNITS\nsi\nITEM: PARAMETERS\nprogram: slump; …\n…\n\
             grains: id: number of the disc, the same in all frames: grains first, then fixed discs, boundaries, and grains that were added later; type: grain, fixed (a fixed disc), …\n\
             walls: id: number of the wall; …\n{DUMPED_CONTACTS}"
        ),
    );
    let walls = read("walls.dump");
    assert!(
        walls.starts_with("ITEM: TIME\n0.0\nITEM: TIMESTEP\n0\nITEM: NUMBER OF ENTRIES\n2\n"),
        "{walls}"
    );
}

const FORM: &str = "a file of discs (CSV or Parquet), or a folder that --data wrote as either";

#[track_caller]
fn assert_refused(path: &Path, reason: &str) {
    let said = sentence(slump("--headless --data no --initial").arg(path));
    assert_eq!(said, format!("slump: {}: {reason}, but must be {FORM}", path.display()));
}

#[test]
fn what_is_written_for_other_programs_is_refused_as_an_initial_state() {
    let folder = folder();
    write_frames(&mut start(folder.path()), 0..2);
    for name in ["vtk/grains.pvd", "vtk/grains_000001.vtp"] {
        assert_refused(&folder.path().join(name), "is a file of VTK");
    }
    let bare = folder.path().join("bare.vtp");
    write(&bare, "<VTKFile type=\"PolyData\"></VTKFile>");
    assert_refused(&bare, "is a file of VTK");
    assert_refused(&folder.path().join("ovito/grains.dump"), "is a LAMMPS dump");
    assert_refused(folder.path(), "has grains for other programs alone");
}

/// Returns the numbers with these two names from the file of smoothed fields of frame `number`.
fn of_fields(folder: &Path, number: usize, names: [&str; 2]) -> [f64; 2] {
    let file = bytes(folder.join(format!("fields/fields_{number:06}.vti")));
    let text = String::from_utf8_lossy(&file);
    names.map(|name| {
        let (_, rest) = text.split_once(&format!("Name=\"{name}\"")).expect(name);
        let (_, number) = rest.split_once('>').expect("a number");
        number.split('<').next().and_then(|number| number.parse().ok()).expect("a number")
    })
}

#[test]
fn all_frames_have_one_smoothing_width_and_leave_out_what_flies_off() {
    let mut far = moment(10);
    far.grains[1].position.x = 1e6;
    let names = ["smoothing_width", "left_out_grains"];
    let [straight, resumed, far_at_first] = [(); 3].map(|()| folder());
    let mut recording = start(straight.path());
    recording.add(moment(0)).expect("a frame");
    recording.add(far.clone()).expect("a frame");
    recording.finish().expect("files");
    assert_eq!(of_fields(straight.path(), 0, names), [1.0, 0.0]);
    assert_eq!(of_fields(straight.path(), 1, names), [1.0, 1.0]);
    let length =
        |number| bytes(straight.path().join(format!("fields/fields_00000{number}.vti"))).len();
    assert!(length(1) < 9 * length(0), "as far as the room reaches, and no farther: {}", length(1));
    // A resumed recording smooths its fields over the width that its first frame used.
    write_frames(&mut start(resumed.path()), 0..1);
    let mut recording = go_on(resumed.path(), 0);
    recording.add(far.clone()).expect("a frame");
    recording.finish().expect("files");
    let last = "fields/fields_000001.vti";
    assert!(bytes(resumed.path().join(last)) == bytes(straight.path().join(last)));
    // If grains are far apart in the first frame, the fields contain all of them and are smoothed over a larger width.
    let mut recording = start(far_at_first.path());
    recording.add(far).expect("a frame");
    recording.add(moment(20)).expect("a frame");
    recording.finish().expect("files");
    let [[first, none], second] =
        [0, 1].map(|number| of_fields(far_at_first.path(), number, names));
    assert!(first > 1.0 && first < 100.0 && none == 0.0, "{first}");
    assert_eq!(second, [first, 0.0]);
}

#[test]
fn grains_that_leave_the_fields_are_told_of_once() {
    let folder = folder();
    let mut scene = slump::scene::built_in("collision").expect("a scene");
    // If the only wall is infinite, no grain is lost at any distance.
    scene.fixed_discs.clear();
    scene.boundaries = vec![Boundary::HalfSpace { point: DVec2::new(-1.0, 0.0), normal: DVec2::X }];
    let away = 1e4 * scene.mean_diameter / scene.parameters.time_step_secs;
    scene.grains[0].velocity = DVec2::new(away, 0.0);
    let path = folder.path().join("scene.toml");
    write(&path, slump::config::scene_to_toml(&scene).expect("TOML"));
    let every = scene.parameters.time_step_secs.to_string();
    let duration = (4.0 * scene.parameters.time_step_secs).to_string();
    let mut command = slump("run --data-format fields");
    command.args([text(&path), "--data-every", &every, "--duration", &duration]);
    let said = succeed(command.arg("--data").arg(folder.path().join("data")));
    let told = said.lines().filter(|line| line.contains("which fields cover")).count();
    assert_eq!(told, 1, "{said}");
    assert!(said.contains("fields: 1 grain left the box from ("), "{said}");
}
