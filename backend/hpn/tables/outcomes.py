"""Outcomes of a short table with one cycle: the cycle that results from each option of its open choices."""

from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace
from itertools import accumulate
from math import isfinite
from typing import Any

from hpn.tables.columns import Choices
from hpn.tables.cycles import read_grids
from hpn.tables.inputs import PHASE_ROLES
from hpn.tables.sheets import Grid
from hpn.tables.table import Choice, Interpretation, Table
from hpn.words.wording import N_, Quantity, Sentence

MOST_ROWS_TRIED, MOST_OPTIONS_TRIED = 100, 6
"""Limits, in rows of a table and options of its choices, up to which the table is read again for each option."""

OUTCOME = N_("speeds {lowest} to {highest}, cycle {time}")


def with_outcomes(table: Table, grids: Sequence[Grid], choices: Choices, assumed: Collection[str]) -> Table:
    """A table with the cycle that each option of its choices gives, if nothing else is open.

    Rows named like totals are left out, even where an option leaves their meaning open.
    """
    if not 0 < table.rows <= MOST_ROWS_TRIED:
        return table
    options = [(choice, code) for choice in table.choices for code in choice.options][:MOST_OPTIONS_TRIED]
    outcomes: dict[str, dict[str, Interpretation]] = {}
    for choice, code in options:
        answer: dict[str, Any] = {"totals": choices.totals or "sum", choice.name: code}
        if outcome := _outcome(read_grids(grids, replace(choices, **answer), assumed)):
            outcomes.setdefault(choice.name, {})[code] = outcome

    def with_own(choice: Choice) -> Choice:
        return replace(choice, outcomes=outcomes.get(choice.name, {}))

    return replace(table, choices=tuple(map(with_own, table.choices)))


def _outcome(table: Table) -> Interpretation | None:
    speeds, times = ([float(phase[PHASE_ROLES.index(role)] or 0) for phase in table.phases] for role in "nt")
    sizes = [abs(speed) for speed in speeds]
    if not table.whole or table.lasting_s is None or not isfinite(max(sizes)):
        return None
    ends = {"lowest": Quantity(min(sizes), "rpm"), "highest": Quantity(max(sizes), "rpm")}
    sentence = Sentence(OUTCOME, {**ends, "time": Quantity(table.lasting_s, "s")})
    return Interpretation(sentence, _course(speeds, accumulate(times), table.lasting_s))


def _course(speeds: Sequence[float], ends: Iterable[float], lasting: float) -> str:
    """Steps of a speed over time, back to zero at both ends, in a box of 100 × 30."""
    highest, lowest = max(0.0, *speeds), min(0.0, *speeds)
    scale = 30 / (highest - lowest or 1)
    zero, width = highest * scale, 100 / (lasting or 1)
    steps = (f"V{(highest - speed) * scale:.1f}H{end * width:.1f}" for speed, end in zip(speeds, ends, strict=True))
    return f"M0 {zero:.1f}{''.join(steps)}V{zero:.1f}"
