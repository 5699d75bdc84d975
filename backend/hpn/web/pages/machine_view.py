"""The working copy of a machine as its page shows it: its axes as the address chooses them, and what they come to."""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple
from urllib.parse import urlencode

from hpn.account.over_tolerance import ToleranceLine, line_of
from hpn.account.readings import Life, life_of
from hpn.catalogue import Catalogue
from hpn.documents.axis import Json
from hpn.documents.common import Common
from hpn.documents.gears import GearOrder, Placed, gears_of
from hpn.store import Machine, SavedAxis
from hpn.web.columns import common_of
from hpn.web.pages.machine_values import FieldValue, bound_of, common_values, own_values
from hpn.words.wording import N_

ADDRESS = "/machines"
REASON = "machine_refused.html"
"""Page that says why there is nothing to show."""

ROWS_ON_PAGE = 100

SHOWN = {"": N_("All"), "todo": N_("To do"), "inside": N_("Don’t hold"), "changed": N_("Changed")}
"""Filters of axes: those without a suitable gear, those whose suitable gear does not hold over the whole tolerance, and
those changed since the latest revision."""

MARGINS = ("unsuitable", "unrated", "open", "suitable")
"""Verdicts in the order in which axes need somebody."""


class MachineRow(NamedTuple):
    """An axis with its place in the machine; its figures are those of its gear, or of the nearest miss."""

    place: int
    axis: SavedAxis

    @property
    def name(self) -> str:
        """Its name, else its number."""
        return self.axis.name or str(self.axis.number)

    @property
    def answer(self) -> Mapping[str, Any]:
        """Columns of its answer."""
        return self.axis.answer

    @property
    def status(self) -> str:
        """Verdict on its gear."""
        status: str = self.axis.answer["status"]
        return status

    @property
    def fails_inside(self) -> bool:
        """True where its gear is suitable as given, and does not hold over the whole tolerance."""
        holds = self.axis.answer["holds"]
        return self.status == "suitable" and holds is not None and not holds

    @property
    def gear(self) -> str | None:
        """Designation that the figures are of; None for an open axis."""
        gear: str | None = self.axis.answer["designation"]
        return gear

    @property
    def code(self) -> str:
        """Rest of its ordering code behind the designation."""
        code, gear = self.axis.ordering_code or "", self.gear or ""
        return code.removeprefix(gear) if gear and code.startswith(gear) else ""

    @property
    def life(self) -> Life | None:
        """Shortest life; None where it is not known."""
        answer = self.axis.answer
        of = answer["shortest_life_of"]
        endless = of is None and answer["status"] == "suitable" and '"shortest_life_h"' not in answer["unknown"]
        return life_of(answer["shortest_life_h"], of) if of or endless else None


def _figure(name: str) -> Callable[[MachineRow], Any]:
    return lambda row: row.axis.answer[name]


ORDERS: Mapping[str, Callable[[MachineRow], Any]] = {
    "place": lambda row: row.place,
    "number": lambda row: row.axis.number,
    "axis": lambda row: row.name.casefold(),
    "quantity": lambda row: row.axis.quantity,
    "gear": _figure("designation"),
    "utilisation": _figure("utilisation"),
    "check": _figure("governing_check"),
    "life": lambda row: row.life and row.life.hours,
    "worst": _figure("worst_utilisation"),
    "frequency": _figure("natural_frequency_Hz"),
}
"""Columns that axes are sorted by, by the names of an address."""

SORTINGS = {
    "": N_("utilisation"),
    "place": N_("order of the machine"),
    "axis": N_("axis"),
    "gear": N_("gear"),
    "check": N_("governing check"),
    "life": N_("shortest life"),
}
"""Orders that are offered by name."""


def _by_need(rows: Iterable[MachineRow]) -> list[MachineRow]:
    """Axes without a suitable gear first, the worst of them before all, then the others by falling utilisation."""

    def need(row: MachineRow) -> tuple[int, bool, float]:
        used = row.answer["utilisation"]
        return MARGINS.index(row.status), used is not None, -(used or 0)

    return sorted(rows, key=need)


@dataclass(frozen=True)
class Chosen:
    """Filter and order of the axes, from an address; a wrong name in it counts as none."""

    show: str = ""
    gear: str = ""
    search: str = ""
    sort: str = ""
    part: int = 1
    revision: str = ""

    @classmethod
    def of(cls, query: Mapping[str, str]) -> "Chosen":
        """Choice of an address."""
        given = {name: query.get(name, "")[:200] for name in ("show", "gear", "search", "sort")}
        given["show"] = given["show"] if given["show"] in SHOWN else ""
        given["sort"] = given["sort"] if given["sort"].removeprefix("-") in ORDERS else ""
        part = query.get("part", "")
        number = int(part) if part.isascii() and part.isdigit() and len(part) < 6 else 1
        return cls(**given, part=max(number, 1))

    def out_of(self, rows: Sequence[MachineRow], changed: Collection[int]) -> list[MachineRow]:
        """Rows that are shown, in their order; `changed` are the numbers of those that differ from a revision."""
        word = self.search.strip().casefold()
        found = [
            row
            for row in rows
            if (self.show != "todo" or row.status != "suitable")
            and (self.show != "inside" or row.fails_inside)
            and (self.show != "changed" or row.axis.number in changed)
            and (not self.gear or row.gear == self.gear)
            and any(word in text.casefold() for text in (row.name, row.gear or "", row.axis.ordering_code or ""))
        ]
        if not self.sort:
            return _by_need(found)
        key = ORDERS[self.sort.removeprefix("-")]
        valued = [row for row in found if key(row) is not None]
        valued.sort(key=key, reverse=self.sort.startswith("-"))
        return valued + [row for row in found if key(row) is None]

    def address(self, path: str, **changes: str | int) -> str:
        """Address of a page that shows the same but for some changes."""
        pairs = {name: value for name, value in {**self.__dict__, **changes}.items() if value not in ("", 1)}
        return f"{path}?{urlencode(pairs)}" if pairs else path


@dataclass(frozen=True)
class MachineView:
    """A machine with those axes that its page shows."""

    machine: Machine
    catalogue: Catalogue
    chosen: Chosen = field(default_factory=Chosen)
    changed_axes: Collection[int] = frozenset()
    """Numbers of the axes that differ from the latest revision."""

    orders = SORTINGS

    @cached_property
    def frozen(self) -> str:
        """Label of the revision that is shown; blank for the working copy."""
        return self.chosen.revision

    @cached_property
    def everything(self) -> Chosen:
        """Choice of all axes."""
        return Chosen(revision=self.frozen)

    @cached_property
    def path(self) -> str:
        """Address of the machine."""
        return f"{ADDRESS}/{self.machine.id}"

    @cached_property
    def all(self) -> list[MachineRow]:
        """All its axes."""
        return [MachineRow(place, axis) for place, axis in enumerate(self.machine.items, 1)]

    @cached_property
    def common(self) -> Json:
        """Its common values."""
        return common_of(self.machine)

    @cached_property
    def found(self) -> list[MachineRow]:
        """Axes that the address chooses."""
        return self.chosen.out_of(self.all, self.changed_axes)

    @cached_property
    def rows(self) -> list[MachineRow]:
        """Those of them on this part."""
        return self.found[(self.chosen.part - 1) * ROWS_ON_PAGE : self.chosen.part * ROWS_ON_PAGE]

    @cached_property
    def counts(self) -> Mapping[str, int]:
        """Numbers of axes by verdict."""
        found = dict.fromkeys(MARGINS, 0)
        for row in self.all:
            found[row.status] += 1
        return found

    @cached_property
    def failing_inside(self) -> int:
        """Number of axes whose gear is suitable as given, and does not hold over the whole tolerance."""
        return sum(row.fails_inside for row in self.all)

    def showing(self, show: str) -> int:
        """Number of axes that a filter shows."""
        if show == "changed":
            return len(self.changed_axes)
        if show == "inside":
            return self.failing_inside
        return len(self.all) - (self.counts["suitable"] if show == "todo" else 0)

    @cached_property
    def top(self) -> MachineRow | None:
        """The suitable axis that is used most."""
        used = [row for row in self.all if row.status == "suitable" and row.answer["utilisation"] is not None]
        return max(used, key=lambda row: row.answer["utilisation"], default=None)

    @cached_property
    def has_frequency(self) -> bool:
        """True where an axis has a natural frequency."""
        return any(row.answer["natural_frequency_Hz"] is not None for row in self.all)

    @cached_property
    def has_worst_case(self) -> bool:
        """True where an axis has tolerances that its gear is judged over."""
        return any(row.answer["holds"] is not None for row in self.all)

    @cached_property
    def order(self) -> GearOrder:
        """Gears to order."""
        return gears_of(map(placed, self.machine.items), self.catalogue)

    @cached_property
    def kinds(self) -> int:
        """Number of kinds of gears."""
        return self.order.kinds

    @cached_property
    def quantity(self) -> int:
        """Number of gears."""
        return sum(gear.quantity for gear in self.order.gears)

    def bound(self, row: MachineRow) -> float:
        """Largest utilisation with which the governing check of an axis passes."""
        return bound_of(row.axis, self.common)

    def worst_bound(self, row: MachineRow) -> float:
        """The same of its worst case."""
        return bound_of(row.axis, self.common, in_worst_case=True)

    def own(self, row: MachineRow) -> list[FieldValue]:
        """Values that an axis has of its own."""
        return own_values(row.axis)

    @cached_property
    def values(self) -> list[FieldValue]:
        """Common values."""
        return common_values(self.common)

    @cached_property
    def tolerances(self) -> list[ToleranceLine]:
        """Common tolerances."""
        return [line_of(path, each) for path, each in (Common.model_validate(self.common).tolerances or {}).items()]

    @cached_property
    def names(self) -> Mapping[int, str]:
        """Names of its axes by their numbers."""
        return {row.axis.number: row.name for row in self.all}

    @cached_property
    def lacking(self) -> frozenset[int]:
        """Numbers of the axes without a suitable gear."""
        return frozenset(row.axis.number for row in self.all if row.status != "suitable")

    # --- Addresses ----------------------------------------------------------------------------------------------------

    def choose(self, name: str, value: str) -> str:
        """Address of the axes of a filter."""
        return self.everything.address(self.path, **{name: value}) + "#axes-heading"

    def show(self, value: str) -> str:
        """Address of the axes of another filter in the same order."""
        return self.chosen.address(self.path, show=value, part=1) + "#axes-heading"

    def sorted_by(self, key: str) -> str:
        """Address of the axes in the order of a column."""
        turned = f"-{key}" if self.chosen.sort == key else key
        return self.chosen.address(self.path, sort=turned, part=1) + "#axes-heading"

    @property
    def opened(self) -> str:
        """Address of the same axes with the form of the common values."""
        address = self.chosen.address(self.path)
        return f"{address}{'&' if '?' in address else '?'}edit=common"

    @property
    def closed(self) -> str:
        """Address of the same axes without it."""
        return self.chosen.address(self.path)

    @property
    def changed(self) -> str:
        """Address that takes changes and shows the same axes."""
        return self.chosen.address(f"{self.path}/change")

    def order_of(self, key: str) -> str:
        """Order of the axes by a column; blank where there is none."""
        return {key: "ascending", f"-{key}": "descending"}.get(self.chosen.sort or "-utilisation", "")

    @property
    def parts(self) -> int:
        """Number of parts in which the axes are shown."""
        return max(1, -(-len(self.found) // ROWS_ON_PAGE))

    def part(self, number: int) -> str:
        """Address of one of them, blank where there is none."""
        return self.chosen.address(self.path, part=number) + "#axes-heading" if 1 <= number <= self.parts else ""


def placed(axis: SavedAxis) -> Placed:
    """An axis by what counts for the order of gears."""
    return Placed(axis.number, axis.quantity, axis.ordering_code, axis.answer["selected"])
