"""Pairs of gear and motor for an application: every gear that it allows with every motor, judged as `select` judges.

Whether motor and gear fit mechanically is not judged.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from hpn.application import MOST_MOTORS, Application, InputError, MotorEntry, Pairing
from hpn.catalogue import Catalogue, GearList
from hpn.engine.allowed import gears_for
from hpn.engine.checks import CHECKS
from hpn.engine.evaluation import STATUS, SUITABLE, UNRATED, UNSUITABLE, BoolArray, PlaceArray, Status
from hpn.engine.motor_torques import inertia_ratio
from hpn.engine.motors import LOADS, with_figures, with_motors
from hpn.engine.notice import Notice
from hpn.engine.pair_notices import notices_on
from hpn.physics.equations import ROUNDING, FloatArray, tied
from hpn.words.reply import Reply, finite
from hpn.words.wording import N_, Sentence

RESONANCE = "drive_resonance"
"""Code of the check of the least resonance, which only pairs have."""

CODES = (*(check.code for check in CHECKS), RESONANCE)

AT_ONCE = 500
"""Motors that are evaluated together, so that their arrays stay within some 50 MB."""


class Pair(Reply, frozen=True):
    """One gear with one motor."""

    rank: Annotated[int | None, Field(description="Place among the suitable pairs; null for others.")]
    designation: Annotated[str, Field(description="Designation of the gear.")]
    motor: Annotated[str, Field(description="Designation of the motor.")]
    status: Annotated[Status, Field(description="Verdict of all checks, as in `POST /api/v1/select` with this motor.")]
    utilisation: Annotated[
        float | None, Field(description="Largest utilisation of gear and motor; null where it is not a number.")
    ]
    governing_check: Annotated[
        str | None, Field(description="Check with that utilisation; `drive_resonance` for the least resonance.")
    ]
    motor_utilisation: Annotated[
        float | None, Field(description="Largest utilisation of the motor’s load checks; null where none is known.")
    ]
    thermal: Annotated[
        float | None, Field(description="RMS torque over the rated torque; null where the rated torque is not known.")
    ]
    inertia_ratio: Annotated[
        float | None, Field(description="(J_L / i² + J_g) / J_m; null where an inertia is not known.")
    ]
    drive_resonance_Hz: Annotated[
        float | None, Field(description="Resonance of load and motor against each other; null without inertias.")
    ]
    motor_torque_limit_Nm: Annotated[
        float | None, Field(description="Torque η T_R / i to set in the drive; null where T_R is not published.")
    ]
    weight_kg: Annotated[float | None, Field(description="Weight of gear and motor; null where a weight is not known.")]
    link: Annotated[
        str | None,
        Field(
            description="Page of the gear with this motor’s figures in the application; null where the address is too "
            "long."
        ),
    ]


class Pairs(Reply, frozen=True):
    """Pairs for one application, best first."""

    pairs: Annotated[list[Pair], Field(max_length=MOST_MOTORS, description="The first `top` pairs.")]
    failing: Annotated[dict[str, int], Field(description="Number of pairs that are not suitable, by governing check.")]
    notices: Annotated[tuple[Notice, ...], Field(description="Assumptions and remarks.")]


@dataclass(frozen=True, eq=False)
class PairTable:
    """Figures of M motors on G gears, each of shape (M, G); NaN if unknown.

    `verdict` are places in STATUS, `governing` in CODES.
    """

    gears: GearList
    motors: Sequence[MotorEntry]
    verdict: PlaceArray
    utilisation: FloatArray
    governing: PlaceArray
    of_motor: FloatArray
    thermal: FloatArray
    inertia_ratio: FloatArray
    resonance_Hz: FloatArray
    limit_Nm: FloatArray
    weight_kg: FloatArray
    of_gear: FloatArray
    peak: FloatArray

    @property
    def fails(self) -> BoolArray:
        """True for pairs that fail, by their places."""
        return np.array(self.verdict.ravel() == UNSUITABLE)

    def _sorted(self, wish: FloatArray, among: BoolArray) -> PlaceArray:
        """Places of some pairs by ascending wish, NaN last, then by weight, utilisation and names."""
        places = np.flatnonzero(among)
        rows, columns = np.unravel_index(places, self.verdict.shape)
        names = [_places_of([motor.designation for motor in self.motors])[rows]]
        names.append(_places_of([gear.designation for gear in self.gears.rows])[columns])
        keys = tied(np.array([wish[places], self.weight_kg.ravel()[places], self.utilisation.ravel()[places]]))
        order: PlaceArray = places[np.lexsort((*names, *keys[::-1]))]
        return order

    def ranked(self, rank_by: str) -> PlaceArray:
        """Suitable pairs, best first."""
        wishes = {
            "weight": self.weight_kg,
            "utilisation": self.utilisation,
            "inertia_ratio": self.inertia_ratio,
            "resonance": -self.resonance_Hz,
        }
        return self._sorted(wishes[rank_by].ravel(), self.verdict.ravel() == SUITABLE)

    def rejected(self) -> PlaceArray:
        """Pairs that fail, the nearest miss first, and those that are not rated."""
        fails = self._sorted(self.utilisation.ravel(), self.fails)
        unrated = self._sorted(np.zeros(self.verdict.size), self.verdict.ravel() == UNRATED)
        return np.concatenate((fails, unrated))

    def best_of_motors(self, order: PlaceArray) -> PlaceArray:
        """The first pair of each motor, in the same order."""
        return order[np.sort(np.unique(order // len(self.gears.rows), return_index=True)[1])]

    def failing(self) -> dict[str, int]:
        """Number of pairs that fail, by governing check, in the order of the checks."""
        counts = np.bincount(self.governing[self.verdict == UNSUITABLE], minlength=len(CODES))
        return {CODES[place]: int(counts[place]) for place in np.flatnonzero(counts).tolist()}


def _places_of(names: Sequence[str]) -> PlaceArray:
    """Places of names in their alphabetical order."""
    places = np.empty(len(names), np.intp)
    places[sorted(range(len(names)), key=names.__getitem__)] = np.arange(len(names))
    return places


def table_of(
    application: Application, motors: Sequence[MotorEntry], catalogue: Catalogue, least_Hz: float | None = None
) -> PairTable:
    """Figures of every motor on every allowed gear; raises InputError as `select` does."""
    if application.requirements.over_tolerance:
        place = ("requirements", "over_tolerance")
        raise InputError((place, Sentence(N_("pairs are judged as given: leave it out or say false"))))
    gears = gears_for(application, catalogue)
    parts = [
        _part(application, motors[start : start + AT_ONCE], gears, catalogue, least_Hz)
        for start in range(0, len(motors), AT_ONCE)
    ]
    return PairTable(gears, motors, *(np.concatenate(column) for column in zip(*parts, strict=True)))


def _part(
    application: Application,
    motors: Sequence[MotorEntry],
    gears: GearList,
    catalogue: Catalogue,
    least_Hz: float | None,
) -> tuple[Any, ...]:
    """Columns of a table for some of its motors, in the order of its fields."""
    evaluation = with_motors(application, motors, gears, catalogue)
    figures, shape = evaluation.case.figures, evaluation.verdict.shape
    codes = [check.code for check in evaluation.checks]
    own = [place for place, code in enumerate(codes) if code in LOADS]
    beside = [k for k, check in enumerate(evaluation.checks) if check.group == "load" and k not in own]
    thermal, peak = (
        evaluation.used[codes.index(code)] if code in codes else np.array(np.nan)
        for code in ("motor_rated_torque", "motor_peak_torque")
    )
    inertia = evaluation.case.inputs["requirements.motor.inertia_kgm2"]
    weights = np.array([[motor.weight_kg] for motor in motors], dtype=np.float64)
    resonance = np.broadcast_to(figures.drive_resonance_Hz, shape)
    governing = np.array([CODES.index(code) for code in codes])[evaluation.governing]
    judged = evaluation.verdict.astype(np.intp), evaluation.utilisation, governing
    if least_Hz is not None:
        judged = _with_resonance(*judged, least_Hz / resonance)
    of_motor = np.fmax.reduce(evaluation.used[own], axis=0) if own else np.array(np.nan)
    ratios = inertia_ratio(evaluation.case.duty, gears.columns, inertia)
    weights = weights + gears.columns.weight_kg
    of_gear = np.fmax.reduce(evaluation.used[beside], axis=0) if beside else np.array(np.nan)
    others = (of_motor, thermal, ratios, resonance, figures.motor_torque_limit_Nm, weights, of_gear, peak)
    return (*judged, *(np.array(np.broadcast_to(column, shape)) for column in others))


def _with_resonance(
    verdict: PlaceArray, utilisation: FloatArray, governing: PlaceArray, used: FloatArray
) -> tuple[PlaceArray, FloatArray, PlaceArray]:
    """Verdicts, utilisations and governing checks with the least resonance as a property check and the last of all."""
    fails, unknown = used > 1 + ROUNDING, np.isnan(used)
    leads = fails & ~(utilisation * (1 + ROUNDING) >= used)
    lacking = unknown & (verdict == SUITABLE)
    verdict = np.where(fails, UNSUITABLE, np.where(lacking, UNRATED, verdict))
    utilisation = np.where(leads, used, np.where(lacking, np.nan, utilisation))
    return verdict, utilisation, np.where(leads, len(CODES) - 1, governing)


# --- The reply --------------------------------------------------------------------------------------------------------


def pairs_of(
    question: Pairing,
    motors: Sequence[MotorEntry],
    catalogue: Catalogue,
    link_of: Callable[[Application, str], str | None],
    *,
    failing: bool = False,
) -> Pairs:
    """The first pairs of a request, suitable or failing; `link_of` takes application and gear."""
    table = table_of(question.application, motors, catalogue, question.drive_resonance_Hz)
    order = table.rejected() if failing else table.ranked(question.rank_by)
    if question.best_of == "motor":
        order = table.best_of_motors(order)
    return Pairs(
        pairs=list(pairs_at(table, order[: question.top].tolist(), question.application, link_of)),
        failing=table.failing(),
        notices=tuple(notices_on(question.application, motors, table.gears, catalogue, question.drive_resonance_Hz)),
    )


def pairs_at(
    table: PairTable, places: Sequence[int], application: Application, link_of: Callable[[Application, str], str | None]
) -> Iterator[Pair]:
    """Pairs at some places, in their order."""
    equipped: dict[int, Application] = {}
    for rank, place in enumerate(places, start=1):
        row, column = divmod(place, len(table.gears.rows))
        gear, motor, verdict = table.gears.rows[column], table.motors[row], table.verdict.item(row, column)
        if row not in equipped:
            equipped[row] = with_figures(application, motor)
        yield Pair(
            rank=rank if verdict == SUITABLE else None,
            designation=gear.designation,
            motor=motor.designation,
            status=STATUS[verdict],
            utilisation=finite(table.utilisation.item(place)),
            governing_check=None if verdict == UNRATED else CODES[table.governing.item(row, column)],
            motor_utilisation=finite(table.of_motor.item(place)),
            thermal=finite(table.thermal.item(place)),
            inertia_ratio=finite(table.inertia_ratio.item(place)),
            drive_resonance_Hz=finite(table.resonance_Hz.item(place)),
            motor_torque_limit_Nm=finite(table.limit_Nm.item(place)),
            weight_kg=finite(table.weight_kg.item(place)),
            link=link_of(equipped[row], gear.designation),
        )
