"""A fleet as the template of a report shows it."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from hpn.catalogue import Catalogue
from hpn.engine.checks import allowed
from hpn.words.wording import N_

if TYPE_CHECKING:  # Arrow takes half a second to import, which no other page needs
    from hpn.fleet.listing import AxisRow
    from hpn.fleet.summary import AxisCounts

SHOWN = {
    "": N_("all axes"),
    "selected": N_("with a gear"),
    "unsuitable": N_("no gear suits"),
    "rejected": N_("rejected"),
}
"""Filters of axes."""


def by_need(rows: Iterable["AxisRow"]) -> list["AxisRow"]:
    """Rows without a gear first, the worst of them before all, then the others by falling utilisation."""
    states = ("unsuitable", "rejected", "selected")
    return sorted(rows, key=lambda row: (states.index(row.state), row.utilisation is not None, -(row.utilisation or 0)))


def weights_of(catalogue: Catalogue) -> dict[str, float]:
    """Weight of each gear in kg, of those that have one."""
    return {gear.designation: gear.weight_kg for gear in catalogue.gears if gear.weight_kg is not None}


def foremost(rows: Iterable["AxisRow"]) -> "AxisRow | None":
    """The axis with a gear whose utilisation is the largest."""
    judged = [row for row in rows if row.state == "selected" and row.utilisation is not None]
    return max(judged, key=lambda row: row.utilisation or 0, default=None)


@dataclass(frozen=True)
class FleetView:
    """A fleet as the template shows it; its script sorts and filters."""

    summary: "AxisCounts"
    rows: Sequence["AxisRow"]
    links: Mapping[int, str] = field(default_factory=dict)
    allowed: Mapping[int, float] = field(default_factory=dict)
    """Utilisation that an axis may reach, where it is below 1."""

    top: "AxisRow | None" = None
    """The axis with a gear that is used most, out of all."""

    weights: Mapping[str, float] = field(default_factory=dict)
    """Weight of each gear in kg, as far as the catalogue has it."""

    @property
    def weight_kg(self) -> float | None:
        """Weight of the gears of all axes; None where that of one is not known."""
        gears = dict(self.summary.gears)
        known = gears.keys() <= self.weights.keys()
        return sum(self.weights[name] * count for name, count in gears.items()) if known else None

    def bound(self, row: "AxisRow") -> float:
        """Largest utilisation with which the governing check of an axis passes."""
        return allowed(row.governing_check, self.allowed.get(row.place, 1.0))

    def choose(self, name: str, value: str) -> str:
        """Address of the axes that a count counts."""
        return ""

    def sorted_by(self, key: str) -> str:
        """Address of the axes in the order of a column."""
        return ""

    def order_of(self, key: str) -> str:
        """Order of the axes by a column; blank where there is none."""
        return ""
