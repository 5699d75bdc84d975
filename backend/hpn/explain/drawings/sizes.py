"""Loads permitted on the output bearing of each size under an application, and how far its loads use it."""

import math
from dataclasses import dataclass

from hpn.catalogue.gear import Gear
from hpn.engine.envelopes import EnvelopeCurve, envelope_curve, has_envelope
from hpn.explain.drawings.picture import BearingPicture, beyond_limit
from hpn.explain.drawings.subject import Subject


@dataclass(frozen=True, slots=True)
class SizeUse:
    """One size: what a constant load may be on it, and how far the loads use it, each None where it is not rated.

    `allowed` is the user's u. Without loads nothing is used.
    """

    gear: Gear
    curve: EnvelopeCurve | None
    constant_load: float | None
    published: float | None
    allowed: float

    @property
    def carries(self) -> bool | None:
        """True where both are within the allowed share; None where it is not rated."""
        if self.constant_load is None or self.published is None:
            return None
        return not beyond_limit(max(self.constant_load, self.published), self.allowed)


def size_uses(subject: Subject, picture: BearingPicture) -> list[SizeUse]:
    """Use of the bearing of every size of the catalogue, under the conditions of a picture."""
    figures, load, u = subject.of_sizes, picture.load, picture.allowed
    most = min(1.0, picture.life_factor)
    uses = []
    for place, gear in enumerate(subject.sizes.rows):
        curve = None
        if has_envelope(subject.catalogue, gear, load.model):
            curve = envelope_curve(subject.catalogue, gear, load.model, load.load_coefficient, u * most)
        mean, largest = figures.bearing_mean_load, figures.bearing_load
        if not picture.loads or math.isnan(mean.item(0, place)):
            uses.append(SizeUse(gear, curve, None, None, u))
        else:
            uses.append(SizeUse(gear, curve, mean.item(0, place) / most, largest.item(0, place), u))
    return uses
