"""Fewest kinds of gears for the axes of a machine: mass and changed axes for each smaller number of kinds."""

from collections.abc import Sequence
from typing import Annotated, NamedTuple

import numpy as np
from pydantic import Field

from hpn.application import Application, InputError
from hpn.catalogue import Catalogue
from hpn.engine.batch import judge_batch
from hpn.engine.evaluation import SUITABLE, BoolArray
from hpn.engine.kinds import NO_GEAR, GearChoices, LightestSet, fewest_kinds
from hpn.engine.selection import Judgement
from hpn.physics.equations import FloatArray
from hpn.words.reply import Reply


class Sought(NamedTuple):
    """Axis that takes part: its number, quantity, application, and the designation of its present gear."""

    number: int
    quantity: int
    application: Application
    designation: str | None


class GearChange(Reply, frozen=True, rename={"gear_from": "from", "gear_to": "to"}):
    """One axis that changes its gear."""

    axis: Annotated[int, Field(description="Number of the axis.")]
    gear_from: Annotated[str | None, Field(description="Designation of the present gear; null for none.")]
    gear_to: Annotated[str, Field(description="Designation of the new gear.")]
    weight_kg: Annotated[
        float | None, Field(description="Increase in the mass of its gears; null where a mass is not known.")
    ]
    utilisation: Annotated[float, Field(description="Utilisation of the new gear.")]


class KindsStep(Reply, frozen=True):
    """The lightest set with a number of kinds."""

    count: Annotated[int, Field(description="Number of kinds.")]
    gears: Annotated[tuple[str, ...], Field(description="Designations of the gears, in the order of the catalogue.")]
    weight_kg: Annotated[float, Field(description="Mass of the gears of every axis, times its quantity.")]
    proven: Annotated[
        bool,
        Field(
            description="True: no lighter set with this number of kinds exists. False: the best one found within a "
            "second."
        ),
    ]
    changes: Annotated[tuple[GearChange, ...], Field(description="Axes that change their gear.")]


class Forced(Reply, frozen=True):
    """A gear that every set needs."""

    gear: Annotated[str, Field(description="Designation.")]
    axes: Annotated[tuple[int, ...], Field(description="Numbers of the axes that only this gear suits.")]


class MachineKinds(Reply, frozen=True):
    """Fewest kinds of gears of a machine, without axes that no gear suits."""

    kinds: Annotated[tuple[KindsStep, ...], Field(description="Steps, from the machine’s own number of kinds down.")]
    least: Annotated[int, Field(description="Smallest number of kinds that serves every axis.")]
    forced: Annotated[tuple[Forced, ...], Field(description="Gears that an axis needs.")]


def kinds_of(sought: Sequence[Sought], catalogue: Catalogue, *, most: int | None = None) -> MachineKinds:
    """Lightest sets for each number of kinds, from the present number down to the least, at most `most` kinds."""
    names = [gear.designation for gear in catalogue.gears]
    place = {name: index for index, name in enumerate(names)}
    suits, used = _suitability([axis.application for axis in sought], catalogue)
    axes = GearChoices(
        suits,
        used,
        np.array([np.nan if gear.weight_kg is None else gear.weight_kg for gear in catalogue.gears]),
        np.array([axis.quantity for axis in sought], np.int64),
        np.array([place.get(axis.designation or "", NO_GEAR) for axis in sought], np.intp),
    )
    kinds = fewest_kinds(axes, most=most)
    numbers = [axis.number for axis in sought]
    return MachineKinds(
        tuple(_step(step, axes, names, numbers) for step in kinds.steps),
        kinds.least,
        tuple(Forced(names[gear], tuple(numbers[axis] for axis in only)) for gear, only in kinds.forced.items()),
    )


def _suitability(applications: Sequence[Application], catalogue: Catalogue) -> tuple[BoolArray, FloatArray]:
    """True for the suitable gears of each application, and their utilisation, NaN for no candidate; both shape
    (A, G)."""
    place = {gear.designation: index for index, gear in enumerate(catalogue.gears)}

    def row(judged: Judgement) -> tuple[list[int], BoolArray, FloatArray]:
        evaluation, index = judged.evaluation, judged.index
        columns = [place[gear.designation] for gear in evaluation.gears.rows]
        return columns, evaluation.verdict[index] == SUITABLE, evaluation.utilisation[index].copy()

    suits = np.zeros((len(applications), len(catalogue.gears)), np.bool_)
    used = np.full(suits.shape, np.nan)
    for axis, answer in enumerate(judge_batch(applications, catalogue, row)):
        if not isinstance(answer, InputError):
            columns, suitable, utilisation = answer
            suits[axis, columns], used[axis, columns] = suitable, utilisation
    return suits, used


def _step(step: LightestSet, axes: GearChoices, names: Sequence[str], numbers: Sequence[int]) -> KindsStep:
    changed = np.flatnonzero((step.gear_of != axes.present) & (step.gear_of != NO_GEAR))
    return KindsStep(
        count=len(step.gears),
        gears=tuple(names[gear] for gear in step.gears),
        weight_kg=step.weight_kg,
        proven=step.is_proven,
        changes=tuple(_change(axes, axis, int(step.gear_of[axis]), names, numbers[axis]) for axis in changed.tolist()),
    )


def _change(axes: GearChoices, axis: int, to: int, names: Sequence[str], number: int) -> GearChange:
    before = int(axes.present[axis])
    gained = float((axes.weight_kg[to] - axes.weight_kg[before]) * axes.quantity[axis])
    known = before != NO_GEAR and bool(np.isfinite(gained))
    return GearChange(
        axis=number,
        gear_from=None if before == NO_GEAR else names[before],
        gear_to=names[to],
        weight_kg=gained if known else None,
        utilisation=float(axes.utilisation[axis, to]),
    )
