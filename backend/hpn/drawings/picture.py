"""Loads of one application on an output bearing: what plot, table and verdict are made from."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from hpn import bearing
from hpn.application import OutputLoad
from hpn.drawings.subject import Subject
from hpn.drawings.words import phase_numbers, share
from hpn.duty import Duty
from hpn.envelopes import EnvelopeCurve, envelope_curve, envelopes_for
from hpn.equations import ROUNDING
from hpn.figures import phase_loads
from hpn.gear import Gear
from hpn.wording import Quantity, Sentence, Value

MOST_LOADS = 200
"""Different loads that plot and table show; of more, those that use the published maximum most."""


@dataclass(frozen=True, slots=True)
class PhaseLoad:
    """One load in N, the phases that have it, and its f_w P: 1 on the published envelope over f_w."""

    places: list[int]
    radial_N: float
    axial_N: float
    published: float

    @property
    def phases(self) -> str:
        """Numbers of the phases as a reader counts them."""
        return phase_numbers(self.places)

    @property
    def magnitude_N(self) -> float:
        """Length of the load vector."""
        return math.hypot(self.radial_N, self.axial_N)

    @property
    def distance_N(self) -> float | None:
        """From the load to the published envelope over f_w along its own direction; negative beyond it."""
        return self.magnitude_N * (1 / self.published - 1) if self.published > 1e-300 else None


CurveKind = Literal["own", "life", "published", "equivalent"]


@dataclass(frozen=True, slots=True)
class NamedCurve:
    """One curve of the picture, and the condition that it stands for; `kind` tells the curves apart in the figure."""

    kind: CurveKind
    name: Sentence
    curve: EnvelopeCurve

    @property
    def corners(self) -> list[tuple[float, float]]:
        """Radial and axial load in N of each corner, from the axial to the radial axis."""
        return list(zip(self.curve.radial_N, self.curve.axial_N, strict=True))


@dataclass(frozen=True, slots=True)
class BearingPicture:
    """Loads of one application on the output bearing of one candidate.

    `mean` is P_m without f_w, `life_factor` the k that speed and required life allow; `loads` are in the order of the
    phases, and `hidden` is the number of those left out.
    """

    gear: Gear
    load: OutputLoad
    loads: list[PhaseLoad]
    hidden: int
    mean: float
    life_factor: float
    average_output_speed_rpm: float
    curves: list[EnvelopeCurve]
    published_curve: EnvelopeCurve
    mean_curve: EnvelopeCurve

    @property
    def worst(self) -> PhaseLoad:
        """The load that uses the published envelope most."""
        return max(self.loads, key=lambda load: load.published)

    @property
    def life_utilisation(self) -> float:
        """Equivalent load over what its life allows: f_w P_m over k."""
        return self.mean * self.load.load_coefficient / self.life_factor

    @property
    def constant_load_utilisation(self) -> float:
        """Share of what a constant load may be: f_w P_m over min(1, k)."""
        return self.mean * self.load.load_coefficient / min(1.0, self.life_factor)

    @property
    def named_curves(self) -> list[NamedCurve]:
        """All curves, the user's own first."""
        f_w = self.load.load_coefficient
        own = [
            NamedCurve("own", Sentence("Constant load, f_w = {f_w} (yours)", _coefficient(curve)), curve)
            for curve in self.curves
            if curve.load_coefficient == f_w
        ]
        others = [
            NamedCurve("life", Sentence("Constant load, f_w = {f_w}", _coefficient(curve)), curve)
            for curve in self.curves
            if curve.load_coefficient != f_w
        ]
        published = Sentence("Any single phase: published maximum over f_w = {f_w}", _coefficient(self.published_curve))
        named = [*own, *others, NamedCurve("published", published, self.published_curve)]
        equivalent = NamedCurve("equivalent", Sentence("Equivalent load of the cycle, P = P_m"), self.mean_curve)
        return [*named, equivalent] if self.mean > 0 else named


def _coefficient(curve: EnvelopeCurve) -> dict[str, Value]:
    return {"f_w": Quantity(curve.load_coefficient, "", 6)}


def beyond_limit(utilisation: float, allowed: float) -> bool:
    """Whether so much of a limit is more than is allowed, floating-point rounding apart."""
    return utilisation > allowed * (1 + ROUNDING)


def bearing_picture(subject: Subject) -> BearingPicture | None:
    """Loads on the bearing of a gear, or None without loads or where the bearing of its size is not rated."""
    if subject.application.loads is None:
        return None
    mean = subject.of_sizes.bearing_mean_load.item(0, subject.place)
    return None if math.isnan(mean) else picture_of(subject, mean, subject.of_sizes.bearing_life_factor.item())


def picture_of(subject: Subject, mean_load: float, life_factor: float) -> BearingPicture:
    """The same with f_w P_m and k that are known, as a saved selection has them: what its check of the life compares.

    The application must give loads, and the bearing must be rated.
    """
    load, catalogue, gear = subject.application.loads, subject.catalogue, subject.gear
    assert load is not None
    f_w = load.load_coefficient
    loads = different_loads(subject.duty, phase_loads(subject.duty, subject.sizes)[0, subject.place].tolist())
    return BearingPicture(
        gear=gear,
        load=load,
        loads=_foremost(loads),
        hidden=max(len(loads) - MOST_LOADS, 0),
        mean=mean_load / f_w,
        life_factor=life_factor,
        average_output_speed_rpm=subject.duty.average_output_speed_rpm.item(),
        curves=envelopes_for(catalogue, gear, load.model, f_w, life_factor),
        published_curve=envelope_curve(catalogue, gear, load.model, f_w),
        mean_curve=envelope_curve(catalogue, gear, load.model, 1.0, mean_load / f_w),
    )


def different_loads(duty: Duty, published: Sequence[float]) -> list[PhaseLoad]:
    """Different loads of a cycle, in the order in which they first occur; `published` is f_w P of each phase."""
    found: dict[tuple[float, float], PhaseLoad] = {}
    series = (duty.phases.radial_N[0, 0].tolist(), duty.phases.axial_N[0, 0].tolist(), published)
    for place, (radial, axial, used) in enumerate(zip(*series, strict=True)):
        found.setdefault((radial, axial), PhaseLoad([], radial, axial, used)).places.append(place)
    return list(found.values())


def _foremost(loads: list[PhaseLoad]) -> list[PhaseLoad]:
    if len(loads) <= MOST_LOADS:
        return loads
    kept = sorted(loads, key=lambda load: load.published, reverse=True)[:MOST_LOADS]
    return sorted(kept, key=lambda load: load.places[0])


# --- All sizes --------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class SizeUse:
    """How far the loads use the bearing of one size; None where it is not rated. `allowed` is the user's u."""

    gear: Gear
    constant_load: float | None
    published: float | None
    allowed: float

    @property
    def carries(self) -> bool | None:
        """Whether both questions are answered with yes; None where it is not rated."""
        if self.constant_load is None or self.published is None:
            return None
        return not beyond_limit(max(self.constant_load, self.published), self.allowed)


def size_uses(subject: Subject) -> list[SizeUse]:
    """Use of the bearing of every size of the catalogue; none without loads."""
    if subject.application.loads is None:
        return []
    figures, allowed = subject.of_sizes, subject.application.requirements.utilisation
    most = min(1.0, figures.bearing_life_factor.item())
    uses = []
    for place, gear in enumerate(subject.sizes.rows):
        mean, largest = figures.bearing_mean_load.item(0, place), figures.bearing_load.item(0, place)
        is_rated = not math.isnan(mean)
        uses.append(SizeUse(gear, mean / most if is_rated else None, largest if is_rated else None, allowed))
    return uses


# --- In words ---------------------------------------------------------------------------------------------------------


def bearing_verdict(picture: BearingPicture) -> list[Sentence]:
    """What the picture says, in words: the life of the cycle, the largest single load, the next f_w, what decides."""
    worst = picture.worst
    sentences = [
        Sentence(
            "The cycle uses {used} of what a constant load may be at {speed} for {life} ({basis}).",
            {
                "used": share(picture.constant_load_utilisation),
                "speed": Quantity(picture.average_output_speed_rpm, "rpm"),
                "life": Quantity(picture.load.life_h, "h", 6),
                "basis": picture.load.life_basis,
            },
        ),
        _worst_phase(worst, alone=len(picture.loads) == 1),
        *_next_load_coefficient(picture),
    ]
    if picture.life_factor >= 1 or picture.life_utilisation < worst.published:
        return [*sentences, Sentence("The largest single load decides, not the life.")]
    return [*sentences, Sentence("The life of the bearing decides, not the largest single load.")]


def _worst_phase(worst: PhaseLoad, *, alone: bool) -> Sentence:
    used = share(worst.published)
    if alone:
        return Sentence("The load uses {used} of the published maximum.", {"used": used})
    return Sentence("Phase {phase} uses {used} of the published maximum.", {"phase": worst.places[0] + 1, "used": used})


def _next_load_coefficient(picture: BearingPicture) -> list[Sentence]:
    """What the next printed load coefficient would do to the first sentence."""
    f_w, used = picture.load.load_coefficient, picture.constant_load_utilisation
    larger = next((printed for printed in bearing.PRINTED_LOAD_COEFFICIENTS if printed > f_w), None)
    if larger is None or used == 0:
        return []
    used = used * larger / f_w
    values: dict[str, Value] = {"coefficient": Quantity(larger, "")}
    if used > 1:
        values["excess"] = Quantity(100 * (used - 1), "percent")
        return [Sentence("f_w = {coefficient} would exceed the first by {excess}.", values)]
    return [Sentence("f_w = {coefficient} would use {used}.", values | {"used": share(used)})]
