"""Remedies and reserves in words."""

import re

import pytest
from msgspec import structs

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.candidates import Candidate
from hpn.engine.remedy import BY_CURVE, alternatives_of, growths_of, remedy_of, ways_of
from hpn.engine.selection import Selection, select
from hpn.engine.tried import followed, needed_of, tried
from hpn.words.wording import rounded
from tests.build import Json, cycle, phase, worked_example
from tests.conftest import Supplement


def selected(application: Json, catalogue: Catalogue) -> Selection:
    """Selection of an application given as JSON."""
    return select(Application.model_validate(application), catalogue)


def chosen(selection: Selection, designation: str) -> Candidate:
    """A candidate that is there."""
    candidate = selection.candidate(designation)
    assert candidate is not None
    return candidate


def words(application: Json, designation: str, catalogue: Catalogue) -> str | None:
    """Remedy of a gear in English."""
    gear = chosen(selected(application, catalogue), designation)
    remedy = remedy_of(gear, needed_of(gear, Application.model_validate(application), catalogue))
    return remedy.text if remedy else None


def test_remedy_of_the_worked_example_reads_as_an_engineer_says_it(catalogue: Catalogue) -> None:
    expected = "Fits if torques drop to 90.5 % and T_k to 107 Nm."
    assert words(worked_example(), "HPN-14A-5", catalogue) == expected


def test_a_suitable_and_an_unrated_gear_need_no_remedy(catalogue: Catalogue) -> None:
    assert words(worked_example(), "HPN-20A-5", catalogue) is None
    assert words(worked_example(), "HPN-40A-5", catalogue) is None


def test_a_gear_that_fails_what_is_known_of_it_gets_no_promise_about_what_is_not(catalogue: Catalogue) -> None:
    """Five times what HPN-32A may carry, on a motor a twentieth too slow for HPN-40A-7."""
    wishes = {"sizes": ["32A", "40A"], "motor": {"maximum_speed_rpm": 4000}}
    question = cycle(phase(2000, 600), requirements=wishes)
    selection = selected(question, catalogue)
    first = selection.candidates[0]

    assert (first.designation, first.status) == ("HPN-40A-7", "unsuitable")
    assert words(question, "HPN-40A-7", catalogue) is None
    assert ways_of(first) == ()
    assert selection.foremost.size == "32A"


def test_a_life_that_fails_alone_can_be_mended_by_torque_or_by_speed(catalogue: Catalogue) -> None:
    application = worked_example(requirements={"life_h": 2_334_551.88})  # twice what the gear reaches
    expected = "Fits if one of these holds: (1) torques drop to 81.2 %; (2) speeds drop to 50 %."
    assert words(application, "HPN-20A-5", catalogue) == expected


def test_a_bearing_life_that_fails_alone_can_be_mended_by_load_or_by_speed(catalogue: Catalogue) -> None:
    application = cycle(phase(1.0, 100.0), output_load={"radial_N": 900.0, "life_h": 20_000.0 * 2**3 * 2**3})
    expected = "Fits if one of these holds: (1) output loads drop to 50 %; (2) speeds drop to 12.5 %."
    assert words(application, "HPN-20A-5", catalogue) == expected


def test_one_change_that_suffices_alone_comes_before_two(catalogue: Catalogue) -> None:
    lives = {"requirements": {"life_h": 2_334_551.88}, "output_load": {"radial_N": 500.0, "life_h": 3_000_000.0}}
    message = words(worked_example() | lives, "HPN-20A-5", catalogue)
    assert message and re.search(r"\(1\) speeds drop to [0-9.]+ %; \(2\) torques drop to 81.2 % and output", message), (
        message
    )


def test_properties_that_fail_name_the_limit_that_has_to_change(catalogue: Catalogue) -> None:
    wishes = {"backlash_arcmin": 6.0, "weight_kg": 2.0, "ambient_temperature_degC": 50.0}
    application = cycle(phase(1.0, 10.0), requirements=wishes)
    expected = (
        "Fits if the ambient temperature drops to 40 °C, the backlash limit rises to 7 arcmin and the weight limit "
        "rises to 3.1 kg."
    )
    weight = catalogue.by_designation["HPN-20A-20"].weight_kg
    assert words(application, "HPN-20A-20", catalogue) == expected.replace("3.1", f"{weight:g}")


def test_a_load_check_and_a_property_stand_in_one_sentence(catalogue: Catalogue) -> None:
    application = worked_example(requirements={"backlash_arcmin": 4.0})
    expected = "Fits if torques drop to 90.5 %, T_k to 107 Nm and the backlash limit rises to 5 arcmin."
    assert words(application, "HPN-14A-5", catalogue) == expected


def test_too_many_stops_may_be_gentler_or_rarer(catalogue: Catalogue) -> None:
    application = cycle(phase(10.0, 100.0), emergency_stop={"torque_Nm": 200.0, "count": 4_000_000})
    expected = "Fits if one of these holds: (1) T_k drops to 188.5 Nm; (2) N_k drops to 3066000."
    assert words(application, "HPN-20A-5", catalogue) == expected


def test_following_the_remedy_makes_the_gear_of_the_worked_example_suitable(catalogue: Catalogue) -> None:
    application = Application.model_validate(worked_example())
    gear = chosen(select(application, catalogue), "HPN-14A-5")
    changed = followed(application, ways_of(gear)[0])
    assert [p.torque_Nm for p in changed.duty_cycle.load_phases] == [36.2, 28.96, 18.1]
    assert changed.emergency_stop is not None and changed.emergency_stop.torque_Nm == 107.0
    assert chosen(select(changed, catalogue), "HPN-14A-5").status == "suitable"


def test_a_motor_torque_that_follows_an_efficiency_curve_says_why_its_growth_is_missing(catalogue: Catalogue) -> None:
    application = worked_example(requirements={"motor": {"peak_torque_Nm": 50}})
    gear = chosen(selected(application, catalogue), "HPN-20A-5")
    [torque, *_] = growths_of(gear)["motor_peak_torque"]
    assert torque.factor is not None
    unknown = structs.replace(gear.reserve, torque_factor=None)  # as with a supplied curve
    [torque, *_] = growths_of(structs.replace(gear, reserve=unknown))["motor_peak_torque"]
    assert (torque.factor, torque.share) == (None, None)
    assert "efficiency follows your curve" in torque.bound.text


def test_nothing_is_said_to_follow_a_curve_that_nobody_gave(catalogue: Catalogue) -> None:
    """A reserve is empty for other reasons too: nothing is asked of the gear, or its limits are not published."""
    motor = {"peak_torque_Nm": 50, "rated_torque_Nm": 20}
    idle = chosen(selected(cycle(phase(0, 100), requirements={"motor": motor}), catalogue), "HPN-20A-5")
    assert idle.reserve.torque_factor is None
    assert {growth.bound.text for growth in growths_of(idle)["motor_peak_torque"]} == {"without limit"}
    unrated = chosen(selected(worked_example(requirements={"motor": motor}), catalogue), "HPN-40A-5")
    assert unrated.check("motor_peak_torque") is not None
    assert growths_of(unrated)["motor_peak_torque"] == ()


@pytest.mark.parametrize(
    ("value", "digits", "down", "up"),
    [
        (0.90566, 3, "0.905", "0.906"),
        (107.0, 4, "107", "107"),
        (106.99999999999999, 4, "107", "107"),
        (9.999, 3, "9.99", "10"),
        (0.0999999, 3, "0.0999", "0.1"),
        (0.0, 3, "0", "0"),
    ],
)
def test_bounds_are_rounded_to_the_safe_side(value: float, digits: int, down: str, up: str) -> None:
    assert rounded(value, digits, "down") == down
    assert rounded(value, digits, "up") == up


def test_a_remedy_that_is_tried_out_passes_to_the_last_digit(catalogue: Catalogue) -> None:
    """0.8 of this speed has more than twelve digits: rounded to the nearest it would be too much by a part in 1e12."""
    wishes = {"ratios": [35], "sizes": ["14A"], "utilisation": 0.8}
    application = Application.model_validate(cycle(phase(1, 171.42857142857142), pause_s=3, requirements=wishes))
    [way] = ways_of(select(application, catalogue).candidates[0], 0.8)

    assert select(followed(application, way), catalogue).selected == "HPN-14A-35"


def test_a_motor_at_a_smaller_torque_is_promised_nothing_where_a_curve_says_what_it_takes(
    supplemented: Supplement,
) -> None:
    """At 26 Nm the curve has no efficiency; just below it does, and the motor needs more than before."""
    curve = "size,ratio,torque_Nm,efficiency,source\n14A,5,5,0.5,p\n14A,5,25,0.9,p\n"
    book, motor = supplemented(efficiency=curve), {"peak_torque_Nm": 4.0}
    both = cycle(phase(26, 30), requirements={"ratios": [5], "utilisation": 0.8586, "motor": motor})
    alone = cycle(phase(20, 30), requirements={"ratios": [5], "utilisation": 0.8586, "motor": motor})

    why = f"The change that would make it fit is {BY_CURVE}."
    assert words(both, "HPN-14A-5", book) == why
    assert words(alone, "HPN-14A-5", book) == "Fits if the motor’s peak torque rises to 5.824 Nm."


def test_no_smaller_torque_is_promised_to_a_motor_that_turns_a_gear_with_a_torque_without_load(
    supplemented: Supplement,
) -> None:
    """40 Nm / 5 + 4 Nm are 12 Nm; at 8 Nm of the motor 20 Nm are left, half of the torque and not two thirds."""
    book = supplemented(gears="size,ratio,stages,no_load_torque_Nm,source\n20A,5,1,4,measured\n")
    document = {"ratios": [5], "sizes": ["20A"], "motor": {"peak_torque_Nm": 8.0}}
    application = Application.model_validate(cycle(phase(40, 250), requirements=document))
    gear = chosen(select(application, book), "HPN-20A-5")

    assert gear.reserve.torque_factor is None
    assert growths_of(gear)["motor_peak_torque"][0].factor is None
    for alternative in alternatives_of(gear):
        assert chosen(select(tried(application, alternative, book), book), "HPN-20A-5").status == "suitable"
    assert words(cycle(phase(40, 250), requirements=document), "HPN-20A-5", book) == (
        "Fits if the motor’s peak torque rises to 12 Nm."
    )


SCREW: Json = {
    "mechanism": {"type": "ball_screw", "lead_mm": 20, "mass_kg": 400, "inertia_kgm2": 0.0005},
    "moves": [{"profile": "trapezoidal", "distance_mm": 400, "time_s": 1.2, "acceleration_mm_per_s2": 2000}],
}


@pytest.mark.parametrize(
    "own",
    [{"peak_torque_Nm": 9, "rated_torque_Nm": 3}, {"rated_speed_rpm": 900, "peak_torque_Nm": 2, "rated_torque_Nm": 1}],
)
@pytest.mark.parametrize("u", [1.0, 0.8586])
def test_a_motor_too_slow_by_its_own_inertia_may_be_faster(catalogue: Catalogue, own: Json, u: float) -> None:
    """The motor's own limits have a closed form where speeds and torques have none; a hair less fails."""
    motor = {"maximum_speed_rpm": 4500, "inertia_kgm2": 0.0003} | own
    document = {"duty_cycle": {"motion": SCREW, "pause_s": 1}, "requirements": {"motor": motor, "utilisation": u}}
    application, mended = Application.model_validate(document), 0
    for gear in select(application, catalogue).candidates:
        codes = {check.code for check in gear.failing}
        if not codes or not gear.is_judged or any(not code.startswith("motor_") for code in codes):
            continue
        [alternative] = alternatives_of(gear, u)
        faster = tried(application, alternative, catalogue)
        assert faster.duty_cycle == application.duty_cycle
        assert chosen(select(faster, catalogue), gear.designation).status == "suitable", codes
        for change in alternative.requirements:
            name = change.path.rpartition(".")[2]
            stated = faster.requirements.motor
            assert stated is not None
            slower = stated.model_copy(update={name: getattr(stated, name) * 0.998})
            wishes = faster.requirements.model_copy(update={"motor": slower})
            less = select(faster.model_copy(update={"requirements": wishes}), catalogue)
            assert chosen(less, gear.designation).status == "unsuitable", change
        mended += 1
    assert mended > 3
    if own["peak_torque_Nm"] == 9 and u == 1:
        expected = "Fits if the motor’s maximum speed rises to 4800 rpm."
        assert words(document, "HPN-11A-4", catalogue) == expected


def test_a_brake_that_does_not_stop_the_load_has_no_alternative_whatever_else_fails(catalogue: Catalogue) -> None:
    hanging = {"type": "rotary", "inertia_kgm2": 7.0, "gravity_mass_kg": 100.0, "gravity_radius_mm": 250.0}
    motion = {"mechanism": hanging, "moves": [{"profile": "triangular", "angle_deg": 90.0, "time_s": 9.0}]}
    document = {"sizes": ["32A"], "weight_kg": 1.0}
    weak = {"duty_cycle": {"motion": motion}, "emergency_stop": {"brake": {"torque_Nm": 0.1}}, "requirements": document}
    for gear in selected(weak, catalogue).candidates:
        assert {"momentary_peak_torque", "weight"} <= {check.code for check in gear.failing}
        assert alternatives_of(gear) == ()


LIFTING_ONLY = {
    "mechanism": {"type": "rotary", "inertia_kgm2": 2.5, "friction_torque_Nm": 100.0},
    "moves": [{"profile": "trapezoidal", "angle_deg": 90.0, "time_s": 1.0}],
}


@pytest.mark.parametrize(
    "question",
    [{"position_error_arcmin": 9.0}, {"natural_frequency_Hz": 25.0}, {"torsional_stiffness_Nm_per_rad": 27e3}],
)
def test_each_change_of_a_motion_makes_the_gear_fit_as_it_is_printed(question: Json, catalogue: Catalogue) -> None:
    """Torques all of one sign keep it where phases take the place of the motion: nothing acts both ways."""
    document = {"duty_cycle": {"motion": LIFTING_ONLY}, "requirements": {"sizes": ["14A", "20A"]} | question}
    application = Application.model_validate(document)
    rejected = [one for one in select(application, catalogue).candidates if one.status == "unsuitable"]
    alternatives = [(gear.designation, change) for gear in rejected for change in alternatives_of(gear)]
    assert any(change.way.torque < 1 for _, change in alternatives)
    for designation, change in alternatives:
        after = chosen(select(tried(application, change, catalogue), catalogue), designation)
        assert after.status == "suitable", (designation, change, after.failing)


def test_each_check_says_how_far_its_own_drivers_may_grow(catalogue: Catalogue) -> None:
    """By hand: 80 / 32.021, 149 / 40 and 256 / 200 Nm, 3066035 of 1000 stops, 3000 / 1087.66 and 6000 / 2500 rpm."""
    application = worked_example(
        requirements={"life_h": 20_000, "weight_kg": 2.0}, emergency_stop={"torque_Nm": 200, "count": 1000}
    )
    growths = growths_of(chosen(selected(application, catalogue), "HPN-20A-5"))
    by_name = {code: [(one.driver, one.bound.text) for one in result] for code, result in growths.items()}

    assert by_name == {
        "average_torque": [("torque", "up to 249 %")],
        "repeated_peak_torque": [("torque", "up to 372 %")],
        "momentary_peak_torque": [("emergency_stop", "up to 128 %")],
        "momentary_peak_count": [("emergency_stop_count", "up to 306000 %")],
        "average_input_speed": [("speed", "up to 275 %")],
        "maximum_input_speed": [("speed", "up to 240 %")],
        "life": [("torque", "up to 338 %"), ("speed", "up to 5830 %")],
        "weight": [],
    }


@pytest.mark.parametrize(("radial_N", "sign"), [(800.0, "more"), (1700.0, "less")])
def test_the_smallest_change_of_a_bearing_life_stands_first(catalogue: Catalogue, radial_N: float, sign: str) -> None:
    """The life goes by the load to the power 3 and by the speed to the power 1: less of a change of the load does."""
    selection = selected(cycle(phase(10, 300), output_load={"radial_N": radial_N}), catalogue)
    load, speed = growths_of(chosen(selection, "HPN-20A-5"))["output_bearing_life"]

    assert (load.driver, speed.driver) == ("load", "speed")
    assert load.factor is not None
    assert speed.factor == pytest.approx(load.factor**3, rel=1e-12)
    assert (load.factor > 1) == (sign == "more")


def test_a_check_without_a_limit_or_a_rating_says_so(catalogue: Catalogue) -> None:
    selection = selected(cycle(phase(0.0, 100.0), emergency_stop={"torque_Nm": 1, "count": 1}), catalogue)
    fine, unrated = growths_of(chosen(selection, "HPN-20A-5")), growths_of(chosen(selection, "HPN-40A-5"))

    assert [one.bound.text for one in fine["average_torque"]] == ["without limit"]
    assert [one.bound.text for one in fine["momentary_peak_count"]] == ["without limit"]
    assert unrated["average_torque"] == unrated["momentary_peak_count"] == ()
