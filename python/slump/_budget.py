"""Error budgets: how much of a result is due to the initial state, the contact law, the time step and the solver."""

from __future__ import annotations

import json
import os
import tempfile
from typing import Any, Sequence

from ._slump import _budget


class Budget(dict):
    """An error budget: a table with one row per cause, as a dictionary of columns for ``pandas.DataFrame`` or
    ``polars.DataFrame``.

    ``adds`` is the effect of a cause on the value. ``low`` and ``high`` are the ends of the confidence interval of this
    effect: in 95 % of budgets all intervals contain the true effects. Unknown values are None.
    """

    #: Result of the budget in words, by quantity.
    answers: dict[str, str]
    #: Whether the value can be trusted ("yes", "mostly", "no" or "not-known-yet"), by quantity.
    trust: dict[str, str]
    #: All data of the budget, in the format of the file ``budget.json``.
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
    """Estimate how much of a result is due to the initial state, the contact law, the time step and the solver.

    ``quantity`` is a measured column (``"slump"``, ``"coordination"``) at the end of a run, or its ``"mean(x)"``,
    ``"min(x)"``, ``"max(x)"`` or ``"total(x)"`` over the simulated time from ``begin`` to ``end`` (s). ``within`` is
    half of the width that each confidence interval should have (default: a tenth of the value). ``cost`` is the time
    limit of the computation on all cores (s). With a folder ``out``, the same call resumes a budget that was stopped.
    Further options are the options of :class:`Simulation`.
    """
    quantities = [quantity] if isinstance(quantity, str) else list(quantity)
    if scene is not None:
        options["scene"] = scene
    with tempfile.TemporaryDirectory() as folder:
        place = folder if out is None else os.fspath(out)
        said = _budget(quantities, place, cost, begin=begin, end=end, within=within, **options)
    return Budget(json.loads(said))
