"""View of a fleet for the template of a report."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from hpn.catalogue import Catalogue
from hpn.engine.checks import allowed
from hpn.words.wording import N_

if TYPE_CHECKING:  # importing Arrow takes half a second, and no other page needs it
    from hpn.fleet.listing import AxisRow
    from hpn.fleet.summary import AxisCounts

COLUMNS = {
    "": N_("all axes"),
    "selected": N_("with a gear"),
    "unsuitable": N_("no gear suits"),
    "rejected": N_("rejected"),
}
"""Filters of axes."""


def by_need(rows: Iterable["AxisRow"]) -> list["AxisRow"]:
    """Rows without a gear first, the worst of them foremost, then the others by falling utilisation."""
    states = ("unsuitable", "rejected", "selected")
    return sorted(rows, key=lambda row: (states.index(row.state), row.utilisation is not None, -(row.utilisation or 0)))


def weights_of(catalogue: Catalogue) -> dict[str, float]:
    """Weights in kg by designation, of the gears with a known weight."""
    return {gear.designation: gear.weight_kg for gear in catalogue.gears if gear.weight_kg is not None}


def foremost(rows: Iterable["AxisRow"]) -> "AxisRow | None":
    """Axis with a gear that has the largest utilisation; None without one."""
    judged = [row for row in rows if row.state == "selected" and row.utilisation is not None]
    return max(judged, key=lambda row: row.utilisation or 0, default=None)


@dataclass(frozen=True)
class FleetView:
    """Fleet for the template; the report's script sorts and filters."""

    summary: "AxisCounts"
    rows: Sequence["AxisRow"]
    links: Mapping[int, str] = field(default_factory=dict)
    allowed: Mapping[int, float] = field(default_factory=dict)
    """Permitted utilisation by place, where it is below 1."""

    top: "AxisRow | None" = None
    """Axis with the most used gear of all axes."""

    weights: Mapping[str, float] = field(default_factory=dict)
    """Weights in kg by designation, as far as the catalogue has them."""

    @property
    def weight_kg(self) -> float | None:
        """Weight of the gears of all axes in kg; None if one is unknown."""
        gears = dict(self.summary.gears)
        known = gears.keys() <= self.weights.keys()
        return sum(self.weights[name] * count for name, count in gears.items()) if known else None

    def bound(self, row: "AxisRow") -> float:
        """Largest utilisation with which the governing check of an axis passes."""
        return allowed(row.governing_check, self.allowed.get(row.place, 1.0))

    def choose(self, name: str, value: str) -> str:
        """Address of the axes behind a count; blank in a report."""
        return ""

    def sorted_by(self, key: str) -> str:
        """Address of the axes in the order of a column; blank in a report."""
        return ""

    def order_of(self, key: str) -> str:
        """Present order of a column; blank in a report."""
        return ""
