"""Machine for its page: the axes that the address chooses, and their totals."""

from collections import Counter
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
from hpn.documents.gears import GearOrder, gears_of
from hpn.store import Machine, SavedAxis
from hpn.web.columns import common_of
from hpn.web.edits import order_axis
from hpn.web.pages.machine_values import FieldValue, bound_of, common_values, own_values
from hpn.words.wording import N_

ADDRESS = "/machines"
REASON = "machine_refused.html"
"""Page with the reason why there is nothing to show."""

ROWS_ON_PAGE = 100

FILTERS = {"": N_("All"), "todo": N_("To do"), "inside": N_("Don’t hold"), "changed": N_("Changed")}
"""Filters of axes: all, without a suitable gear, with a suitable gear that does not hold over the whole tolerance, and
changed since the revision of the comparison."""

MARGINS = ("unsuitable", "unrated", "open", "suitable")
"""Verdicts in the order of urgency."""


class MachineRow(NamedTuple):
    """Axis with its place in the machine; the figures are those of its gear, or of the nearest miss."""

    place: int
    axis: SavedAxis

    @property
    def name(self) -> str:
        """Name of the axis, else its number."""
        return self.axis.name or str(self.axis.number)

    @property
    def texts(self) -> tuple[str, str, str]:
        """Texts that a search looks at."""
        return self.name, self.gear or "", self.axis.ordering_code or ""

    @property
    def answer(self) -> Mapping[str, Any]:
        """Columns of the answer."""
        return self.axis.answer

    @property
    def status(self) -> str:
        """Verdict on the gear."""
        status: str = self.axis.answer["status"]
        return status

    @property
    def fails_inside(self) -> bool:
        """True if the gear is suitable for the given values, but does not hold over the whole tolerance."""
        holds = self.axis.answer["holds"]
        return self.status == "suitable" and holds is not None and not holds

    @property
    def gear(self) -> str | None:
        """Designation of the gear of the figures; None for an open axis."""
        gear: str | None = self.axis.answer["designation"]
        return gear

    @property
    def code(self) -> str:
        """Rest of the ordering code after the designation."""
        code, gear = self.axis.ordering_code or "", self.gear or ""
        return code.removeprefix(gear) if gear and code.startswith(gear) else ""

    @property
    def life(self) -> Life | None:
        """Shortest life; None if it is unknown."""
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
"""Sorting keys by their names in an address."""

SORTINGS = {
    "": N_("utilisation"),
    "place": N_("order of the machine"),
    "axis": N_("axis"),
    "gear": N_("gear"),
    "check": N_("governing check"),
    "life": N_("shortest life"),
}
"""Orders offered by name."""


def _by_need(rows: Iterable[MachineRow]) -> list[MachineRow]:
    """Axes in the order of MARGINS, those of a verdict by falling utilisation."""

    rank = {status: place for place, status in enumerate(MARGINS)}

    def need(row: MachineRow) -> tuple[int, bool, float]:
        answer = row.axis.answer
        used = answer["utilisation"]
        return rank[answer["status"]], used is not None, -(used or 0)

    return sorted(rows, key=need)


@dataclass(frozen=True)
class RowChoice:
    """Filter and order of the axes from an address, and the revision `since` which changes are shown; unknown names
    are ignored."""

    show: str = ""
    gear: str = ""
    search: str = ""
    sort: str = ""
    part: int = 1
    revision: str = ""
    since: str = ""

    @classmethod
    def of(cls, query: Mapping[str, str]) -> "RowChoice":
        """Choice in the query of an address."""
        texts = {name: query.get(name, "")[:200] for name in ("show", "gear", "search", "sort")}
        texts["show"] = texts["show"] if texts["show"] in FILTERS else ""
        texts["since"] = query.get("since", "")[:20]
        texts["sort"] = texts["sort"] if texts["sort"].removeprefix("-") in ORDERS else ""
        part = query.get("part", "")
        number = int(part) if part.isascii() and part.isdigit() and len(part) < 6 else 1
        return cls(**texts, part=max(number, 1))

    def out_of(self, rows: Sequence[MachineRow], changed: Collection[int]) -> list[MachineRow]:
        """Rows to show, in their order; `changed` are the numbers of the axes that differ from a revision."""
        word = self.search.strip().casefold()
        matches = [
            row
            for row in rows
            if (self.show != "todo" or row.status != "suitable")
            and (self.show != "inside" or row.fails_inside)
            and (self.show != "changed" or row.axis.number in changed)
            and (not self.gear or row.gear == self.gear)
            and (not word or any(word in text.casefold() for text in row.texts))
        ]
        if not self.sort:
            return _by_need(matches)
        key = ORDERS[self.sort.removeprefix("-")]
        valued = [row for row in matches if key(row) is not None]
        valued.sort(key=key, reverse=self.sort.startswith("-"))
        return valued + [row for row in matches if key(row) is None]

    def address(self, path: str, **changes: str | int) -> str:
        """Address of a page with the same choice except for some changes."""
        pairs = {name: value for name, value in {**self.__dict__, **changes}.items() if value not in ("", 1)}
        return f"{path}?{urlencode(pairs)}" if pairs else path


@dataclass(frozen=True)
class MachineView:
    """Machine with the axes that its page shows."""

    machine: Machine
    catalogue: Catalogue
    chosen: RowChoice = field(default_factory=RowChoice)
    changed_axes: Collection[int] = frozenset()
    """Numbers of the axes that differ from the revision of the comparison."""

    orders = SORTINGS

    @cached_property
    def frozen(self) -> str:
        """Label of the shown revision; blank for the working copy."""
        return self.chosen.revision

    @cached_property
    def everything(self) -> RowChoice:
        """Choice of all axes."""
        return RowChoice(revision=self.frozen, since=self.chosen.since)

    @cached_property
    def path(self) -> str:
        """Address of the machine."""
        return f"{ADDRESS}/{self.machine.id}"

    @cached_property
    def all(self) -> list[MachineRow]:
        """Rows of all axes."""
        return [MachineRow(place, axis) for place, axis in enumerate(self.machine.items, 1)]

    @cached_property
    def common(self) -> Json:
        """Common values of the machine."""
        return common_of(self.machine)

    @cached_property
    def chosen_rows(self) -> list[MachineRow]:
        """Rows that the address chooses."""
        return self.chosen.out_of(self.all, self.changed_axes)

    @cached_property
    def rows(self) -> list[MachineRow]:
        """Chosen rows on the present part."""
        return self.chosen_rows[(self.chosen.part - 1) * ROWS_ON_PAGE : self.chosen.part * ROWS_ON_PAGE]

    @cached_property
    def counts(self) -> Mapping[str, int]:
        """Numbers of axes by verdict."""
        return dict.fromkeys(MARGINS, 0) | Counter(axis.answer["status"] for axis in self.machine.items)

    @cached_property
    def failing_inside(self) -> int:
        """Number of axes whose gear is suitable for the given values, but does not hold over the whole tolerance."""
        return sum(row.fails_inside for row in self.all) if self.has_worst_case else 0

    @property
    def holding(self) -> int:
        """Number of axes whose gear holds over the whole tolerance."""
        return sum(axis.answer["holds"] is True for axis in self.machine.items)

    def showing(self, show: str) -> int:
        """Number of axes that a filter shows."""
        if show == "changed":
            return len(self.changed_axes)
        if show == "inside":
            return self.failing_inside
        return len(self.all) - (self.counts["suitable"] if show == "todo" else 0)

    @cached_property
    def top(self) -> MachineRow | None:
        """Suitable axis with the largest utilisation; None if no axis is suitable."""
        answers = [(row, row.axis.answer) for row in self.all]
        used = [(answer["utilisation"], row) for row, answer in answers if answer["status"] == "suitable"]
        known = [each for each in used if each[0] is not None]
        return max(known, key=lambda each: each[0], default=(0.0, None))[1]

    @cached_property
    def has_frequency(self) -> bool:
        """True if an axis has a natural frequency."""
        return any(axis.answer["natural_frequency_Hz"] is not None for axis in self.machine.items)

    @cached_property
    def has_worst_case(self) -> bool:
        """True if an axis has tolerances over which its gear is judged."""
        return any(axis.answer["holds"] is not None for axis in self.machine.items)

    @cached_property
    def order(self) -> GearOrder:
        """Gears to order."""
        return gears_of((order_axis(axis.number, axis) for axis in self.machine.items), self.catalogue)

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
        """Largest utilisation with which the governing check of an axis's worst case passes."""
        return bound_of(row.axis, self.common, in_worst_case=True)

    def own(self, row: MachineRow) -> list[FieldValue]:
        """Own values of an axis."""
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
        """Names of all axes by their numbers."""
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
        """Address of the axes sorted by a column, or in the reverse order if they are."""
        turned = f"-{key}" if self.chosen.sort == key else key
        return self.chosen.address(self.path, sort=turned, part=1) + "#axes-heading"

    @property
    def editing_address(self) -> str:
        """Address of the same axes with the form of the common values."""
        address = self.chosen.address(self.path)
        return f"{address}{'&' if '?' in address else '?'}edit=common"

    @property
    def closing_address(self) -> str:
        """Address of the same axes without the form of the common values."""
        return self.chosen.address(self.path)

    @property
    def change_address(self) -> str:
        """Address that receives changes and then shows the same axes."""
        return self.chosen.address(f"{self.path}/change")

    def order_of(self, key: str) -> str:
        """Present order of a column; blank if the axes are not sorted by it."""
        return {key: "ascending", f"-{key}": "descending"}.get(self.chosen.sort or "-utilisation", "")

    @property
    def parts(self) -> int:
        """Number of parts in which the axes are shown."""
        return max(1, -(-len(self.chosen_rows) // ROWS_ON_PAGE))

    def part(self, number: int) -> str:
        """Address of a part; blank for a number without a part."""
        return self.chosen.address(self.path, part=number) + "#axes-heading" if 1 <= number <= self.parts else ""
