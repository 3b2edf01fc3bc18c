"""Contact Dynamics of cohesive grains, from Python.

    import slump

    sim = slump.Simulation("pile", bond=20, dt=1e-3)
    sim.run()
    print(sim.observables["slump"])

Options have the names of the command line, with underscores: ``slump.options()`` lists them. All quantities are in
SI units.
"""

from __future__ import annotations

from . import _settings
from ._budget import Budget, budget
from ._errors import Error, FileError, InputError, NotFiniteError, SlumpWarning
from ._slump import Simulation, __version__, methods, options, scene, scenes, solutions, solve, steppers
from ._solution import FoundSolution, Solution

__all__ = [
    "Budget",
    "Error",
    "FileError",
    "FoundSolution",
    "InputError",
    "NotFiniteError",
    "Simulation",
    "SlumpWarning",
    "Solution",
    "__version__",
    "budget",
    "methods",
    "options",
    "scene",
    "scenes",
    "solutions",
    "solve",
    "steppers",
]

_settings.add()
