from collections.abc import Callable, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, Literal, TypedDict

import numpy as np
import numpy.typing as npt
from typing_extensions import Self, Unpack, disjoint_base

from ._solution import FoundSolution, Solution

__all__ = [
    "scene",
    "_budget",
    "_kinds",
    "_restored",
    "methods",
    "options",
    "scenes",
    "solutions",
    "steppers",
    "solve",
    "Simulation",
    "__version__",
]

__version__: str

_Numbers = npt.NDArray[np.float64]
_Table = dict[str, npt.NDArray[Any]]
_Path = str | PathLike[str]
_Scene = _Path | Mapping[str, Any]
_Initial = _Path | Mapping[str, npt.ArrayLike] | Any
_Float = float | np.floating[Any] | np.integer[Any]
_Int = int | np.integer[Any]
_Bool = bool | np.bool_

# Settings: written by the test that compares them with the program's (SLUMP_BLESS=1 pytest python/tests/test_types.py).
class _Settings(TypedDict):
    stepper: Literal["moreau", "range", "tgs-soft", "avbd", "dem"]
    bond: float
    bond_acceleration: float
    dt: float
    rho: float
    mu: float
    cone: Literal["shifted", "compressive"]
    rolling_friction: float
    restitution_threshold: float
    debonding_distance: float
    touch_tolerance: float
    tilt: float
    stiffness: float
    damping_ratio: float
    substeps: int
    solver: Literal["nsgs", "nsgs-parallel", "newton", "nncg", "apgd", "admm", "jacobi", "interior-point", "auto"]
    ordering: Literal["interleaved", "detected", "bottom-up", "symmetric", "coloured"]
    stop: Literal["relative-change", "impulse-per-mass", "residual", "velocity-error"]
    tolerance: float
    max_sweeps: int
    warm_start: bool
    friction_model: Literal["coulomb", "tresca", "associated", "desaxce"]
    model_solves: int
    push_out: bool
    max_travel: float
    sequential_impacts: bool
    speculative: bool
    turning_bonds: bool

class _Changes(TypedDict, total=False):
    stepper: Literal["moreau", "range", "tgs-soft", "avbd", "dem"] | None
    bond: _Float | None
    bond_acceleration: _Float | None
    dt: _Float | None
    rho: _Float | None
    mu: _Float | None
    cone: Literal["shifted", "compressive"] | None
    rolling_friction: _Float | None
    restitution_threshold: _Float | None
    debonding_distance: _Float | None
    touch_tolerance: _Float | None
    tilt: _Float | None
    stiffness: _Float | None
    damping_ratio: _Float | None
    substeps: _Int | None
    solver: Literal["nsgs", "nsgs-parallel", "newton", "nncg", "apgd", "admm", "jacobi", "interior-point", "auto"] | None
    ordering: Literal["interleaved", "detected", "bottom-up", "symmetric", "coloured"] | None
    stop: Literal["relative-change", "impulse-per-mass", "residual", "velocity-error"] | None
    tolerance: _Float | None
    max_sweeps: _Int | None
    warm_start: _Bool | None
    friction_model: Literal["coulomb", "tresca", "associated", "desaxce"] | None
    model_solves: _Int | None
    push_out: _Bool | None
    max_travel: _Float | None
    sequential_impacts: _Bool | None
    speculative: _Bool | None
    turning_bonds: _Bool | None

class _Attributes:
    stepper: Literal["moreau", "range", "tgs-soft", "avbd", "dem"]
    bond: float
    bond_acceleration: float
    dt: float
    rho: float
    mu: float
    cone: Literal["shifted", "compressive"]
    rolling_friction: float
    restitution_threshold: float
    debonding_distance: float
    touch_tolerance: float
    tilt: float
    stiffness: float
    damping_ratio: float
    substeps: int
    solver: Literal["nsgs", "nsgs-parallel", "newton", "nncg", "apgd", "admm", "jacobi", "interior-point", "auto"]
    ordering: Literal["interleaved", "detected", "bottom-up", "symmetric", "coloured"]
    stop: Literal["relative-change", "impulse-per-mass", "residual", "velocity-error"]
    tolerance: float
    max_sweeps: int
    warm_start: bool
    friction_model: Literal["coulomb", "tresca", "associated", "desaxce"]
    model_solves: int
    push_out: bool
    max_travel: float
    sequential_impacts: bool
    speculative: bool
    turning_bonds: bool
# Settings end.

class _Options(_Changes, total=False):
    initial_step: _Int | None
    grains: _Int | None
    box_width: _Float | None
    base_width: _Float | None
    seed: _Int | None
    deposition: Literal["rain", "drop-and-roll"] | None
    sizes: str | None
    start: _Float | None
    preset: Literal["paper", "robust"] | None
    duration: _Float | None

@disjoint_base
class Simulation(_Attributes):
    def __new__(
        cls,
        scene: _Scene | None = None,
        *,
        initial: _Initial | None = None,
        restart: _Path | None = None,
        **options: Unpack[_Options],
    ) -> Self: ...
    def step(self, steps: _Int = 1, callback: Callable[[Simulation], object] | None = None) -> None: ...
    def run(
        self,
        *,
        until: _Float | None = None,
        callback: Callable[[Simulation], object] | None = None,
        every: _Float | None = None,
    ) -> None: ...
    def change(self, **settings: Unpack[_Changes]) -> None: ...
    def copy(self) -> Simulation: ...
    def __copy__(self) -> Simulation: ...
    def __deepcopy__(self, _memo: Any) -> Simulation: ...
    def save(self, path: _Path) -> None: ...
    def __reduce__(self) -> tuple[Callable[[bytes], Simulation], tuple[bytes]]: ...
    def set_positions(self, positions: Any) -> None: ...
    def set_velocities(self, velocities: Any) -> None: ...
    def add_grain(self, x: _Float, y: _Float, radius: _Float, vx: _Float = 0.0, vy: _Float = 0.0) -> None: ...
    def remove_grain(self, i: _Int) -> None: ...
    def begin_pairs(self) -> None: ...
    def fields(self, width: _Float | None = None) -> dict[str, Any]: ...
    def _repr_html_(self) -> str: ...
    def record(
        self,
        folder: _Path,
        every: _Float = 0.04,
        formats: Sequence[Literal["parquet", "csv", "vtk", "ovito", "fields"]] | None = None,
        overwrite: _Bool = False,
    ) -> None: ...
    def end_recording(self) -> None: ...
    def next_problem(self) -> dict[str, Any]: ...
    def forget_history(self) -> None: ...
    @property
    def settings(self) -> _Settings: ...
    @property
    def observables(self) -> dict[str, int | float | bool]: ...
    @property
    def history(self) -> _Table: ...
    @property
    def grains(self) -> _Table: ...
    @property
    def contacts(self) -> _Table: ...
    @property
    def walls(self) -> _Table: ...
    @property
    def pairs(self) -> _Table: ...
    @property
    def body_forces(self) -> _Numbers: ...
    @body_forces.setter
    def body_forces(self, forces: Any) -> None: ...
    @property
    def measures(self) -> dict[str, int | float | bool]: ...
    @property
    def histograms(self) -> _Table: ...
    @property
    def forces(self) -> _Numbers: ...
    @property
    def positions(self) -> _Numbers: ...
    @property
    def velocities(self) -> _Numbers: ...
    @property
    def angles(self) -> _Numbers: ...
    @property
    def angular_velocities(self) -> _Numbers: ...
    @property
    def radii(self) -> _Numbers: ...
    @property
    def masses(self) -> _Numbers: ...
    @property
    def boundaries(self) -> list[dict[str, Any]]: ...
    @property
    def alarms(self) -> list[str]: ...
    @property
    def recording(self) -> Path | None: ...
    @property
    def name(self) -> str: ...
    @property
    def duration(self) -> float: ...
    @property
    def mean_diameter(self) -> float: ...
    @property
    def gravity(self) -> float: ...
    @property
    def time(self) -> float: ...
    @property
    def steps(self) -> int: ...

def scene(
    scene: _Scene | None = None, *, initial: _Initial | None = None, **options: Unpack[_Options]
) -> dict[str, Any]: ...
def scenes() -> dict[str, str]: ...
def steppers() -> dict[str, str]: ...
def methods() -> dict[str, str]: ...
def options() -> dict[str, str]: ...
def _restored(saved: bytes) -> Simulation: ...
def _kinds() -> dict[str, str | list[str]]: ...
def _budget(
    quantities: Sequence[str],
    folder: _Path,
    cost_secs: float,
    *,
    begin: float | None = None,
    end: float | None = None,
    within: float | None = None,
    **options: Any,
) -> str: ...
def solutions(
    problem: _Path | Mapping[str, Any],
    starts: _Int = 8,
    tolerance: _Float = 1e-8,
    max_sweeps: _Int = 1_000_000,
) -> list[FoundSolution]: ...
def solve(
    problem: _Path | Mapping[str, Any],
    method: str = "auto",
    tolerance: _Float = 1e-8,
    max_sweeps: _Int = 1_000_000,
    repeat: _Int = 1,
    without_bodies: _Bool = False,
) -> Solution: ...
