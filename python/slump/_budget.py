"""Physics, time step or solver? How much of a number is the grains', and how much the method's."""

from __future__ import annotations

import json
import os
import tempfile
from typing import Any, Sequence

from ._slump import _budget


class Budget(dict):
    """Columns of a table, a row a cause: ``pandas.DataFrame(budget)`` and ``polars.DataFrame(budget)`` read it.

    ``adds`` is what a change adds to the value, ``low`` and ``high`` are the ends of its interval; all intervals of a budget
    hold together in 95 % of budgets. What is not known is None.
    """

    #: What the budget says, by quantity, in words.
    answers: dict[str, str]
    #: "yes", "mostly", "no" or "not-known-yet", by quantity.
    trust: dict[str, str]
    #: All that the budget is made of, as ``budget.json`` has it.
    data: dict[str, Any]

    def __init__(self, data: dict[str, Any]):
        self.data = data
        quantities = data["quantities"]
        self.answers = {one["quantity"]: one["answer"] for one in quantities}
        self.trust = {one["quantity"]: one["trust"] for one in quantities}
        rows: list[dict[str, Any]] = []
        for one in quantities:
            value = {"share": "grains", "cause": "value itself", "changed": "", "starts": one["starts"]}
            limit = {"share": "method", "cause": "time step", "changed": "Δt → 0", "starts": one["starts"]}
            all_rows = [(value, one["value"])] + [(cause, cause["adds"]) for cause in one["causes"]]
            if one["limit_adds"] is not None:
                all_rows.append((limit, one["limit_adds"]))
            for row, ends in all_rows:
                adds, low, high = ends or (None, None, None)
                named = {"quantity": one["quantity"], **{name: row.get(name) for name in _OF_CAUSE}}
                rows.append({**named, "adds": adds, "low": low, "high": high})
        super().__init__({name: [row[name] for row in rows] for name in rows[0]})

    def __str__(self) -> str:
        return "\n\n".join(self.answers.values())

    __repr__ = __str__


_OF_CAUSE = ("share", "cause", "changed", "starts", "unsolved", "cost", "failure")


def budget(
    scene: str | os.PathLike[str] | None = None,
    quantity: str | Sequence[str] = "slump",
    *,
    begin: float | None = None,
    end: float | None = None,
    within: float | None = None,
    cost: float = 300.0,
    out: str | os.PathLike[str] | None = None,
    **options: Any,
) -> Budget:
    """How much of a number the grains make, how much the contact law, the time step and the solver.

    ``quantity`` is a column of what a run measures (``"slump"``, ``"coordination"``) for its last value, or
    ``"mean(x)"``, ``"min(x)"``, ``"max(x)"``, ``"total(x)"`` over the simulated time from ``begin`` to ``end`` (s).
    ``within`` is half the width that every interval is to have, a tenth of the value where it is None; ``cost`` the time to
    take on all cores (s). With a folder ``out`` the same call goes on where it was stopped. Further options are those of
    :class:`Simulation`.
    """
    quantities = [quantity] if isinstance(quantity, str) else list(quantity)
    if scene is not None:
        options["scene"] = scene
    with tempfile.TemporaryDirectory() as folder:
        place = folder if out is None else os.fspath(out)
        said = _budget(quantities, place, cost, begin=begin, end=end, within=within, **options)
    return Budget(json.loads(said))
