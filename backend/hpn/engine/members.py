"""Applications in place of the tolerances of a motion, each with a box of the other tolerances.

A motion with fixed times and speeds is evaluated at all ends of its inputs. With too many of them, or where times, ways
or angles vary, it is sampled.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from itertools import product

import numpy as np
from pydantic import ValidationError

from hpn.application import Application, InputError
from hpn.application.faults import sentence_of
from hpn.application.motion import Motion
from hpn.application.tolerances import LOADS, Interval, Place
from hpn.catalogue import Catalogue
from hpn.engine.allowed import with_listed_motor
from hpn.engine.box import Box, moved
from hpn.engine.check import Check
from hpn.engine.duty import Duty
from hpn.physics.equations import FloatArray
from hpn.words.motion import MOTION
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
"""Inputs of a motion without effect on its times and speeds, apart from the ratio's factor: torques are convex
in each.
"""

MOST_CONVEX = 6
"""Such inputs, at most, whose ends are all combined."""

SAMPLES = 4096
MOST_CELLS = 4_000_000
"""Points evaluated where nothing is proved, and at most so many phases in them together."""

SAMPLED_PHASES = 4096
LEAST_SAMPLES, MOST_SAMPLES = 8, 256
"""Phases of all sampled motions together, and the least and the largest number of these motions."""

ROWS_AT_ONCE = 512

RECENT = 4
"""Applications whose boxes and sampled motions are cached: a page needs them several times."""

SEED = 52
NO_MOTION = N_("leaves no application at one end: {reason}")
NO_INPUT_OF_MOTION = N_("leaves no application at one end: {input} {reason}")

Part = tuple[Box, FloatArray]
"""A box and some of its points."""


@dataclass(frozen=True, eq=False)
class Members:
    """An application as boxes, one for each corner of its motion's tolerances.

    Members with fewer intervals than those they are `like` use the same random points for the remaining ones: the two
    differ only in the inputs that are exact.
    """

    application: Application
    catalogue: Catalogue
    left: tuple[Interval, ...]
    moving: tuple[Interval, ...]
    like: "Members | None" = None
    _drawn: dict[int, list[Box]] = field(default_factory=dict)

    @cached_property
    def is_fixed(self) -> bool:
        """True where the boxes are all corners, and the motion's times and speeds don't vary."""
        phases = len(self.application.duty_cycle.load_phases) << len(self.moving)
        few = len(self.moving) <= MOST_CONVEX and phases <= SAMPLED_PHASES
        return few and all(one.place[-1] in CONVEX for one in self.moving)

    @cached_property
    def boxes(self) -> list[Box]:
        """A box for each corner of the motion's tolerances, else one box; raises InputError for an invalid corner."""
        if not (self.moving and self.is_fixed):
            return [self._box(self.application)]
        places = [one.place for one in self.moving]
        corners = product(*((one.low, one.high) for one in self.moving))
        return self._boxes_at([dict(zip(places, corner, strict=True)) for corner in corners])

    def moves(self, check: Check) -> bool:
        """True where the motion's tolerances may influence a check."""
        return bool(self.moving) and (check.over is None or "motion" in check.over)

    def proves(self, check: Check) -> bool:
        """True where a check has its worst case at a corner of the motion's tolerances."""
        if not self.moves(check):
            return True
        over = check.over or {}
        motion = self.application.duty_cycle.motion
        hangs = bool(getattr(motion and motion.mechanism, "counterweight_kg", 0.0))
        return over.get("motion") == "ends" and self.is_fixed and not (hangs and "counterweight" in over)

    def sampled(self, count: int) -> list[Part]:
        """Points for checks without proof: the ends of each interval alone, and random points, always the same."""
        parts = [(box, np.concatenate((_ends_alone(box), self._at_random(box, count)))) for box in self.boxes]
        if self.moving:
            parts += [(box, box.value[None]) for box in self.ends_alone]
            parts += self._motions_at_random(count // 16)
        return parts

    @cached_property
    def ends_alone(self) -> list[Box]:
        """A box for each tolerance of the motion at its lower and at its upper end alone; of the first if too many."""
        alone = [{one.place: end} for one in self.moving for end in (one.low, one.high)]
        return self._boxes_at(alone[: self._most_motions])

    def boxes_beside(self, corners: Sequence[FloatArray]) -> list[Box | None]:
        """A box for each of some values of the motion's tolerances; None where they leave no application."""
        places = [one.place for one in self.moving]
        named = [dict(zip(places, corner.tolist(), strict=True)) for corner in corners]
        try:
            return [*self._boxes_at(named)]
        except InputError:
            return [self._box_at(one) for one in named]

    def _box_at(self, corner: Mapping[Place, float]) -> Box | None:
        try:
            return self._boxes_at([corner])[0]
        except InputError:
            return None

    def spread(self, count: int) -> list[Part]:
        """Points evenly spread over the tolerances, up to `count`, fewer where that would take too long."""
        if self.moving:
            return self._motions_at_random(count)
        return [(self.boxes[0], self._at_random(self.boxes[0], count))]

    def _at_random(self, box: Box, count: int) -> FloatArray:
        every = (self.like or self).left
        shares = np.random.default_rng(SEED).random((min(count, _most_points(box)) if self.left else 1, len(every)))
        points: FloatArray = box.low + shares[:, _places(self.left, every)] * (box.high - box.low)
        return points

    @property
    def _most_motions(self) -> int:
        count = len(self.application.duty_cycle.load_phases)
        return int(np.clip(SAMPLED_PHASES // count, LEAST_SAMPLES, MOST_SAMPLES))

    def _motions_at_random(self, most: int) -> list[Part]:
        count, like = min(most, self._most_motions), self.like or self
        every = (*like.moving, *like.left)
        shares = np.random.default_rng(SEED).random((count, len(every)))
        of_left = shares[:, None, _places(self.left, every)]
        boxes = self._boxes_at_random(count, shares[:, _places(self.moving, every)])
        return [(box, box.low + own * (box.high - box.low)) for box, own in zip(boxes, of_left, strict=True)]

    def _boxes_at_random(self, count: int, shares: FloatArray) -> list[Box]:
        if self.like is not None and self.like.moving == self.moving:  # the same motions, and fewer other inputs
            return [replace(box, intervals=self.left) for box in self.like._boxes_at_random(count, shares)]
        if count not in self._drawn:
            low, high = np.array([(one.low, one.high) for one in self.moving]).T
            places = [one.place for one in self.moving]
            points = (low + shares * (high - low)).tolist()
            self._drawn[count] = self._boxes_at([dict(zip(places, point, strict=True)) for point in points])
        return self._drawn[count]

    def _boxes_at(self, corners: Sequence[Mapping[Place, float]]) -> list[Box]:
        """A box of the other intervals at each of some corners of the motion; raises InputError for an invalid
        corner.
        """
        own_values, motion = moved(self.application, {}), self.application.duty_cycle.motion
        assert motion is not None
        try:
            motions = motion.changed([{place[1:]: value for place, value in corner.items()} for corner in corners])
            changed = [_with_motion(own_values, motion) for motion in motions]
        except ValidationError as error:
            raise InputError((("tolerances", self.moving[0].path), _no_motion(error))) from None
        return [self._box(one) for one in changed]

    def _box(self, application: Application) -> Box:
        return Box(application, Duty.of([with_listed_motor(application, self.catalogue)]), self.left)


def _no_motion(error: ValidationError) -> Sentence:
    """Sentence on an invalid corner: the input of its first error, and the valid values."""
    first = error.errors(include_url=False, include_input=False)[0]
    field = ("", *first["loc"])[-1]
    named = MOTION.get(f"move.{field}") or MOTION.get(f"mechanism.{field}")
    if named is None:
        return Sentence(NO_MOTION, {"reason": sentence_of(first)})
    return Sentence(NO_INPUT_OF_MOTION, {"input": named.name, "reason": sentence_of(first)}, ("input",))


def _with_motion(application: Application, motion: Motion) -> Application:
    """The application with another motion, validated again as a whole."""
    cycle = application.duty_cycle
    parts = {name: getattr(application, name) for name in application.model_fields_set}
    others = {name: getattr(cycle, name) for name in cycle.model_fields_set}
    return type(application).model_validate(parts | {"duty_cycle": others | {"motion": motion}})


def _ends_alone(box: Box) -> FloatArray:
    d = len(box.intervals)
    alone = np.repeat(box.value[None], min(2 * d, _most_points(box)), axis=0)
    places = np.arange(len(alone))
    alone[places, places // 2] = np.where(places % 2, box.high[places // 2], box.low[places // 2])
    return alone


def _places(some: Sequence[Interval], every: Sequence[Interval]) -> list[int]:
    """Places of some intervals among all, matched by the numbers they belong to."""
    places = {one.place: k for k, one in enumerate(every)}
    return [places[one.place] for one in some]


def _most_points(box: Box) -> int:
    return int(max(MOST_CELLS // max(box.duty.typed.torque_Nm.shape[-1], len(box.intervals), 1), LEAST_SAMPLES))


def chunks_of(parts: Sequence[Part]) -> Iterator[list[Part]]:
    """Yield points in chunks of rows, combining boxes with few points."""
    chunk: list[Part] = []
    rows = 0
    for box, points in parts:
        for start in range(0, len(points), ROWS_AT_ONCE):
            some = points[start : start + ROWS_AT_ONCE]
            if chunk and rows + len(some) > ROWS_AT_ONCE:
                yield chunk
                chunk, rows = [], 0
            chunk.append((box, some))
            rows += len(some)
    if chunk:
        yield chunk


def moving_of(intervals: Sequence[Interval]) -> tuple[Interval, ...]:
    """Intervals that change the course of a motion."""
    return tuple(one for one in intervals if one.place[0] == "motion" and one.place[-1] not in LOADS)


def members_of(
    application: Application,
    catalogue: Catalogue,
    intervals: Sequence[Interval] | None = None,
    like: Members | None = None,
) -> Members:
    """Boxes of an application with its own intervals, or with others, at the points of the members they are `like`."""
    if intervals is None:
        return _cached(_Same(application), catalogue)
    moving = moving_of(intervals)
    return Members(application, catalogue, tuple(one for one in intervals if one not in moving), moving, like)


class _Same:
    """An application as a key, compared by identity."""

    def __init__(self, application: Application) -> None:
        self.application = application

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Same) and other.application is self.application

    def __hash__(self) -> int:
        return id(self.application)


@lru_cache(maxsize=RECENT)
def _cached(same: _Same, catalogue: Catalogue) -> Members:
    """Boxes of an application with its own intervals, cached for verdict, table, deciding inputs and files."""
    return members_of(same.application, catalogue, same.application.intervals)
