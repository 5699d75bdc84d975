"""The comparer: accounts side by side, line by line, and the gears that no other outdoes.

It compares two selections, one of today or both saved, or some gears of one selection.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import astuple, dataclass, replace
from itertools import zip_longest
from typing import Any, Literal, TypeVar

import numpy as np
from msgspec import structs

from hpn.account import published
from hpn.account.account import UNLIMITED, Account, CheckLine
from hpn.account.lines import Line, LineTable
from hpn.catalogue import Catalogue
from hpn.catalogue.gear import Gear
from hpn.engine.candidates import Candidate
from hpn.engine.selection import Selection
from hpn.physics import equations
from hpn.words.reader import NOTHING, Reader
from hpn.words.wording import N_

MOST_PINS = 4
TOLERANCE = 1e-12
"""Relative tolerance, in a list relative to its largest value: other processors differ by less."""

K = TypeVar("K")
V = TypeVar("V")

Standing = Literal["reference", "better", "alike", ""]
"""Standing of a gear's figure beside that of the first gear, the reference; blank if worse, or neither better nor
worse.
"""


def is_number(value: Any) -> bool:
    """True for a number, but not for a bool."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def is_same(one: Any, other: Any, room: float = 0.0) -> bool:
    """True for equal values, numbers within rounding: another processor has other last bits."""
    return bool(one == other or (is_number(one) and is_number(other) and _is_close(one, other, room)))


def _is_close(one: float, other: float, room: float) -> bool:
    try:
        return math.isclose(one, other, rel_tol=TOLERANCE, abs_tol=room)
    except OverflowError:  # an integer beyond floats, possible in an open axis
        return False


def aligned(*sides: Mapping[K, V]) -> Iterator[tuple[K, tuple[V | None, ...]]]:
    """Yield the values of each side under every key, in the order of the first side and then of the next; None for a
    missing one.
    """
    for key in dict.fromkeys(key for side in sides for key in side):
        yield key, tuple(side.get(key) for side in sides)


# --- Rows -------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Row:
    """One quantity of all accounts, None for an account without it; `standings` are those of gears side by side."""

    lines: tuple[Line | None, ...]
    standings: tuple[Standing, ...] = ()

    @property
    def head(self) -> Line:
        """The quantity."""
        return next(line for line in self.lines if line is not None)

    @property
    def is_lower_bound(self) -> bool:
        """True if one of the lines is a lower bound."""
        return any(line is not None and line.is_lower_bound for line in self.lines)

    @property
    def is_known(self) -> bool:
        """True if one of the lines has a value."""
        return any(line is not None and line.value is not None for line in self.lines)

    @property
    def differs(self) -> bool:
        """True for different values."""
        values = [(line.value, line.until) if line else (None, None) for line in self.lines]
        return not all(map(is_same, values[0], values[-1]))

    def numbers(self, reader: Reader) -> tuple[str, str]:
        """The first and the last value without their unit, with enough digits to differ; a dash for a missing one."""
        one, other = self.lines[0], self.lines[-1]
        return _number(one, other, reader), _number(other, one, reader)


def _number(line: Line | None, beside: Line | None, reader: Reader) -> str:
    return (line.number(reader, beside.value if beside else None) or NOTHING) if line else NOTHING


@dataclass(frozen=True, slots=True)
class CheckRow:
    """One check of all accounts, None for an account without it; `standings` are those of gears side by side."""

    checks: tuple[CheckLine | None, ...]
    standings: tuple[Standing, ...] = ()

    @property
    def head(self) -> CheckLine:
        """The check."""
        return next(check for check in self.checks if check is not None)

    @property
    def differs(self) -> bool:
        """True for different results; figures equal within rounding count as equal."""
        figures = [(*structs.astuple(check.result), *astuple(check.reading)) if check else () for check in self.checks]
        return len(figures[0]) != len(figures[-1]) or not all(map(is_same, figures[0], figures[-1]))


@dataclass(frozen=True, slots=True)
class NumberedRow:
    """A differing row of two tables, such as a phase: its number and its lines in each; empty where the row is
    missing.
    """

    number: int
    sides: tuple[list[Line], list[Line]]


def rows_of(*sides: Iterable[Line]) -> list[Row]:
    """Rows of all lines, matched by their codes."""
    return [Row(lines) for lines in _matched([{line.code: line for line in side} for side in sides])]


def checks_of(*accounts: Account) -> list[CheckRow]:
    """Rows of the checks of all accounts."""
    by_code = [{check.code: check for check in account.checks} for account in accounts]
    return [CheckRow(checks) for checks in _matched(by_code)]


def _matched(sides: Sequence[Mapping[str, V]]) -> Iterator[tuple[V | None, ...]]:
    """Items of each side under every code; an item missing in the first side follows its predecessor on its own
    side.
    """
    order = list(sides[0])
    for side in sides[1:]:
        place, known = 0, set(order)
        for code in side:
            if code in known:
                place = order.index(code) + 1
            else:
                order.insert(place, code)
                place += 1
    for code in order:
        yield tuple(side.get(code) for side in sides)


def numbered_rows(one: LineTable | None, other: LineTable | None) -> Iterator[NumberedRow]:
    """Differing rows of two tables, by their numbers."""
    keys = (table.values() if table else iter(()) for table in (one, other))
    for place, (before, after) in enumerate(zip_longest(*keys)):
        if before != after:
            a, b = (t.row(place) if t and place < len(t) else [] for t in (one, other))
            if any(row.differs for row in rows_of(a, b)):
                yield NumberedRow(place + 1, (a, b))


# --- Gears side by side -----------------------------------------------------------------------------------------------

LESS: Mapping[str, bool] = {
    "candidate.life_L10_h": False,
    "candidate.momentary_peak_count": False,
    "candidate.bearing_life_L50_h": False,
    "candidate.bearing_life_L10_h": False,
    "candidate.shortest_life_h": False,
    "candidate.motor_peak_torque_Nm": True,
    "candidate.motor_rated_torque_Nm": True,
    "candidate.natural_frequency_Hz": False,
    "candidate.wind_up_arcmin": True,
    "candidate.position_error_arcmin": True,
    "candidate.position_error_mm": True,
    "gear.rated_torque_Nm": False,
    "gear.repeated_peak_torque_Nm": False,
    "gear.momentary_peak_torque_Nm": False,
    "gear.maximum_input_speed_rpm": False,
    "gear.average_input_speed_rpm": False,
    "gear.backlash_arcmin": True,
    "gear.transmission_accuracy_arcmin": True,
    "gear.torsional_stiffness_Nm_per_rad": False,
    "gear.length": True,
    "gear.weight_kg": True,
}
"""Figures -> True if less is better, False if more is; by any other figure no gear is better than another."""


ALIKE = N_("Alike in all")


@dataclass(frozen=True, slots=True)
class RowGroup:
    """Rows under one heading."""

    title: str
    rows: Sequence[Row | CheckRow]


def groups_of(accounts: Sequence[Account]) -> list[RowGroup]:
    """Gears of one selection beside the first of them: utilisations, figures under the cycle, and published figures.

    Rows in which all gears are alike come last; with a single gear they stay in their places.
    """
    figures = rows_of(*([line for line in one.figures if line.kind == "computed"] for one in accounts))
    printed = rows_of(*(published.ranged([*account.published, *published.bolts(account.gear)]) for account in accounts))
    groups = [
        RowGroup(N_("Utilisation"), [_check_beside(row) for row in checks_of(*accounts)]),
        RowGroup(N_("Figures of the gear under the cycle"), _beside(figures)),
        *(RowGroup(title, _beside(rows)) for title, rows in published.grouped(printed, lambda row: row.head.code)),
    ]
    if len(accounts) > 1:
        alike = [row for group in groups for row in group.rows if set(row.standings[1:]) == {"alike"}]
        groups = [replace(group, rows=[row for row in group.rows if row not in alike]) for group in groups]
        groups.append(RowGroup(ALIKE, alike))
    return [group for group in groups if group.rows]


def _beside(rows: Iterable[Row]) -> list[Row]:
    return [
        replace(row, standings=_standings([_rank_and_end(line) for line in row.lines], LESS.get(row.head.code)))
        for row in rows
        if row.is_known
    ]


def _rank_and_end(line: Line | None) -> tuple[Any, Any]:
    return math.inf if line and line.value == UNLIMITED else line and line.value, line and line.until


def _check_beside(row: CheckRow) -> CheckRow:
    values = [(check and check.result.utilisation, None) for check in row.checks]
    return replace(row, standings=_standings(values, lowest=True))


def _standings(values: Sequence[tuple[Any, Any]], lowest: bool | None) -> tuple[Standing, ...]:
    """Standing of each value beside the first one; the ends of ranges count if their beginnings are alike."""
    (first, first_end), *others = values
    standings: list[Standing] = ["reference"]
    for value, end in others:
        begins_alike = is_same(value, first)
        one, other = (end, first_end) if begins_alike else (value, first)
        is_ahead = lowest is not None and is_number(one) and is_number(other) and (one < other) == lowest
        standings.append("alike" if begins_alike and is_same(end, first_end) else "better" if is_ahead else "")
    return tuple(standings)


# --- Not dominated (Pareto) -------------------------------------------------------------------------------------------


def undominated(candidates: Sequence[Candidate], catalogue: Catalogue) -> frozenset[str]:
    """Designations of the suitable gears that no other suitable one outdoes (Pareto).

    A gear outdoes another if it is nowhere worse and somewhere better: in weight, utilisation, torsional stiffness,
    largest length and peak torque at the motor. An unpublished figure counts as worst.
    """
    suitable = [candidate for candidate in candidates if candidate.status == "suitable"]
    if not suitable:
        return frozenset()
    costs = np.array([_costs(candidate, catalogue.by_designation[candidate.designation]) for candidate in suitable])
    table = equations.tied(costs.T).T
    nowhere_worse = (table[:, None] <= table[None]).all(axis=2)
    outdone = np.any(nowhere_worse & (table[:, None] < table[None]).any(axis=2), axis=0)
    return frozenset(suitable[place].designation for place in np.flatnonzero(~outdone).tolist())


def _costs(candidate: Candidate, gear: Gear) -> tuple[float, ...]:
    stiffness = gear.torsional_stiffness_Nm_per_rad
    costs = (
        gear.weight_kg,
        candidate.utilisation,
        None if stiffness is None else -stiffness,
        gear.length_max_mm,
        candidate.motor_peak_torque_Nm,
    )
    return tuple(np.inf if cost is None else cost for cost in costs)


# --- Lighter ----------------------------------------------------------------------------------------------------------


def lighter_miss(selection: Selection, designation: str | None, gears: Mapping[str, Gear]) -> Candidate | None:
    """The rejected gear closest to passing among the judged gears lighter than another one; None without one."""
    weight = _weight(designation, gears)
    if weight is None:
        return None
    for candidate in selection.candidates:
        own = _weight(candidate.designation, gears)
        if candidate.status == "unsuitable" and own is not None and own < weight and candidate.is_judged:
            return candidate
    return None


def _weight(designation: str | None, gears: Mapping[str, Gear]) -> float | None:
    gear = gears.get(designation or "")
    return gear.weight_kg if gear else None
