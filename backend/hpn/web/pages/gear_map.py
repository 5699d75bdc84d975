"""Map of sizes and ratios: each gear of a catalogue by its largest utilisation."""

from collections.abc import Mapping
from dataclasses import dataclass

from hpn.catalogue import Catalogue
from hpn.catalogue.gear import Gear
from hpn.engine.candidates import REASONS, Candidate
from hpn.engine.selection import Selection
from hpn.words.wording import Sentence


@dataclass(frozen=True)
class MapCell:
    """Gear in the map of sizes and ratios; `is_required` is True if the required sizes and ratios include it."""

    gear: Gear
    candidate: Candidate
    is_required: bool

    @property
    def level(self) -> str:
        """Step of the scale: reserve of a suitable gear, `over` for a failed one, `unknown` for one without ratings."""
        torque = self.candidate.check("average_torque")
        if self.candidate.status == "unrated" or (torque and torque.status == "not_rated"):
            return "unknown"
        used = self.candidate.utilisation or 0.0
        reserve = "most" if used <= 0.6 else "more" if used <= 0.85 else "some"
        return reserve if self.candidate.status == "suitable" else "over"

    @property
    def unrated(self) -> Sentence:
        """Sentence on a gear without ratings, independent of its other checks."""
        return Sentence(REASONS["unrated"], {"name": f"HPN-{self.gear.size}"})


GearMap = tuple[tuple[int, tuple[MapCell | None, ...]], ...]
"""Ratios, each with its cells in the order of the sizes; None for a gear that is not made or not judged."""


def map_of(selection: Selection, candidates: Mapping[str, Candidate], catalogue: Catalogue) -> GearMap:
    """Map of the judged gears; `candidates` are by designation."""
    names = {candidate.designation for candidate in selection.candidates}
    gears = {(gear.ratio, gear.size): gear for gear in catalogue.gears}

    def cell(ratio: int, size: str) -> MapCell | None:
        gear = gears.get((ratio, size))
        candidate = candidates.get(gear.designation) if gear else None
        return MapCell(gear, candidate, gear.designation in names) if gear and candidate else None

    return tuple((ratio, tuple(cell(ratio, size) for size in catalogue.sizes)) for ratio in catalogue.ratios)
