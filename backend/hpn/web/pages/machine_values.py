"""Values of a machine for its page: common values, own values of an axis, and the axis's utilisation limit."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from hpn.documents.axis import Json
from hpn.documents.common import COMMON, flat
from hpn.engine.checks import allowed
from hpn.links.symbol import Symbol
from hpn.links.symbols import BY_PATH
from hpn.store import SavedAxis
from hpn.web.columns import own_of, without_of


class FieldValue(NamedTuple):
    """Common or own value of a field; None if a common value does not apply to the axis."""

    symbol: Symbol
    value: Any


SHORT = ("requirements.utilisation", "requirements.life_h", "output_load.life_h", "output_load.load_coefficient")
IN_ORDER = (*SHORT, *(path for path in COMMON if path not in SHORT))
"""Fields that may be common; those that most machines have come first."""


def common_values(common: Mapping[str, Any]) -> list[FieldValue]:
    """Common values of a machine."""
    return _fields(dict(flat(common)))


def own_values(axis: SavedAxis) -> list[FieldValue]:
    """Own values of an axis in fields that may be common; None for a common value that it leaves out."""
    return _fields({**dict(flat(_parts(own_of(axis)))), **dict.fromkeys(without_of(axis))})


def _parts(own: Json) -> Json:
    """Parts of an axis's own values that common values can replace."""
    return {name: own[name] for name in ("requirements", "output_load", "application_area", "rank_by") if name in own}


def _fields(values: Mapping[str, Any]) -> list[FieldValue]:
    named = ((BY_PATH.get(tuple(path.split("."))), path) for path in IN_ORDER if path in values)
    return [FieldValue(symbol, _plain(values[path])) for symbol, path in named if symbol is not None]


def _plain(value: Any) -> Any:
    """Value in a form that can be shown, even if malformed: a number, a text, or a list of texts."""
    if isinstance(value, list):
        return [str(_plain(each)) for each in value[:20]]
    if isinstance(value, Mapping):
        return _plain([f"{name}: {_plain(each)}" for name, each in value.items()])
    if isinstance(value, bool):
        return "1" if value else ""
    if not isinstance(value, int | float):
        return value if value is None else str(value)[:40]
    return value if abs(value) < LARGEST else "…"


LARGEST = 1e15
"""Number above the bounds of all inputs."""


def bound_of(axis: SavedAxis, common: Mapping[str, Any], *, in_worst_case: bool = False) -> float:
    """Largest utilisation with which the governing check of an axis passes, for given values or in the worst case."""
    values = {**dict(flat(common)), **dict.fromkeys(without_of(axis)), **dict(flat(_parts(own_of(axis))))}
    names = ("worst_case_utilisation", "utilisation") if in_worst_case else ("utilisation",)
    shares = (values.get(f"requirements.{name}") for name in names)
    u = next((each for each in shares if isinstance(each, float | int) and 0 < each <= 1), 1.0)
    return allowed(axis.answer["worst_governing_check" if in_worst_case else "governing_check"], u)
