"""Distance of the shaft's centre that each size needs where loads ask for it and it is unknown."""

from dataclasses import dataclass

import numpy as np

from hpn.catalogue import GearList
from hpn.engine.duty import Duty
from hpn.engine.figures import Figures, phase_loads, shaft_centre_mm
from hpn.physics import bearing
from hpn.physics.equations import ROUNDING, FloatArray

SHORTEST_MM, LONGEST_MM = 1e-3, 1e6
"""Ends of the search in mm, far beyond any shaft on both sides."""

STEPS = 60
"""Halvings of this range on a logarithmic scale: enough for every digit of a float."""


@dataclass(frozen=True, slots=True)
class NeededCentre:
    """Distances x_c in mm for one size: the known one, and the shortest at which its bearing carries the loads.

    `needed_mm` is None where no distance is enough, and `is_rated` is False where the size has no bearing limits.
    `largest_N` is the largest radial load of a phase if it acted at the shaft's centre.
    """

    size: str
    known_mm: float | None
    needed_mm: float | None
    is_rated: bool
    largest_N: float


def needed_centres(figures: Figures) -> list[NeededCentre]:
    """Needed distance for every size under one application; `figures` are those of the first gear of each size."""
    duty, gears = figures.duty, figures.gears
    known = shaft_centre_mm(duty, gears)[0]
    shortest, longest = (np.full((1, len(known)), end) for end in (SHORTEST_MM, LONGEST_MM))
    ever, always = (_carries(figures, x_c) for x_c in (longest, shortest))
    for _ in range(STEPS):
        middle = np.sqrt(shortest * longest)
        enough = _carries(figures, middle)
        longest, shortest = np.where(enough, middle, longest), np.where(enough, shortest, middle)
    needed = np.where(always, 0.0, np.where(ever, longest, np.nan))[0]
    rated = ~np.isnan(_loads(duty, gears, np.full((1, len(known)), LONGEST_MM)).max(axis=-1))[0]
    largest = duty.phases.radial_N.max().item()
    return [
        NeededCentre(gear.size, _number(known[at]), _number(needed[at]), bool(rated[at]), largest)
        for at, gear in enumerate(gears.rows)
    ]


def _number(value: FloatArray) -> float | None:
    return None if np.isnan(value) else float(value)


def _carries(figures: Figures, centre_mm: FloatArray) -> FloatArray:
    """True where a size's bearing passes its checks with the shaft's centre at a distance; shape (1, sizes)."""
    duty, u = figures.duty, figures.duty.inputs["requirements.utilisation"]
    loads, phases = _loads(duty, figures.gears, centre_mm), duty.phases
    mean = bearing.mean_equivalent_load(equivalent_load=loads, speed_rpm=phases.speed_rpm, duration_s=phases.duration_s)
    most = u * (1 + ROUNDING)
    passes: FloatArray = (loads.max(axis=-1) <= most) & (mean <= figures.bearing_life_factor * most)
    return passes


def _loads(duty: Duty, gears: GearList, centre_mm: FloatArray) -> FloatArray:
    """Load f_w P of every phase on every size with the shaft's centre at a distance, shape (1, sizes, phases)."""
    inputs, phases = duty.inputs, duty.phases
    y = inputs["output_load.axial_radius_mm"]
    radial = bearing.radial_load_at_centre(
        radial_N=phases.radial_N,
        axial_N=phases.axial_N,
        radial_position_mm=inputs["output_load.radial_position_mm"][..., None],
        axial_radius_mm=np.where(np.isnan(y), 0.0, y)[..., None],
        shaft_centre_mm=centre_mm[..., None],
    )
    return phase_loads(duty, gears, radial)
