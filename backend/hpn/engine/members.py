"""Applications that stand for the tolerances of a motion, each the box of the tolerances that are left.

A motion with fixed times and speeds is taken at all ends of its inputs. With too many of them, or where times, ways or
angles vary, it is sampled.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product

import numpy as np
from pydantic import ValidationError

from hpn.application import Application, InputError
from hpn.application.tolerances import LOADS, Interval, Place
from hpn.catalogue import Catalogue
from hpn.engine.allowed import with_listed_motor
from hpn.engine.box import Box, moved
from hpn.engine.check import Check
from hpn.engine.duty import Duty
from hpn.physics.equations import FloatArray
from hpn.words.wording import N_, Sentence

CONVEX = (
    "inertia_kgm2",
    "mass_kg",
    "gravity_mass_kg",
    "gravity_radius_mm",
    "counterweight_kg",
    "friction_torque_Nm",
    "friction_force_N",
    "friction_coefficient",
    "viscous_friction_Nm_per_rpm",
    "efficiency",
    "ratio",
    "external_torque_Nm",
    "external_force_N",
)
"""Inputs of a motion that leave its times and speeds, but for the ratio's factor: its torques are convex in each."""

MOST_CONVEX = 6
"""Such inputs of which all ends are taken together."""

SAMPLES = 4096
MOST_CELLS = 4_000_000
"""Points that are looked at where nothing is proved, and their phases together, at most."""

SAMPLED_PHASES = 4096
LEAST_SAMPLES, MOST_SAMPLES = 8, 256
"""Phases of the motions that are sampled together, and how many motions that may be."""

SEED = 52
NO_MOTION = N_("leaves no application at one end: {reason}")


@dataclass(frozen=True, eq=False)
class Members:
    """An application as boxes, one for each corner of its motion's tolerances."""

    application: Application
    catalogue: Catalogue
    boxes: list[Box]
    moving: tuple[Interval, ...]

    @cached_property
    def is_fixed(self) -> bool:
        """True where the boxes are all corners, and times and speeds of the motion don't vary."""
        phases = len(self.application.duty_cycle.load_phases) << len(self.moving)
        few = len(self.moving) <= MOST_CONVEX and phases <= SAMPLED_PHASES
        return few and all(one.place[-1] in CONVEX for one in self.moving)

    def moves(self, check: Check) -> bool:
        """True where the motion's tolerances may move a check."""
        return bool(self.moving) and (check.over is None or "motion" in check.over)

    def proves(self, check: Check) -> bool:
        """True where a check has its worst case at a corner of the motion's tolerances."""
        if not self.moves(check):
            return True
        over = check.over or {}
        motion = self.application.duty_cycle.motion
        hangs = bool(getattr(motion and motion.mechanism, "counterweight_kg", 0.0))
        return over.get("motion") == "ends" and self.is_fixed and not (hangs and "counterweight" in over)

    def sampled(self, count: int) -> Iterator[tuple[Box, FloatArray]]:
        """Points where nothing is proved: the ends of each interval alone, and points at random, always the same."""
        for box in self.boxes:
            yield box, np.concatenate((_ends_alone(box), _at_random(box, count)))
        if self.moving:
            for values in self._motions_alone():
                box = self._box(values)
                yield box, box.value[None]
            yield from self._motions_at_random(count // 16)

    def spread(self, count: int) -> Iterator[tuple[Box, FloatArray]]:
        """Points evenly spread over the tolerances, as many as asked for where that doesn't take too long."""
        if self.moving:
            yield from self._motions_at_random(count)
        else:
            yield self.boxes[0], _at_random(self.boxes[0], count)

    def _motions_alone(self) -> list[dict[Place, float]]:
        return [{one.place: end} for one in self.moving for end in (one.low, one.high)][: self._most_motions]

    @property
    def _most_motions(self) -> int:
        count = len(self.application.duty_cycle.load_phases)
        return int(np.clip(SAMPLED_PHASES // count, LEAST_SAMPLES, MOST_SAMPLES))

    def _motions_at_random(self, count: int) -> Iterator[tuple[Box, FloatArray]]:
        random = np.random.default_rng(SEED)
        for _ in range(min(count, self._most_motions)):
            shares = random.random(len(self.moving)).tolist()
            values = {
                one.place: one.low + share * (one.high - one.low)
                for one, share in zip(self.moving, shares, strict=True)
            }
            box = self._box(values)
            yield box, box.low + random.random((1, len(box.value))) * (box.high - box.low)

    def _box(self, values: Mapping[Place, float]) -> Box:
        return _box(self.application, values, self.boxes[0].intervals, self.catalogue, self.moving)


def _ends_alone(box: Box) -> FloatArray:
    d = len(box.intervals)
    alone = np.repeat(box.value[None], min(2 * d, _most_points(box)), axis=0)
    places = np.arange(len(alone))
    alone[places, places // 2] = np.where(places % 2, box.high[places // 2], box.low[places // 2])
    return alone


def _at_random(box: Box, count: int) -> FloatArray:
    d = len(box.intervals)
    shares = np.random.default_rng(SEED).random((min(count, _most_points(box)) if d else 1, d))
    points: FloatArray = box.low + shares * (box.high - box.low)
    return points


def _most_points(box: Box) -> int:
    return int(max(MOST_CELLS // max(box.duty.typed.torque_Nm.shape[-1], len(box.intervals), 1), LEAST_SAMPLES))


def moving_of(intervals: Sequence[Interval]) -> tuple[Interval, ...]:
    """Those intervals that change the course of a motion."""
    return tuple(one for one in intervals if one.place[0] == "motion" and one.place[-1] not in LOADS)


def members_of(application: Application, catalogue: Catalogue, intervals: Sequence[Interval] | None = None) -> Members:
    """Boxes of an application with its intervals, or with others; InputError where a corner is no application."""
    every = application.intervals if intervals is None else tuple(intervals)
    moving = moving_of(every)
    left = tuple(one for one in every if one not in moving)
    members = Members(application, catalogue, [], moving)
    corners: Sequence[Mapping[Place, float]] = [{}]
    if moving and members.is_fixed:
        ends = product(*((one.low, one.high) for one in moving))
        corners = [dict(zip((one.place for one in moving), end, strict=True)) for end in ends]
    members.boxes.extend(_box(application, corner, left, catalogue, moving) for corner in corners)
    return members


def _box(
    application: Application,
    values: Mapping[Place, float],
    left: tuple[Interval, ...],
    catalogue: Catalogue,
    moving: Sequence[Interval],
) -> Box:
    try:
        changed = moved(application, values) if values else application
    except ValidationError as error:
        reason = error.errors(include_url=False, include_input=False)[0]["msg"]
        path = moving[0].path
        raise InputError((("tolerances", path), Sentence(NO_MOTION, {"reason": reason}))) from None
    return Box(changed, Duty.of([with_listed_motor(changed, catalogue)]), left)
