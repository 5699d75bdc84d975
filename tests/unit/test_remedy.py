"""Remedies and reserves in words."""

import pytest
from msgspec import structs

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.remedy import followed, remedy_of, rooms_of, ways_of
from hpn.selection import Candidate, Selection, select
from hpn.wording import rounded
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
    u = application.get("requirements", {}).get("utilisation", 1.0)
    gear = chosen(selected(application, catalogue), designation)
    remedy = remedy_of(gear, catalogue.by_designation[designation], u)
    return remedy.text if remedy else None


def test_remedy_of_the_worked_example_reads_as_issue_4_asks(catalogue: Catalogue) -> None:
    expected = "Fits if the duty torques are at most 0.905 of these and T_k at most 107 Nm."
    assert words(worked_example(), "HPN-14A-5", catalogue) == expected


def test_a_suitable_and_an_unrated_gear_need_no_remedy(catalogue: Catalogue) -> None:
    assert words(worked_example(), "HPN-20A-5", catalogue) is None
    assert words(worked_example(), "HPN-40A-5", catalogue) is None


def test_a_gear_that_fails_what_is_known_of_it_gets_no_promise_about_what_is_not(catalogue: Catalogue) -> None:
    """Twice what any gear of the series may carry, on a motor a twentieth too slow for HPN-40A-7."""
    asked = cycle(phase(2000, 600), requirements={"motor": {"maximum_speed_rpm": 4000}})
    selection = selected(asked, catalogue)
    first = selection.candidates[0]

    assert (first.designation, first.status) == ("HPN-40A-7", "unsuitable")
    assert words(asked, "HPN-40A-7", catalogue) is None
    assert ways_of(first) == ()
    assert rooms_of(first) == ()
    assert selection.foremost.size == "32A"


def test_a_life_that_fails_alone_can_be_mended_by_torque_or_by_speed(catalogue: Catalogue) -> None:
    application = worked_example(requirements={"life_h": 2_334_551.88})  # twice what the gear reaches
    expected = "Fits if the duty torques are at most 0.812 of these, or if the speeds are at most 0.5 of these."
    assert words(application, "HPN-20A-5", catalogue) == expected


def test_a_bearing_life_that_fails_alone_can_be_mended_by_load_or_by_speed(catalogue: Catalogue) -> None:
    application = cycle(phase(1.0, 100.0), output_load={"radial_N": 900.0, "life_h": 20_000.0 * 2**3 * 2**3})
    expected = "Fits if the output loads are at most 0.5 of these, or if the speeds are at most 0.125 of these."
    assert words(application, "HPN-20A-5", catalogue) == expected


def test_properties_that_fail_are_named_with_what_has_to_be_accepted(catalogue: Catalogue) -> None:
    wishes = {"backlash_arcmin": 6.0, "weight_kg": 2.0, "ambient_temperature_degC": 50.0}
    application = cycle(phase(1.0, 10.0), requirements=wishes)
    expected = (
        "Fits if the ambient temperature lies between 0 °C and 40 °C, 7 arcmin backlash are accepted and a weight of "
        "3.1 kg is accepted."
    )
    weight = catalogue.by_designation["HPN-20A-20"].weight_kg
    assert words(application, "HPN-20A-20", catalogue) == expected.replace("3.1", f"{weight:g}")


def test_a_load_check_and_a_property_stand_in_one_sentence(catalogue: Catalogue) -> None:
    application = worked_example(requirements={"backlash_arcmin": 4.0})
    expected = (
        "Fits if the duty torques are at most 0.905 of these and T_k at most 107 Nm, and if 5 arcmin backlash are "
        "accepted."
    )
    assert words(application, "HPN-14A-5", catalogue) == expected


def test_too_many_stops_may_be_gentler_or_rarer(catalogue: Catalogue) -> None:
    application = cycle(phase(10.0, 100.0), emergency_stop={"torque_Nm": 200.0, "count": 4_000_000})
    expected = "Fits if T_k is at most 188.5 Nm or the number of stops at most 3066035."
    assert words(application, "HPN-20A-5", catalogue) == expected


def test_following_the_remedy_makes_the_gear_of_the_worked_example_suitable(catalogue: Catalogue) -> None:
    application = Application.model_validate(worked_example())
    gear = chosen(select(application, catalogue), "HPN-14A-5")
    changed = followed(application, ways_of(gear)[0])
    assert [p.torque_Nm for p in changed.duty_cycle.phases] == [36.2, 28.96, 18.1]
    assert changed.emergency_stop is not None and changed.emergency_stop.torque_Nm == 107.0
    assert chosen(select(changed, catalogue), "HPN-14A-5").status == "suitable"


def test_reserve_of_the_worked_example_says_which_check_limits_each_driver(catalogue: Catalogue) -> None:
    rooms = rooms_of(chosen(selected(worked_example(), catalogue), "HPN-20A-5"))
    assert [(room.driver, room.bound.text, room.check) for room in rooms] == [
        ("torque", "up to 2.49 times", "average_torque"),
        ("speed", "up to 2.4 times", "maximum_input_speed"),
        ("emergency_stop", "up to 256 Nm", "momentary_peak_torque"),
    ]


def test_torque_reserve_that_follows_an_efficiency_curve_says_why_it_is_missing(catalogue: Catalogue) -> None:
    gear = chosen(selected(worked_example(), catalogue), "HPN-20A-5")
    unknown = structs.replace(gear.reserve, torque_factor=None)  # as with a supplied curve and a motor
    gear = structs.replace(gear, reserve=unknown)
    assert "efficiency follows your curve" in rooms_of(gear)[0].bound.text


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


def test_what_is_tried_out_passes_to_the_last_digit(catalogue: Catalogue) -> None:
    """0.8 of this speed has more than twelve digits: rounded to the nearest it would be too much by a part in 1e12."""
    wishes = {"ratios": [35], "sizes": ["14A"], "utilisation": 0.8}
    asked = Application.model_validate(cycle(phase(1, 171.42857142857142), pause_s=3, requirements=wishes))
    [way] = ways_of(select(asked, catalogue).candidates[0], 0.8)

    assert select(followed(asked, way), catalogue).selected == "HPN-14A-35"


def test_a_motor_at_a_smaller_torque_is_promised_nothing_where_a_curve_says_what_it_takes(
    supplemented: Supplement,
) -> None:
    """At 26 Nm the curve has no efficiency; just below it does, and the motor needs more than before."""
    curve = "size,ratio,torque_Nm,efficiency,source\n14A,5,5,0.5,p\n14A,5,25,0.9,p\n"
    book, motor = supplemented(efficiency=curve), {"peak_torque_Nm": 4.0}
    both = cycle(phase(26, 30), requirements={"ratios": [5], "utilisation": 0.8586, "motor": motor})
    alone = cycle(phase(20, 30), requirements={"ratios": [5], "utilisation": 0.8586, "motor": motor})

    assert words(both, "HPN-14A-5", book) is None
    assert words(alone, "HPN-14A-5", book) == "Fits if the motor's peak torque is at least 5.824 Nm."
