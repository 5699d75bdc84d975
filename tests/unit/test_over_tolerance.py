"""A gear over the tolerances as pages and files tell it: corners, deciding inputs, and how far each may lie."""

import copy
from collections.abc import Iterator
from itertools import product
from typing import Any

import pytest

from hpn.account.account import Account
from hpn.account.inputs import lines_of
from hpn.account.over_tolerance import DecidingLine, OverTolerance, line_of, over_tolerance
from hpn.application import Application, InputError
from hpn.application.input_fields import takes_tolerance
from hpn.application.tolerances import Tolerance
from hpn.catalogue import Catalogue
from hpn.engine.allowed import with_listed_motor
from hpn.engine.alone import Alone
from hpn.engine.duty import Duty
from hpn.engine.evaluation import evaluate
from hpn.engine.room import allowed_of, scaled, with_tolerance
from hpn.engine.selection import judge
from hpn.words.reader import Reader
from tests.build import LIFTING, TURNING, Json, answer, check, cycle, notices, phase

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
    allowed = allowed_of(Alone.of(application, catalogue.by_designation[gear], catalogue), path)
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

    assert [line.tolerance.path for line in over.holding] == []


def test_what_is_printed_of_a_remedy_holds(catalogue: Catalogue) -> None:
    over = account(WIDE, catalogue)
    gear = over.account.candidate.designation
    (line,) = over.holding

    assert line.tolerance.path == "torque_Nm"
    assert line.tolerance.text(Reader(), line.allowed or 0) == "±16.8\u202f%"
    assert holds(with_tolerance(WIDE, line.tolerance.path, line.allowed or 0), gear, catalogue)
    assert not holds(with_tolerance(WIDE, line.tolerance.path, 16.9 / 20), gear, catalogue)


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
    for factor in (over.room.growth, allowed_of(Alone.of(application, known, catalogue), path)):
        assert factor is not None and 0 < factor < 1
        assert holds(with_tolerance(application, path, factor), gear, catalogue)


def test_an_input_that_moves_no_check_decides_nothing_of_a_sampled_motion(catalogue: Catalogue) -> None:
    """A pause has no part in the average torque; without the tolerance of the time, the case is the one as given."""
    tolerances = {"motion.moves.0.time_s": {"percent": 5}, "pause_s": {"percent": 10}}
    motion = {"duty_cycle": {"motion": TURNING, "pause_s": 1.0}, "tolerances": tolerances}
    over = account(Application.model_validate(motion), catalogue)
    (line,) = over.deciding

    assert over.room is not None and not over.room.exact
    assert line.tolerance.path == "motion.moves.0.time_s"
    assert line.worst == pytest.approx(over.account.candidate.utilisation, rel=1e-12)


@pytest.mark.parametrize(("worst", "exact", "told"), [(1.0213, 1.0195, "102.1 102"), (1.02, 0.99, "102 99")])
def test_a_fall_is_told_by_percentages_that_differ(worst: float, exact: float, told: str) -> None:
    line = DecidingLine(line_of("torque_Nm", Tolerance(percent=1)), exact, None)
    shown = " ".join(Reader().percent(share, line.between(worst)).split("\u202f")[0] for share in (worst, exact))
    assert shown == told


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
    assert [line.value_for(Reader()) for line in lines] == said


def test_of_a_motion_with_one_time_that_varies_nothing_is_proved_and_that_is_said(catalogue: Catalogue) -> None:
    """Inputs that leave times and ways, such as an inertia, are worst at an end; beside others no longer."""
    inertia, time = "motion.mechanism.inertia_kgm2", "motion.moves.0.time_s"
    for paths, proved in (([inertia], True), ([inertia, time], False), ([time], False)):
        tolerances = {path: {"percent": 2} for path in paths}
        reply = answer({"duty_cycle": {"motion": TURNING}, "tolerances": tolerances}, catalogue)
        checks = reply["candidates"][0]["checks"]
        assert [one["exact"] for one in checks] == [proved] * len(checks)
        assert ("tolerances_of_motion_sampled" in notices(reply)) != proved


ASKED: Json = {
    "output_load": {"radial_N": 300.0, "axial_N": 100.0, "load_coefficient": 1.3, "radial_position_mm": 30.0}
    | {"axial_radius_mm": 12.0, "shaft_centre_mm": 21.0},
    "requirements": {"sizes": ["20A"], "ratios": [5, 25], "life_h": 20000.0, "efficiency": 0.9}
    | {
        "natural_frequency_Hz": 6.0,
        "position_error_mm": 2.0,
        "position_radius_mm": 300.0,
        "ambient_temperature_degC": 25.0,
    }
    | {"backlash_arcmin": 6.0, "torsional_stiffness_Nm_per_rad": 9000.0, "weight_kg": 1.0, "length_mm": 150.0}
    | {
        "motor": {
            "maximum_speed_rpm": 4000.0,
            "rated_speed_rpm": 3000.0,
            "peak_torque_Nm": 20.0,
            "rated_torque_Nm": 8.0,
        }
    },
}
BRAKE: Json = {"torque_Nm": 40.0, "rise_time_s": 0.01, "reaction_time_s": 0.02, "speed_rpm": 50.0}
ROTOR: Json = {"inertia_kgm2": 5e-4, "inertia_ratio": 5.0}


def turning(stop: Json, **motor: float) -> Json:
    motion = TURNING | {"mechanism": TURNING["mechanism"] | {"inertia_kgm2": 0.9}}
    requirements = ASKED["requirements"] | {"motor": ASKED["requirements"]["motor"] | motor}
    document = {"duty_cycle": {"motion": motion, "pause_s": 0.5}, "emergency_stop": stop}
    return ASKED | document | {"requirements": requirements}


def typed(stop: Json, **motor: float) -> Json:
    phases = cycle(phase(30, 100, 0.5), phase(-20, 60, 0.8, radial_N=400.0), phase(5, 0, 0.3), pause_s=0.5)
    document = turning(stop, **motor) | phases
    return document | {"requirements": document["requirements"] | {"load_inertia_kgm2": 0.9, "rest_friction_Nm": 2.0}}


def numbers_of(
    part: Json | list[Any], place: tuple[str | int, ...] = ()
) -> Iterator[tuple[tuple[str | int, ...], float]]:
    for name, value in part.items() if isinstance(part, dict) else enumerate(part):
        if isinstance(value, dict | list):
            yield from numbers_of(value, (*place, name))
        elif isinstance(value, float | int) and value:
            yield (*place, name), value


def moved_to(document: Json, place: tuple[str | int, ...], value: float) -> Json:
    moved = copy.deepcopy(document)
    *way, name = place
    part: Any = moved
    for step in way:
        part = part[step]
    part[name] = value
    return moved


@pytest.mark.parametrize(
    "document",
    [turning({"brake": BRAKE}, **ROTOR), turning({"torque_Nm": 200.0, "count": 100}), typed({"brake": BRAKE}, **ROTOR)],
)
def test_a_tolerance_of_any_single_input_counts_in_every_check(document: Json, catalogue: Catalogue) -> None:
    """At both ends of each input no check is worse than its worst case. All gears are too heavy: none has a reserve."""
    counted = 0
    for place, value in numbers_of(document):
        path = ".".join(map(str, place)).removeprefix("duty_cycle.")
        if not takes_tolerance(path):
            continue
        reply = answer(document | {"tolerances": {path: {"percent": 4}}}, catalogue)
        for factor in (0.96, 1.04):
            end = answer(moved_to(document, place, value * factor), catalogue)
            for found in end["candidates"]:
                for one in found["checks"]:
                    worst = check(reply, found["designation"], one["code"])["worst"]
                    counted += 1
                    assert worst >= one["utilisation"] * (1 - 1e-12), (path, one["code"])
    assert counted > 1000


ONE_WAY = TURNING | {"mechanism": TURNING["mechanism"] | {"inertia_kgm2": 0.9}, "moves": TURNING["moves"][:2]}


@pytest.mark.parametrize(
    ("motion", "paths"),
    [
        (ONE_WAY, "moves.0.time_s moves.0.angle_deg moves.1.time_s mechanism.inertia_kgm2"),
        (LIFTING, "moves.0.time_s moves.0.distance_mm moves.1.speed_mm_per_s mechanism.mass_kg"),
    ],
)
def test_no_corner_of_a_sampled_motion_is_worse_than_its_worst_case(
    motion: Json, paths: str, catalogue: Catalogue
) -> None:
    """Ways rise, times fall: 256 motions in four inputs are not near that corner."""
    places = [tuple(int(step) if step.isdigit() else step for step in path.split(".")) for path in paths.split()]
    document: Json = {"duty_cycle": {"motion": motion, "pause_s": 0.5}}
    document["requirements"] = {"sizes": ["20A"], "ratios": [5]}
    tolerances = {".".join(map(str, ("motion", *place))): {"percent": 4} for place in places}
    reply = answer(document | {"tolerances": tolerances}, catalogue)
    for factors in product((0.96, 1.04), repeat=len(places)):
        corner = document
        for place, factor in zip(places, factors, strict=True):
            whole = ("duty_cycle", "motion", *place)
            corner = moved_to(corner, whole, factor * dict(numbers_of(document))[whole])
        for one in answer(corner, catalogue)["candidates"][0]["checks"]:
            worst = check(reply, "HPN-20A-5", one["code"])
            assert worst["exact"] is False
            assert worst["worst"] >= one["utilisation"] * (1 - 1e-12), (one["code"], factors)


def test_of_a_stop_by_the_brake_with_a_counterweight_nothing_is_proved(catalogue: Catalogue) -> None:
    asked = {
        "emergency_stop": {"brake": {"torque_Nm": 4.0}},
        "requirements": {"motor": {"inertia_kgm2": 5e-4}, "sizes": ["20A"]},
        "tolerances": {"motion.mechanism.mass_kg": {"percent": 5}},
    }
    for mass_kg, proved in ((30.0, False), (0.0, True)):
        motion = LIFTING | {"mechanism": LIFTING["mechanism"] | {"counterweight_kg": mass_kg}}
        reply = answer({"duty_cycle": {"motion": motion}} | asked, catalogue)
        designation = reply["candidates"][0]["designation"]
        assert check(reply, designation, "momentary_peak_torque")["exact"] == proved
        assert check(reply, designation, "repeated_peak_torque")["exact"]
