"""What a page shows of a selection, computed just now or saved: the partials of the templates read it."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from hpn.application import Application, RankBy
from hpn.catalogue import Catalogue
from hpn.checks import BY_CODE, allowed
from hpn.gear import Gear
from hpn.remedy import remedy_of
from hpn.selection import Candidate, Selection
from hpn.wording import N_, Sentence

BEST: Mapping[RankBy, str] = {
    "weight": N_("The lightest gear that passes every check."),
    "utilisation": N_("The gear that stays furthest below its closest limit."),
    "length": N_("The shortest gear that passes every check."),
    "motor_torque": N_("The gear that needs the least motor torque among those that pass every check."),
    "life": N_("The gear with the longest life among those that pass every check."),
    "stiffness": N_("The stiffest gear that passes every check."),
}
"""Why the selected gear is selected, by what the candidates are ranked by."""

LONGEST_REPEATED = 3000
"""Length of a link up to which a page may carry it hundreds of times."""


@dataclass(frozen=True, kw_only=True)
class Result:
    """A selection, and the candidate that the page looks at; `asked` tells whether the reader chose it.

    `application` is None where it was saved by a version with other inputs. `catalogue` is the one that the selection
    was made from, None where that is not kept. `choosing` and `tail` stand before and behind the designation in the
    address that looks at another candidate.
    """

    selection: Selection
    application: Application | None
    chosen: Candidate
    asked: bool
    catalogue: Catalogue | None
    remedies: Mapping[str, Sentence | None]
    lighter: Candidate | None
    choosing: str
    tail: str = ""
    live: bool = False

    @property
    def gears(self) -> Mapping[str, Gear]:
        """Catalogue figures by designation, as far as they are known."""
        return self.catalogue.by_designation if self.catalogue else {}

    @property
    def names(self) -> Mapping[str, str]:
        """Checks by code, as they stand inside a sentence."""
        return {code: BY_CODE[code].name for code in self.selection.check_definitions}

    @property
    def bounds(self) -> Mapping[str | None, float]:
        """Largest utilisation with which each check passes, by code; 1 where none governs."""
        return {code: allowed(code, self.utilisation) for code in (None, *self.selection.check_definitions)}

    @property
    def gear(self) -> Gear | None:
        """Catalogue figures of the chosen candidate."""
        return self.gears.get(self.chosen.designation)

    @property
    def utilisation(self) -> float:
        """Largest utilisation that was accepted."""
        return self.application.requirements.utilisation if self.application else 1.0

    @property
    def linked(self) -> bool:
        """Whether that address is short enough to stand once for each gear."""
        return len(self.choosing) <= LONGEST_REPEATED


def remedies_of(
    candidates: Iterable[Candidate], gears: Mapping[str, Gear], utilisation: float
) -> dict[str, Sentence | None]:
    """What would make each candidate fit, by designation, as far as its catalogue figures are known."""
    return {
        candidate.designation: remedy_of(candidate, utilisation)
        for candidate in candidates
        if candidate.designation in gears
    }


def lighter_miss(selection: Selection, gears: Mapping[str, Gear]) -> Candidate | None:
    """The rejected gear closest to passing among those that are judged and lighter than the selected one."""
    weight = _weight(selection.selected, gears)
    if weight is None:
        return None
    for candidate in selection.candidates:
        own = _weight(candidate.designation, gears)
        if candidate.status == "unsuitable" and own is not None and own < weight and candidate.is_judged:
            return candidate
    return None


def _weight(designation: str | None, gears: Mapping[str, Gear]) -> float | None:
    gear = gears.get(designation or "")
    return gear.weight_kg if gear else None
