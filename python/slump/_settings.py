"""Makes every setting an attribute of the class `Simulation`."""

from __future__ import annotations

from typing import Any

from ._slump import Simulation, _kinds, options


def _setting(name: str, about: str) -> property:
    def read(simulation: Any) -> Any:
        return simulation.settings[name]

    def write(simulation: Any, value: Any) -> None:
        simulation.change(**{name: value})

    return property(read, write, doc=about)


def add() -> None:
    """Add an attribute for each setting to the class `Simulation`."""
    about = options()
    for name in _kinds():
        setattr(Simulation, name, _setting(name, about[name]))
