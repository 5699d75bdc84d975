"""Ramps of moves in the form: a pair of columns for the first and last ramp, in time or in acceleration."""

from collections.abc import Callable

from hpn.application import Application
from hpn.links.row_symbols import move_symbols
from hpn.links.rows import EVEN, OPTIONAL, filled
from hpn.web.form.query import SortedQuery

COLUMNS = {"time": OPTIONAL["ramps"], "acceleration": (EVEN, *OPTIONAL["unequal"])}
"""Columns of the first and last ramp, by the quantity that gives them."""

_GROUPS = {"time": "ramps", "acceleration": "unequal"}
_RAMPED = ("trapezoidal", "s_curve")


def press(query: SortedQuery, unit: str, application_of: Callable[[SortedQuery], Application | None]) -> None:
    """Show or hide the pair of columns; with a `unit` (time or acceleration) convert all ramps to it."""
    if unit in _GROUPS:
        application = application_of(query)
        query.groups |= {*_GROUPS.values()}
        query.show_columns()
        _turn(query, unit, application)
    elif query.groups & {*_GROUPS.values()}:
        query.groups -= {*_GROUPS.values()}
    else:
        query.groups.add(_GROUPS["acceleration" if EVEN in query.groups else "time"])
    query.show_columns()


def _turn(query: SortedQuery, unit: str, application: Application | None) -> None:
    """Replace each ramp by the equivalent figure in the other quantity: the moves stay the same.

    Columns of the former quantity stay if a figure is left in them, for example in an incomplete move.
    """
    other = next(one for one in _GROUPS if one != unit)
    motion = application.duty_cycle.motion if application else None
    fields = {symbol.name: symbol.path[-1] for symbol in move_symbols(query.scalars.get("mech", "").strip())}
    for row, move in zip(filter(filled, query.moves.rows), motion.moves if motion else (), strict=False):
        for name, to in zip(COLUMNS[other], COLUMNS[unit], strict=True):
            value = move.followed.get(fields[to])
            if move.profile in _RAMPED and value is not None and row[name].strip():
                row[name], row[to] = "", f"{value:.12g}"
    filled_columns = {name for row in query.moves.rows for name in COLUMNS[other] if row[name].strip()}
    query.groups -= {EVEN, _GROUPS[other]}
    query.groups |= {EVEN} & filled_columns
    if filled_columns.intersection(OPTIONAL[_GROUPS[other]]):
        query.groups.add(_GROUPS[other])
