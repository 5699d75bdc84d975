"""Ramps of moves in the form: a pair of columns for the first and the last, by time or by acceleration."""

from collections.abc import Callable

from hpn.application import Application
from hpn.links.row_symbols import move_symbols
from hpn.links.rows import EVEN, OPTIONAL, filled
from hpn.web.form.given import Given

COLUMNS = {"time": OPTIONAL["ramps"], "acceleration": (EVEN, *OPTIONAL["unequal"])}
"""Columns of the first and the last ramp, by what they are given as."""

_GROUPS = {"time": "ramps", "acceleration": "unequal"}
_RAMPED = ("trapezoidal", "s_curve")


def press(given: Given, unit: str, application_of: Callable[[Given], Application | None]) -> None:
    """Show the pair or leave it out; with a unit have all ramps in that one."""
    if unit in _GROUPS:
        application = application_of(given)
        given.shown |= {*_GROUPS.values()}
        given.show_columns()
        _turn(given, unit, application)
    elif given.shown & {*_GROUPS.values()}:
        given.shown -= {*_GROUPS.values()}
    else:
        given.shown.add(_GROUPS["acceleration" if EVEN in given.shown else "time"])
    given.show_columns()


def _turn(given: Given, unit: str, application: Application | None) -> None:
    """Put the figure that follows from each ramp in its place: the moves stay the same.

    Columns of the other unit stay where a figure is left in them, as in a move that is not finished.
    """
    other = next(one for one in _GROUPS if one != unit)
    motion = application.duty_cycle.motion if application else None
    fields = {symbol.name: symbol.path[-1] for symbol in move_symbols(given.scalars.get("mech", "").strip())}
    for row, move in zip(filter(filled, given.moves.rows), motion.moves if motion else (), strict=False):
        for name, to in zip(COLUMNS[other], COLUMNS[unit], strict=True):
            value = move.followed.get(fields[to])
            if move.profile in _RAMPED and value is not None and row[name].strip():
                row[name], row[to] = "", f"{value:.12g}"
    left = {name for row in given.moves.rows for name in COLUMNS[other] if row[name].strip()}
    given.shown -= {EVEN, _GROUPS[other]}
    given.shown |= {EVEN} & left
    if left.intersection(OPTIONAL[_GROUPS[other]]):
        given.shown.add(_GROUPS[other])
