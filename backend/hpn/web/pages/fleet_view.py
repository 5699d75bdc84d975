"""A fleet as the templates show it, in a page or in the file of a report."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any
from urllib.parse import urlencode

from hpn.catalogue import Catalogue
from hpn.engine.checks import allowed
from hpn.words.wording import N_

if TYPE_CHECKING:  # Arrow takes half a second to import, which no other page needs
    from hpn.fleet.listing import AxisRow
    from hpn.fleet.summary import Summary

SHOWN = {
    "": N_("all axes"),
    "selected": N_("with a gear"),
    "unsuitable": N_("no gear suits"),
    "rejected": N_("rejected"),
}
"""Filters of axes."""

ROWS_ON_PAGE = 100

ORDERS: Mapping[str, Callable[["AxisRow"], Any]] = {
    "place": lambda row: row.place,
    "axis": lambda row: row.axis.casefold(),
    "gear": lambda row: row.gear,
    "utilisation": lambda row: row.utilisation,
    "check": lambda row: row.governing_check,
    "life": lambda row: row.life and row.life.hours,
    "suitable": lambda row: row.suitable,
    "runner_up": lambda row: row.runner_up,
    "torque": lambda row: row.average_torque_Nm,
}
"""Columns that axes are sorted by, by the names of an address."""

SORTINGS = {
    "": N_("utilisation"),
    "place": N_("number"),
    "axis": N_("axis"),
    "gear": N_("gear"),
    "check": N_("governing check"),
    "life": N_("shortest life"),
}
"""Orders that are offered by name, where the headings of a table don’t stand beside."""


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
    """A fleet as the templates show it. Nothing here is chosen or sorted by address; a page says how it is."""

    summary: "Summary"
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


@dataclass(frozen=True)
class Chosen:
    """Filter and order of the axes of a page, from its address."""

    show: str = ""
    gear: str = ""
    check: str = ""
    search: str = ""
    sort: str = ""
    part: int = 1

    @classmethod
    def of(cls, query: Mapping[str, str]) -> "Chosen":
        """Choice of an address; a wrong name in it counts as none."""
        given = {name: query.get(name, "")[:200] for name in ("show", "gear", "check", "search", "sort")}
        given["show"] = given["show"] if given["show"] in SHOWN else ""
        given["sort"] = given["sort"] if given["sort"].removeprefix("-") in ORDERS else ""
        part = query.get("part", "")
        number = int(part) if part.isascii() and part.isdigit() and len(part) < 6 else 1
        return cls(**given, part=max(number, 1))

    def out_of(self, rows: Sequence["AxisRow"]) -> list["AxisRow"]:
        """Rows that are shown, in their order."""
        search = self.search.strip().casefold()
        found = [
            row
            for row in rows
            if (not self.show or row.state == self.show)
            and (not self.gear or (row.state == "selected" and row.gear == self.gear))
            and (not self.check or (row.state == "selected" and row.governing_check == self.check))
            and search in row.axis.casefold()
        ]
        if not self.sort:
            return by_need(found)
        key = ORDERS[self.sort.removeprefix("-")]
        valued = [row for row in found if row.state != "rejected" and key(row) is not None]
        valued.sort(key=key, reverse=self.sort.startswith("-"))
        return valued + [row for row in found if row.state == "rejected" or key(row) is None]

    def address(self, path: str, **changes: str | int) -> str:
        """Address of a page that shows the same but for some changes."""
        pairs = {name: value for name, value in {**self.__dict__, **changes}.items() if value not in ("", 1)}
        return f"{path}?{urlencode(pairs)}" if pairs else path


@dataclass(frozen=True)
class FleetPageView(FleetView):
    """The same with addresses, for a page that shows some axes at a time."""

    path: str = ""
    chosen: Chosen = field(default_factory=Chosen)
    count: int = 0

    nothing_chosen = Chosen()

    def choose(self, name: str, value: str) -> str:
        """See FleetView."""
        return Chosen().address(self.path, **{name: value}) + "#axes-heading"

    def sorted_by(self, key: str) -> str:
        """See FleetView."""
        turned = f"-{key}" if self.chosen.sort == key else key
        return self.chosen.address(self.path, sort=turned, part=1) + "#axes-heading"

    def order_of(self, key: str) -> str:
        """See FleetView."""
        return {key: "ascending", f"-{key}": "descending"}.get(self.chosen.sort or "-utilisation", "")

    @property
    def parts(self) -> int:
        """Number of parts in which the axes are shown."""
        return max(1, -(-self.count // ROWS_ON_PAGE))

    def part(self, number: int) -> str:
        """Address of one of them, blank where there is none."""
        return self.chosen.address(self.path, part=number) + "#axes-heading" if 1 <= number <= self.parts else ""
