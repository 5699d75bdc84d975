"""What the templates show of a fleet, in a page or in the file of a report."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from hpn.wording import N_

if TYPE_CHECKING:  # Arrow takes half a second to import, which no other page needs
    from hpn.fleet.listing import AxisRow
    from hpn.fleet.summary import Summary

SHOWN = {
    "": N_("all axes"),
    "selected": N_("with a gear"),
    "unsuitable": N_("no gear suits"),
    "rejected": N_("rejected"),
}
"""Which axes are shown."""


@dataclass(frozen=True)
class FleetView:
    """What the templates show of a fleet. Nothing here is chosen or sorted by address; a page says how it is."""

    summary: "Summary"
    rows: Sequence["AxisRow"]
    links: Mapping[str, str] = field(default_factory=dict)

    def choose(self, name: str, value: str) -> str:
        """Address of the axes that a count counts."""
        return ""

    def sorted_by(self, key: str) -> str:
        """Address of the axes in the order of a column."""
        return ""

    def order_of(self, key: str) -> str:
        """How the axes are ordered by a column; blank where they are not."""
        return ""
