"""Permissible loads on the output bearing of each size under an application, and the share that its loads use."""

import math
from dataclasses import dataclass

import numpy as np

from hpn.catalogue.gear import Gear
from hpn.engine.envelopes import EnvelopeCurve, envelope_curve, has_envelope
from hpn.engine.figures import radial_at_centre, shaft_centre_mm
from hpn.explain.drawings.picture import BearingPicture, beyond_limit
from hpn.explain.drawings.subject import Subject


@dataclass(frozen=True, slots=True)
class SizeUse:
    """One size: curves of its permissible loads, and the share of them that the loads use; None where not rated.

    `curve` is for a constant load, `single` for a single one; `constant_load` and `published` are the used shares, None
    without loads. `allowed` is the user's u, `radial_N` the largest radial load at the shaft's centre, and `centre_mm`
    the distance x_c behind it.
    """

    gear: Gear
    curve: EnvelopeCurve | None
    single: EnvelopeCurve | None
    constant_load: float | None
    published: float | None
    allowed: float
    radial_N: float | None = None
    centre_mm: float | None = None

    @property
    def carries(self) -> bool | None:
        """True where both shares are within the allowed one; None where not rated."""
        if self.constant_load is None or self.published is None:
            return None
        return not beyond_limit(max(self.constant_load, self.published), self.allowed)


def size_uses(subject: Subject, picture: BearingPicture) -> list[SizeUse]:
    """Use of the bearing of every size of the catalogue under the conditions of a picture."""
    figures, load, u = subject.of_sizes, picture.load, picture.allowed
    most = min(1.0, picture.life_factor)
    shape = len(subject.sizes.rows), subject.duty.phases.radial_N.shape[-1]
    radial = np.broadcast_to(radial_at_centre(subject.duty, subject.sizes)[0], shape).max(axis=-1).tolist()
    centres = shaft_centre_mm(subject.duty, subject.sizes)[0].tolist()
    mean, largest = figures.bearing_mean_load, figures.bearing_load
    uses = []
    for place, gear in enumerate(subject.sizes.rows):
        curve = single = None
        if has_envelope(subject.catalogue, gear, load.model):
            curve = envelope_curve(subject.catalogue, gear, load.model, load.load_coefficient, u * most)
            single = envelope_curve(subject.catalogue, gear, load.model, load.load_coefficient, u)
        if not picture.loads or math.isnan(mean.item(0, place)):
            uses.append(SizeUse(gear, curve, single, None, None, u))
        else:
            used = mean.item(0, place) / most, largest.item(0, place)
            centre = None if math.isnan(centres[place]) else centres[place]
            uses.append(SizeUse(gear, curve, single, *used, u, radial[place], centre))
    return uses
