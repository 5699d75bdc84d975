"""Additions of the page to a verdict: reserves, the remedy to try, and gears side by side."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from urllib.parse import quote

from hpn.account.account import Account
from hpn.application import Application, OutputLoad
from hpn.catalogue import Catalogue
from hpn.engine.candidates import Candidate
from hpn.engine.selection import Selection
from hpn.explain.comparison import MOST_PINS, RowGroup, groups_of, lighter_miss, undominated
from hpn.links.writer import to_link
from hpn.web.form.form import Form
from hpn.web.form.query import FieldProblem
from hpn.words.wording import N_, Sentence


@dataclass(frozen=True)
class Insight:
    """Reserves, remedy and neighbours of the chosen gear, each calculated when a section needs it.

    `everything` holds all gears of the catalogue by designation; `pins` are the gears that the reader pinned; `links`
    makes the address of the same page with another application.
    """

    application: Application
    selection: Selection
    everything: Mapping[str, Candidate]
    chosen: Candidate
    pins: tuple[str, ...]
    catalogue: Catalogue
    links: Callable[[Application], str] = to_link

    @property
    def same_life(self) -> str:
        """Link with the gear's required life as required L10 of the output bearing."""
        load = self.application.loads or OutputLoad()
        lasting = load.model_copy(update={"life_h": self.application.requirements.life_h, "life_basis": "L10"})
        return self.links(self.application.model_copy(update={"output_load": lasting}))

    @property
    def at_centre(self) -> str:
        """Link of the application with its loads at the shaft's centre and along the shaft's axis."""
        load = self.application.loads or OutputLoad()
        placed = load.model_copy(update={"radial_position_mm": None, "axial_radius_mm": 0.0})
        return to_link(self.application.model_copy(update={"output_load": placed}))

    @cached_property
    def columns(self) -> tuple[Account, ...]:
        """Accounts of the gears side by side: the chosen one, and the pinned ones, or without pins the next one."""
        candidates = [self.chosen, *(self.everything[pin] for pin in self.pins if pin != self.chosen.designation)]
        if len(candidates) == 1 and (second := self._second()):
            candidates.append(second)
        return tuple(Account(self.selection, entry, self.application, self.catalogue) for entry in candidates)

    @property
    def groups(self) -> list[RowGroup]:
        """Rows of the comparison."""
        return groups_of(self.columns)

    @cached_property
    def undominated(self) -> frozenset[str]:
        """Suitable gears that no other gear dominates."""
        return undominated(self.selection.candidates, self.catalogue)

    def _second(self) -> Candidate | None:
        """Gear to compare with if none is pinned: the foremost unless chosen, else the lighter miss, else the next."""
        lighter = lighter_miss(self.selection, self.selection.selected, self.catalogue.by_designation)
        others = [lighter] if lighter else []
        others += [candidate for candidate in self.selection.candidates if candidate.status != "unrated"]
        if self.chosen.designation != self.selection.foremost.designation:
            others.insert(0, self.selection.foremost)
        return next((other for other in others if other.designation != self.chosen.designation), None)

    @property
    def full(self) -> bool:
        """True if no more gears can be pinned."""
        return len(self.pins) >= MOST_PINS


def tail_of(pins: Sequence[str]) -> str:
    """Query of pins."""
    return "".join(f"&pin={quote(pin)}" for pin in pins)


def checked_pins(form: Form, catalogue: Catalogue) -> Form:
    """Form with its pins by their canonical names, each once; unknown or excess pins become problems."""
    problems = [
        FieldProblem("pin", None, Sentence(N_("{gear} is not a gear of the catalogue"), {"gear": pin[:40]}))
        for pin in form.pins[: MOST_PINS + 1]
        if catalogue.find(pin) is None
    ]
    known = tuple(dict.fromkeys(gear.designation for pin in form.pins if (gear := catalogue.find(pin)) is not None))
    if len(known) > MOST_PINS:
        text = N_("at most {most} gears can be pinned; the link gives {count}")
        problems.append(FieldProblem("pin", None, Sentence(text, {"most": MOST_PINS, "count": len(known)})))
    return replace(form, pins=known[:MOST_PINS], problems=(*form.problems, *problems))
