"""A gear over the tolerances as pages and files tell it: corners, deciding inputs, and how far each may lie."""

import pytest

from hpn.account.account import Account
from hpn.account.inputs import lines_of
from hpn.account.over_tolerance import OverTolerance, over_tolerance
from hpn.application import Application, InputError
from hpn.application.tolerances import Tolerance
from hpn.catalogue import Catalogue
from hpn.engine.allowed import with_listed_motor
from hpn.engine.duty import Duty
from hpn.engine.evaluation import evaluate
from hpn.engine.room import allowed_of, scaled, with_tolerance
from hpn.engine.selection import judge
from hpn.words.reader import Reader
from tests.build import TURNING, Json, cycle, phase

DISC: Json = cycle(
    phase(95.1, 110, duration_s=0.3),
    phase(45.8, 220, duration_s=1.0),
    phase(-79.2, 110, duration_s=0.3),
    output_load={"radial_N": 790, "axial_N": 140, "load_coefficient": 1.2},
    emergency_stop={"torque_Nm": 130},
    requirements={"utilisation": 0.9},
)
DISC["duty_cycle"]["pause_s"] = 0.4
"""Magazine disc of a packing line: average torque decides."""

TOLERANCES: Json = {
    "torque_Nm": {"percent": 20},
    "speed_rpm": {"percent": 2},
    "duration_s": {"minus": {"percent": 3}, "plus": {"percent": 5}},
    "phases.1.torque_Nm": {"absolute": 0.5},
    "pause_s": {"percent": 10},
    "output_load.radial_N": {"percent": 10},
    "emergency_stop.torque_Nm": {"percent": 40},
}
WIDE = Application.model_validate(DISC | {"tolerances": TOLERANCES})
HELD = Application.model_validate(DISC | {"tolerances": TOLERANCES | {"torque_Nm": {"percent": 6}}})
MOVED = Application.model_validate(
    {
        "duty_cycle": {"motion": TURNING, "pause_s": 1.0},
        "tolerances": {
            "motion.mechanism.inertia_kgm2": {"percent": 5},
            "motion.mechanism.friction_torque_Nm": {"percent": 20},
        },
    }
)


def account(application: Application, catalogue: Catalogue) -> OverTolerance:
    selection = judge(application, catalogue).selection()
    found = over_tolerance(Account(selection, selection.candidates[0], application, catalogue))
    assert found is not None
    return found


@pytest.mark.parametrize("application", [WIDE, HELD, MOVED])
def test_every_corner_that_opens_has_the_worst_case_of_its_check(
    application: Application, catalogue: Catalogue
) -> None:
    """The corner is an ordinary application, judged by itself: the same figure but for rounding."""
    over = account(application, catalogue)
    gear = catalogue.by_designation[over.account.candidate.designation]

    for line in over.checks:
        assert line.corner is not None
        case = line.corner.application
        assert not case.tolerances
        evaluation = evaluate(Duty.of([with_listed_motor(case, catalogue)]), catalogue.listed([gear]), catalogue)
        place = next(k for k, check in enumerate(evaluation.checks) if check.code == line.check.code)
        assert evaluation.used.item(place, 0, 0) == pytest.approx(line.worst, rel=1e-12)
        nominal = line.check.result.utilisation
        assert line.worst is not None and nominal is not None and line.worst >= nominal * (1 - 1e-12)


def test_the_case_names_what_lies_high_and_low(catalogue: Catalogue) -> None:
    lines = {line.check.code: line for line in account(HELD, catalogue).checks}

    assert lines["repeated_peak_torque"].high == ("T_1", "T_2", "T_3") or lines["repeated_peak_torque"].high == ("T",)
    assert lines["momentary_peak_torque"].high == ("T_k",)
    assert lines["average_input_speed"].low == ("t_1", "t_3", "t_p")
    assert lines["average_torque"].high == ("T", "n_1", "n_3", "t_1", "t_3")
    assert lines["average_torque"].low == ("n_2", "t_2")


def holds(application: Application, gear: str, catalogue: Catalogue) -> bool:
    """Verdict on one gear over the tolerances, by the evaluation of all gears."""
    selection = judge(application, catalogue).selection(with_room=False)
    worst = next(one for one in selection.candidates if one.designation == gear).worst
    return getattr(worst, "status", "") == "suitable"


def by_bisection(application: Application, path: str, gear: str, catalogue: Catalogue) -> float:
    """Largest factor of a tolerance with which a gear holds; the other way than the engine's, which solves."""
    low, high = 0.0, 8.0
    for _ in range(30):
        middle = (low + high) / 2
        given = (application.tolerances or {})[path]
        sides = {
            name: {kind: value * middle for kind, value in side if value is not None}
            for name, side in zip(("minus", "plus"), given.sides, strict=True)
            if side
        }
        changed = {**(application.tolerances or {}), path: Tolerance.model_validate(sides)}
        try:
            asked = Application.model_validate(
                application.model_dump(exclude_unset=True)
                | {"tolerances": {k: v.model_dump(exclude_none=True) for k, v in changed.items()}}
            )
        except ValueError:  # beyond a bound of the field
            high = middle
            continue
        try:
            low, high = (middle, high) if holds(asked, gear, catalogue) else (low, middle)
        except InputError:  # a corner that is no motion
            high = middle
    return low


@pytest.mark.parametrize(
    ("application", "path"),
    [
        (WIDE, "torque_Nm"),
        (HELD, "torque_Nm"),
        (HELD, "duration_s"),
        (HELD, "phases.1.torque_Nm"),
        (MOVED, "motion.mechanism.inertia_kgm2"),
    ],
)
def test_the_largest_tolerance_that_holds_is_that_of_bisection(
    application: Application, path: str, catalogue: Catalogue
) -> None:
    """2 ways: the engine solves for the excess over the limit, the test bisects over the verdict on all gears."""
    gear = judge(application, catalogue).selection(with_room=False).candidates[0].designation
    allowed = allowed_of(application, catalogue.by_designation[gear], catalogue, path)
    found = by_bisection(application, path, gear, catalogue)

    assert allowed is not None
    if allowed < 8:
        assert allowed == pytest.approx(found, abs=1e-7)  # 8 / 2^30, and 1e-9 of the engine
    else:
        assert found == pytest.approx(8, abs=1e-7)


def test_a_tolerance_that_no_change_of_its_own_mends_is_none_of_the_remedies(catalogue: Catalogue) -> None:
    """T_k fails with ±100 %, whatever the torques are."""
    asked = WIDE.model_copy(
        update={"tolerances": {**(WIDE.tolerances or {}), "emergency_stop.torque_Nm": Tolerance(percent=100)}}
    )
    over = account(Application.model_validate(asked.model_dump(exclude_unset=True)), catalogue)

    assert [line.given.path for line in over.holding] == []


def test_what_is_printed_of_a_remedy_holds(catalogue: Catalogue) -> None:
    over = account(WIDE, catalogue)
    gear = over.account.candidate.designation
    (line,) = over.holding

    assert line.given.path == "torque_Nm"
    assert line.given.text(Reader(), line.allowed or 0) == "±16.8\u202f%"
    assert holds(with_tolerance(WIDE, line.given.path, line.allowed or 0), gear, catalogue)
    assert not holds(with_tolerance(WIDE, line.given.path, 16.9 / 20), gear, catalogue)


SAMPLED = [
    ((-65, -22, -53), 22, 35),
    ((54, 60, 19, 44, -3), 18, 33),
    ((-6, 33, -15), 24, 32),
    ((30, 26, -10), 21, 21),
    ((25, 45, -16), 18, 28),
]
"""Torques in Nm, position error in arcmin and tolerance in Nm where a few samples miss what all of them show."""


@pytest.mark.parametrize(("torques", "error", "tolerance"), SAMPLED)
def test_a_smaller_tolerance_holds_at_every_sample(
    torques: tuple[float, ...], error: float, tolerance: float, catalogue: Catalogue
) -> None:
    """Torques that change their sign move the position error by the backlash at once, and nothing proves where."""
    asked = cycle(*(phase(torque, 100) for torque in torques), requirements={"position_error_arcmin": error})
    application = Application.model_validate(asked | {"tolerances": {"torque_Nm": {"absolute": tolerance}}})
    over = account(application, catalogue)
    assert over.room is not None and not over.room.holds and not over.room.exact

    gear, path = over.account.candidate.designation, "torque_Nm"
    known = catalogue.by_designation[gear]
    for factor in (over.room.growth, allowed_of(application, known, catalogue, path)):
        assert factor is not None and 0 < factor < 1
        assert holds(with_tolerance(application, path, factor), gear, catalogue)


def test_growth_beyond_the_tolerances_holds_at_every_sample(catalogue: Catalogue) -> None:
    asked = cycle(phase(-65, 100), phase(-22, 100), phase(-53, 100), requirements={"position_error_arcmin": 22})
    application = Application.model_validate(asked | {"tolerances": {"torque_Nm": {"absolute": 20}}})
    room = account(application, catalogue).room

    assert room is not None and room.holds and room.growth is not None and 1 <= room.growth < 35 / 20
    gear = judge(application, catalogue).selection(with_room=False).candidates[0].designation
    assert holds(with_tolerance(application, "torque_Nm", room.growth), gear, catalogue)


def test_scaled_tolerances_never_grow_by_rounding() -> None:
    given = Tolerance.model_validate({"minus": {"absolute": 0.1}, "plus": {"percent": 5}})

    assert scaled(given, 0.99999).sides[0].model_dump(exclude_none=True) == {"absolute": 0.0999}  # type: ignore[union-attr]
    assert scaled(Tolerance(percent=15), 1.0901941).percent == 16.3


def test_the_share_of_failing_cases_has_a_bound_above_zero(catalogue: Catalogue) -> None:
    over = account(HELD, catalogue)

    assert over.share is not None and over.share.failing == 0
    assert 0 < over.share.upper < 0.001


@pytest.mark.parametrize(("worst", "said"), [(True, ["by the worst case"]), (False, [])])
def test_how_gears_are_judged_is_an_input_in_words_where_it_is_no_default(worst: bool, said: list[str]) -> None:
    wishes = {"over_tolerance": worst}
    application = Application.model_validate(cycle(phase(40, 250), requirements=wishes))
    lines = lines_of(application, ["requirements.over_tolerance"])
    assert [line.shown(Reader()) for line in lines] == said
