"""Loads of one application on an output bearing: the data of drawing, plot, table and verdict."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from hpn.application import OutputLoad
from hpn.catalogue import Catalogue
from hpn.catalogue.gear import Gear
from hpn.engine.candidates import CheckResult
from hpn.engine.duty import Duty
from hpn.engine.envelopes import EnvelopeCurve, EnvelopeQuery, envelope_curve, envelopes_for, has_envelope
from hpn.engine.figures import phase_loads, radial_at_centre
from hpn.explain.drawings.subject import Subject
from hpn.explain.drawings.words import phase_numbers
from hpn.physics import bearing
from hpn.physics.equations import ROUNDING
from hpn.words.titles import numbered
from hpn.words.wording import Quantity, Sentence, Value

MOST_LOADS = 200
"""Different loads, at most, in plot and table; of more, those that use the published maximum most."""


MOST_MARKED = 100
"""First phases, at most, with their own rows on a page, so that a load can be marked together with them."""


@dataclass(frozen=True, slots=True)
class PhaseLoad:
    """One load in N, its phases, and its f_w P, which `allowed` limits; the published envelope is 1.

    `radial_N` acts at the shaft's centre; `given_N` is the given load at its own place.
    """

    places: list[int]
    radial_N: float
    axial_N: float
    published: float
    allowed: float = 1.0
    given_N: float = 0.0
    name: str | None = None

    @property
    def has_lever(self) -> bool:
        """True for a load beside the shaft's centre, with a different equivalent there."""
        return self.given_N != self.radial_N

    @property
    def phases(self) -> str:
        """Numbers of the phases, counted from 1."""
        return phase_numbers(self.places)

    @property
    def spoken(self) -> str:
        """Numbers of the phases for a sentence; a single phase with its name."""
        return self.phases if len(self.places) > 1 else numbered(self.places[0], self.name)

    @property
    def marked(self) -> list[int]:
        """Places of the phases whose rows are marked together with the load."""
        return [place for place in self.places if place < MOST_MARKED]

    @property
    def magnitude_N(self) -> float:
        """Length of the load vector."""
        return math.hypot(self.radial_N, self.axial_N)

    @property
    def limit_N(self) -> float | None:
        """Largest permissible load in its own direction."""
        return self.magnitude_N * (self.allowed / self.published) if self.published > 1e-300 else None

    @property
    def distance_N(self) -> float | None:
        """Distance from the load to this limit; negative beyond it."""
        return None if self.limit_N is None else self.limit_N - self.magnitude_N

    @property
    def is_outside(self) -> bool:
        """True for a load above the limit of a single load."""
        return beyond_limit(self.published, self.allowed)


CurveKind = Literal["own", "life", "published", "equivalent"]


@dataclass(frozen=True, slots=True)
class NamedCurve:
    """One curve of the picture, and its condition; `kind` tells the curves apart in the figure."""

    kind: CurveKind
    name: Sentence
    curve: EnvelopeCurve

    @property
    def corners(self) -> list[tuple[float, float]]:
        """Radial and axial load in N of each corner, from the axial to the radial axis."""
        return list(zip(self.curve.radial_N, self.curve.axial_N, strict=True))


@dataclass(frozen=True, slots=True)
class BearingPicture:
    """Permissible loads on the output bearing of one gear at the speed and life of an application, and its own loads.

    `mean` is P_m without f_w, `life_factor` the k for speed and required life, `allowed` the user's u, which scales
    every curve except the equivalent load's. `loads` are in the order of the phases, and `hidden` is the number of
    omitted ones. Without a load `loads` is empty, and `load` holds the default conditions.
    """

    gear: Gear
    load: OutputLoad
    allowed: float
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
        """The load that uses the published envelope most; there must be loads."""
        return max(self.loads, key=lambda load: load.published)

    @property
    def equivalent_N(self) -> tuple[float, float]:
        """Constant load with the life of the cycle, radial and axial, in the direction of the worst load."""
        worst = self.worst
        share = self.mean * self.load.load_coefficient / worst.published if worst.published > 1e-300 else 0.0
        return share * worst.radial_N, share * worst.axial_N

    @property
    def life_utilisation(self) -> float:
        """Equivalent load over the load that the required life permits: f_w P_m over k."""
        return self.mean * self.load.load_coefficient / self.life_factor

    @property
    def constant_load_utilisation(self) -> float:
        """Equivalent load over the permissible constant load: f_w P_m over min(1, k)."""
        return self.mean * self.load.load_coefficient / min(1.0, self.life_factor)

    @property
    def life_h(self) -> float:
        """Life of the bearing on the basis of the required one; infinite without a load."""
        used = self.life_utilisation
        return self.load.life_h / used**3 if used > 1e-100 else math.inf

    @property
    def life_governs(self) -> bool:
        """True if the cycle's life is nearer to its limit than the largest single load."""
        return self.life_factor < 1 and self.life_utilisation >= self.worst.published

    @property
    def named_curves(self) -> list[NamedCurve]:
        """All curves, the user's own first."""
        f_w = self.load.load_coefficient
        own = [
            NamedCurve("own", Sentence("Limit now: constant load, f_w = {f_w}", _coefficient(curve)), curve)
            for curve in self.curves
            if curve.load_coefficient == f_w
        ]
        others = [
            NamedCurve("life", Sentence("Constant load, f_w = {f_w}", _coefficient(curve)), curve)
            for curve in self.curves
            if curve.load_coefficient != f_w
        ]
        published = Sentence("Single load: published maximum over f_w = {f_w}", _coefficient(self.published_curve))
        named = [*own, *others, NamedCurve("published", published, self.published_curve)]
        equivalent = NamedCurve("equivalent", Sentence("Equivalent load of the cycle, P = P_m"), self.mean_curve)
        return [*named, equivalent] if self.mean > 0 else named

    @property
    def condition(self) -> Sentence:
        """Speed and life of the curves, and the user's u if below 1."""
        values: dict[str, Value] = {
            "speed": Quantity(self.average_output_speed_rpm, "rpm"),
            "life": Quantity(self.load.life_h, "h", 6),
            "basis": self.load.life_basis,
        }
        if self.allowed == 1:
            return Sentence("{speed}, {life}, {basis}", values)
        return Sentence(
            "{speed}, {life}, {basis}, u = {allowed}", values | {"allowed": Quantity(100 * self.allowed, "percent", 6)}
        )


def _coefficient(curve: EnvelopeCurve) -> dict[str, Value]:
    return {"f_w": Quantity(curve.load_coefficient, "", 6)}


def beyond_limit(utilisation: float, allowed: float) -> bool:
    """True for a utilisation above the allowed one by more than rounding."""
    return utilisation > allowed * (1 + ROUNDING)


def bearing_picture(
    subject: Subject,
    life: CheckResult | None = None,
    condition: EnvelopeQuery | None = None,
    *,
    without_lever: bool = False,
) -> BearingPicture | None:
    """Picture of a gear's bearing, or None if its size has no envelope or its loads are not rated.

    `life` is the check of the bearing's life, new or saved: it compares f_w P_m and k. Without a load the picture is
    for a `condition`, or for the cycle's speed and the default life. `without_lever` shows loads with an unknown lever
    at their own places.
    """
    application, catalogue, gear = subject.application, subject.catalogue, subject.gear
    load, allowed = application.loads or OutputLoad(), application.requirements.utilisation
    speed_rpm = subject.duty.average_output_speed_rpm.item()
    if application.loads is None and condition is not None:
        load = OutputLoad(load_coefficient=condition.load_coefficient, life_h=condition.life_h, model=condition.model)
        speed_rpm = condition.speed_rpm
    if not has_envelope(catalogue, gear, load.model):
        return None
    loads: list[PhaseLoad] = []
    mean, k = 0.0, _life_factor(catalogue, load, speed_rpm)
    if application.loads is not None:
        demand = _demand_of(life, without_lever=without_lever)
        if life is None or demand is None or life.limit is None:
            return None
        mean, k = demand / load.load_coefficient, life.limit
        loads = _loads_of(subject, without_lever=without_lever)
    return BearingPicture(
        gear=gear,
        load=load,
        allowed=allowed,
        loads=_foremost(loads),
        hidden=max(len(loads) - MOST_LOADS, 0),
        mean=mean,
        life_factor=k,
        average_output_speed_rpm=speed_rpm,
        curves=envelopes_for(catalogue, gear, load.model, load.load_coefficient, allowed * min(1.0, k)),
        published_curve=envelope_curve(catalogue, gear, load.model, load.load_coefficient, allowed),
        mean_curve=envelope_curve(catalogue, gear, load.model, 1.0, mean),
    )


def _demand_of(life: CheckResult | None, *, without_lever: bool) -> float | None:
    """Equivalent load f_w P_m of a check of the bearing's life; without its lever the lower bound."""
    if life is None or not without_lever:
        return None if life is None else life.demand
    return None if life.at_least is None or life.limit is None else life.at_least * life.limit


def _loads_of(subject: Subject, *, without_lever: bool) -> list[PhaseLoad]:
    duty, sizes = subject.duty, subject.sizes
    radial = duty.phases.radial_N if without_lever else radial_at_centre(duty, sizes)
    published = phase_loads(duty, sizes, radial)[0, subject.place].tolist()
    own = radial[0, subject.place if radial.shape[1] > 1 else 0].tolist()
    names = [phase.name for phase in subject.application.duty_cycle.load_phases]
    return different_loads(duty, own, published, subject.application.requirements.utilisation, names)


def default_condition(subject: Subject) -> EnvelopeQuery:
    """Default condition of a shaft's permissible loads without given loads: the speed of the cycle and the default
    life.
    """
    load = OutputLoad()
    return EnvelopeQuery(speed_rpm=subject.duty.average_output_speed_rpm.item(), life_h=load.life_h, model=load.model)


def _life_factor(catalogue: Catalogue, load: OutputLoad, speed_rpm: float) -> float:
    """Factor k of an application on the published limits, from speed and required life."""
    speed, life = catalogue.bearing_reference
    k = bearing.life_factor(
        average_output_speed_rpm=speed_rpm,
        required_life_L50_h=bearing.required_L50(life_h=load.life_h, basis=load.life_basis),
        reference_speed_rpm=speed,
        reference_life_h=life,
    )
    return float(k)


def different_loads(
    duty: Duty,
    radial_N: Sequence[float],
    published: Sequence[float],
    allowed: float,
    names: Sequence[str | None],
) -> list[PhaseLoad]:
    """Different loads of a cycle, in the order of their first occurrence.

    For each phase `radial_N` is the radial load at the shaft's centre, and `published` its f_w P.
    """
    loads: dict[tuple[float, float], PhaseLoad] = {}
    series = (radial_N, duty.phases.axial_N[0, 0].tolist(), published, duty.phases.radial_N[0, 0].tolist())
    for place, (radial, axial, used, entered) in enumerate(zip(*series, strict=True)):
        load = PhaseLoad([], radial, axial, used, allowed, entered, names[place])
        loads.setdefault((entered, axial), load).places.append(place)
    return list(loads.values())


def _foremost(loads: list[PhaseLoad]) -> list[PhaseLoad]:
    if len(loads) <= MOST_LOADS:
        return loads
    first = sorted(loads, key=lambda load: load.published, reverse=True)[:MOST_LOADS]
    return sorted(first, key=lambda load: load.places[0])
