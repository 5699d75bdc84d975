"""Gears as the handbook prints them, and an answer on them, of the contract that `contract.py` works out."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from tests.reference import handbook as book


@dataclass(frozen=True)
class Arithmetic:
    """Numbers to compute with: how a figure becomes one, their sum, and the largest whole number below one."""

    number: Callable[[Any], Any] = float
    total: Callable[[Iterable[Any]], Any] = math.fsum
    floor: Callable[[Any], int] = math.floor


FLOATS = Arithmetic()


@dataclass
class Gear:
    """Figures of a gear; None is not published."""

    size: str
    ratio: int
    stages: int
    T_R: float | None = None
    T_N: float | None = None
    T_M: float | None = None
    n_max: float | None = None
    n_av: float | None = None
    ambient: tuple[float, float] | None = None
    weight: float | None = None
    length: float | None = None
    backlash: float | None = None
    accuracy: float | None = None
    K3: float | None = None
    F_R: float | None = None
    F_A: float | None = None
    curve: Sequence[tuple[float, float]] | None = None  # (radial, axial), from the radial axis to the axial one

    @property
    def name(self) -> str:
        return f"HPN-{self.size}-{self.ratio}"


@dataclass
class Check:
    code: str
    demand: float | None
    limit: float | None
    utilisation: float | None  # infinite where it fails without one
    status: str
    at_least: float | None = None


@dataclass
class Candidate:
    gear: Gear
    checks: list[Check]
    figures: dict[str, float | None]
    status: str = ""
    utilisation: float | None = None
    governing: str | None = None
    rank: int | None = None

    @property
    def lacks_input(self) -> bool:
        """True for an unrated gear of which a lower bound says something wherever it is not rated."""
        unknown = [check for check in self.checks if check.status == "not_rated"]
        return self.status == "unrated" and all(check.at_least is not None for check in unknown)


@dataclass
class Answer:
    duty: dict[str, float]
    candidates: list[Candidate] = field(default_factory=list)

    @property
    def selected(self) -> str | None:
        first = self.candidates[0]
        return first.gear.name if first.status == "suitable" else None


def printed_gears() -> list[Gear]:
    """All gears in the order of the catalogue: by size, then ratio."""
    gears = []
    for size, ratios in book.RATIOS.items():
        for place, ratio in enumerate(ratios):
            stages = book.STAGES[ratio]
            gear = Gear(size, ratio, stages)
            gear.backlash = book.BACKLASH_ARCMIN[size, stages]
            gear.accuracy = book.TRANSMISSION_ACCURACY_ARCMIN[size, stages]
            gear.K3 = book.TORSIONAL_STIFFNESS_NM_PER_RAD[size, stages]
            if size in book.RATED_TORQUE_NM:
                gear.T_R = book.REPEATED_PEAK_TORQUE_NM[size][place]
                gear.T_N = book.RATED_TORQUE_NM[size][place]
                gear.T_M = book.MOMENTARY_PEAK_TORQUE_NM[size][place]
                gear.n_max = book.MAXIMUM_INPUT_SPEED_RPM[size]
                gear.n_av = book.AVERAGE_INPUT_SPEED_RPM[size]
                gear.ambient = book.AMBIENT_TEMPERATURE_DEGC[size]
                gear.weight = book.WEIGHT_KG[size, stages]
                gear.length = book.LENGTH_MM[size, stages][1]
                gear.F_R = book.DYNAMIC_RADIAL_LOAD_N[size]
                gear.F_A = book.DYNAMIC_AXIAL_LOAD_N[size]
            gears.append(gear)
    return gears


def own_of(phase: Mapping[str, Any], name: str, steady: str) -> float:
    """A figure of a phase that varies; of a steady one the magnitude of its torque or speed."""
    own: float = abs(phase[steady]) if phase.get(name) is None else phase[name]
    return own


def peak_of(phase: Mapping[str, Any], name: str) -> float:
    return own_of(phase, f"peak_{name}", name)
