"""Worst cases over tolerances: nothing inside a box is worse than the corner, and the corner is attained.

A search by a rule of its own looks for something worse: points at random, each coordinate alone up and down from the
best of them, and again from other points. Its points are ordinary applications; the engine's corners are rows.
"""

import random
from contextlib import suppress
from dataclasses import replace

import numpy as np
import pytest
from pydantic import ValidationError

from hpn.application import Application, InputError
from hpn.catalogue import Catalogue
from hpn.engine import corners
from hpn.engine.box import Box, duty_of
from hpn.engine.check import Check, Dependence
from hpn.engine.checks import CHECKS
from hpn.engine.corners import Need
from hpn.engine.duty import Duty
from hpn.engine.evaluation import evaluate
from hpn.engine.members import members_of
from hpn.engine.selection import judge
from hpn.engine.tolerance import worst_cases
from tests.build import LIFTING, TURNING, Json
from tests.property.boxes import box_at_random, ends_of, point

ABOVE = 1e-9
"""Room of a point above the corner: sums of the phases in another order, powers 10/3 and -0.3 of them, and integrals
along a motion, which err by 1e-10 of themselves; a corner that is wrong differs by a share of the tolerance."""

RESTARTS, AT_RANDOM, ROUNDS = 3, 24, 2
"""Starts of the search in each box, points at random at each, and times that all coordinates are moved."""


def search(
    document: Json, application: Application, catalogue: Catalogue, chance: random.Random
) -> tuple[float, set[str]]:
    """The largest excess over a proved worst case, and the checks that had one."""
    base = judge(application, catalogue).evaluation
    (result,) = worst_cases([members_of(application, catalogue)], base.checks, base.gears, catalogue)
    ends, codes = ends_of(document), [check.code for check in base.checks]
    count, excess = len(ends), 0.0

    def used(points: list[list[float]]) -> np.ndarray:
        nonlocal excess
        applications = [Application.model_validate(point(document, ends, shares)) for shares in points]
        judged = evaluate(Duty.of(applications), base.gears, catalogue)
        assert [check.code for check in judged.checks] == codes
        with np.errstate(all="ignore"):
            over = np.where(
                result.exact[:, None] & np.isfinite(result.used[:, None]), judged.used / result.used[:, None], 0
            )
            zero = result.exact[:, None] & (result.used[:, None] == 0) & (judged.used > 0)
        excess = max(excess, float(np.nanmax(over)) - 1, float(zero.any()))
        return judged.used

    for _ in range(RESTARTS):
        place = chance.randrange(len(codes)), chance.randrange(len(base.gears.rows))
        points = [[chance.choice((0.0, 1.0, chance.random())) for _ in range(count)] for _ in range(AT_RANDOM)]
        for _ in range(ROUNDS):
            best = points[int(np.nan_to_num(used(points)[place[0], :, place[1]], nan=-1).argmax())]
            points = [[*best[:k], share, *best[k + 1 :]] for k in range(count) for share in (0.0, 1.0, chance.random())]
            points.append(best)
        used(points)
    judged = {code for code, exact in zip(codes, result.exact, strict=True) if exact.all()}
    return excess, judged


def attained(application: Application, catalogue: Catalogue) -> float:
    """The largest difference between a worst case and its corner as an ordinary application, over all checks."""
    base = judge(application, catalogue).evaluation
    (result,) = worst_cases([members_of(application, catalogue)], base.checks, base.gears, catalogue)
    largest = 0.0
    for number, check in enumerate(base.checks):
        gear = int(np.nan_to_num(result.used[number], nan=-1, posinf=-1).argmax())
        if np.isfinite(worst := result.used[number, gear]):
            box, corner = result.points[result.at[number, gear]]
            alone = judge(box.application_at(corner), catalogue).evaluation
            value = alone.used[[one.code for one in alone.checks].index(check.code), 0, gear]
            largest = max(largest, abs(value - worst) / max(abs(worst), 1e-300))
    return largest


MOTIONS: tuple[Json, ...] = (
    {"duty_cycle": {"motion": TURNING, "pause_s": 0.5}},
    {"duty_cycle": {"motion": LIFTING, "pause_s": 0.5}},
)


def test_no_point_of_a_box_is_worse_than_its_corner(catalogue: Catalogue, soak: bool) -> None:
    chance, seen = random.Random(52), set()
    for number in range(1000 if soak else 30):
        moved = number % 10 == 9
        document = box_at_random(chance, chance.choice(MOTIONS) if moved else None)
        try:
            application = Application.model_validate(document)
        except ValidationError:
            continue  # no rest to judge the error at, or a peak that its own torque may exceed
        if not ends_of(document):
            continue
        try:
            excess, judged = search(document, application, catalogue, chance)
        except InputError:
            continue  # a corner of a motion that is none: less inertia than its mass off the shaft has
        assert excess <= ABOVE, (number, document)
        seen |= judged
        assert attained(application, catalogue) <= ABOVE, (number, document)
    assert seen >= {check.code for check in CHECKS}


VARYING: tuple[Json, ...] = (
    MOTIONS[0]
    | {
        "requirements": {"motor": {"inertia_kgm2": 5e-4, "peak_torque_Nm": 40, "rated_torque_Nm": 15}},
        "tolerances": {
            "motion.moves.0.time_s": {"percent": 5},
            "motion.moves.2.angle_deg": {"percent": 2},
            "pause_s": {"percent": 10},
            "requirements.efficiency": {"minus": {"percent": 5}},
        },
    },
    MOTIONS[1]
    | {
        "output_load": {"radial_N": 300, "axial_N": 100, "load_coefficient": 1.2},
        "tolerances": {
            "motion.moves.0.distance_mm": {"percent": 5},
            "motion.mechanism.mass_kg": {"percent": 10},
            "output_load.radial_N": {"percent": 30},
        },
    },
)
"""Motions whose times or ways vary, so that they are sampled."""


@pytest.mark.parametrize("document", VARYING, ids=["turning", "lifting"])
def test_samples_that_are_judged_together_are_those_judged_one_by_one(document: Json, catalogue: Catalogue) -> None:
    """Two ways: rows of one duty, their motions changed at once; and each an application as one would type it."""
    body = {"efficiency": 0.95, **document.get("requirements", {}), "sizes": ["20A", "32A"]}
    application = Application.model_validate(document | {"requirements": body})
    base = judge(application, catalogue).evaluation
    members = members_of(application, catalogue)
    (result,) = worst_cases([members], base.checks, base.gears, catalogue, samples=512)
    parts = [(box, points[:8]) for box, points in members.sampled(512)]

    seen = [box.application_at(point) for box, points in parts for point in points]
    assert len(seen) > 32 and any(one.duty_cycle.motion != application.duty_cycle.motion for one in seen)
    together = evaluate(duty_of(parts), base.gears, catalogue).used
    alone = [
        evaluate(Duty.of([Application.model_validate(one.model_dump(exclude_unset=True))]), base.gears, catalogue)
        for one in seen
    ]
    for row, judged in enumerate(alone):
        assert np.allclose(together[:, row], judged.used[:, 0], rtol=1e-12, atol=0, equal_nan=True)
        open_ = ~result.exact.all(axis=1)
        assert (judged.used[open_, 0] <= result.used[open_] * (1 + 1e-12)).all()


WRONG: dict[str, dict[str, Dependence]] = {
    "average_torque": {"speed_rpm": "rising"},
    "output_bearing_life": {"duration_s": "rising"},
}
"""Declarations that no proof gives: a share rises with some of its weights and falls with the others."""


@pytest.mark.parametrize("code", WRONG)
def test_the_search_finds_a_declaration_that_is_wrong(
    code: str, catalogue: Catalogue, monkeypatch: pytest.MonkeyPatch
) -> None:
    declared = corners.need_of

    def need(box: Box, check: Check) -> Need:
        wrong = replace(check, over={**(check.over or {}), **WRONG[code]}) if check.code == code else check
        return declared(box, wrong)

    monkeypatch.setattr(corners, "need_of", need)
    chance, largest = random.Random(3), 0.0
    for _ in range(12):
        document = box_at_random(chance)
        with suppress(ValidationError):
            application = Application.model_validate(document)
            largest = max(largest, search(document, application, catalogue, chance)[0])
    assert largest > 1000 * ABOVE
