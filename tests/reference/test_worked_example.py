"""The worked example of chapter 4.1 (equations 18.1 to 18.9), unrounded and as printed."""

import numpy as np
import pytest

from hpn.catalogue import Catalogue
from hpn.physics import equations
from tests.build import answer, candidate, check, suitable, worked_example
from tests.reference.handbook import WORKED_EXAMPLE as PRINTED

CHOICE = "HPN-20A-5"


def test_the_example_gives_the_unrounded_figures(catalogue: Catalogue) -> None:
    """The product and a calculation by hand with a 30-digit calculator agree to the digits noted down from it."""
    reply = answer(worked_example(requirements={"ratios": [PRINTED["ratio"]]}), catalogue)
    chosen = candidate(reply, CHOICE)

    # Each tolerance is half a unit of the last digit noted.
    assert reply["duty"]["average_torque_Nm"] == pytest.approx(32.0210136, abs=0.5e-7)
    assert reply["duty"]["average_output_speed_rpm"] == pytest.approx(217.532468, abs=0.5e-6)
    assert reply["duty"]["maximum_torque_Nm"] == 40
    assert reply["duty"]["maximum_output_speed_rpm"] == 500
    assert chosen["average_input_speed_rpm"] == pytest.approx(1087.662338, abs=0.5e-6)
    assert chosen["maximum_input_speed_rpm"] == 2500
    assert chosen["momentary_peak_count"] == 3066035
    assert chosen["life_L10_h"] == pytest.approx(1167275.94, abs=0.5e-2)


def test_the_example_gives_the_printed_figures_when_rounded_where_the_handbook_rounded(catalogue: Catalogue) -> None:
    """Each printed line follows from the printed lines before it, as the handbook worked with rounded results."""
    T, n, t = (np.array(column, dtype=float) for column in zip(*PRINTED["phases"], strict=True))
    gear = catalogue.by_designation[CHOICE]
    assert gear.repeated_peak_torque_Nm is not None

    T_av = equations.average_output_torque(torque_Nm=T, speed_rpm=n, duration_s=t)
    assert round(float(T_av)) == PRINTED["printed_average_output_torque_nm"]

    n_out_av = equations.average_output_speed(speed_rpm=n, duration_s=t, pause_s=PRINTED["pause_s"])
    assert round(float(n_out_av)) == PRINTED["printed_average_output_speed_rpm"]

    n_in_av = equations.average_input_speed(
        ratio=PRINTED["ratio"], average_output_speed_rpm=PRINTED["printed_average_output_speed_rpm"]
    )
    assert n_in_av == PRINTED["printed_average_input_speed_rpm"]

    n_in_max = equations.maximum_input_speed(ratio=PRINTED["ratio"], maximum_output_speed_rpm=n.max())
    assert n_in_max == PRINTED["printed_maximum_input_speed_rpm"]

    # x is not an output of the product: solve 10^x = N_k for the unrounded count, then round as printed.
    N_k = equations.allowed_momentary_peaks(
        emergency_stop_torque_Nm=PRINTED["momentary_peak_torque_nm"],
        repeated_peak_torque_Nm=gear.repeated_peak_torque_Nm,
    )
    x = round(float(np.log10(N_k)), 2)
    assert x == PRINTED["printed_exponent"]
    assert int(10**x) == PRINTED["printed_momentary_peak_count"]

    life = equations.life(
        average_torque_Nm=PRINTED["printed_average_output_torque_nm"],
        average_input_speed_rpm=PRINTED["printed_average_input_speed_rpm"],
        rated_torque_Nm=PRINTED["printed_rated_torque_nm"],
        rated_input_speed_rpm=PRINTED["printed_rated_input_speed_rpm"],
    )
    assert round(float(life)) == PRINTED["printed_life_h"]


def test_the_limits_are_those_that_the_example_compares_with(catalogue: Catalogue) -> None:
    reply = answer(worked_example(requirements={"ratios": [5]}), catalogue)
    limits = {
        "average_torque": PRINTED["printed_average_torque_limit_nm"],
        "repeated_peak_torque": PRINTED["printed_repeated_peak_torque_nm"],
        "momentary_peak_torque": PRINTED["printed_momentary_peak_torque_limit_nm"],
        "maximum_input_speed": PRINTED["printed_maximum_input_speed_limit_rpm"],
    }
    for code, limit in limits.items():
        assert check(reply, CHOICE, code)["limit"] == limit
        assert check(reply, CHOICE, code)["status"] == "pass"


def test_the_printed_choice_is_selected_as_the_smallest_gear_of_its_ratio(catalogue: Catalogue) -> None:
    reply = answer(worked_example(requirements={"ratios": [5]}), catalogue)

    assert reply["selected"] == CHOICE
    assert suitable(reply) == {CHOICE, "HPN-32A-5"}
    assert candidate(reply, CHOICE)["rank"] == 1
    assert candidate(reply, CHOICE)["governing_check"] == "momentary_peak_torque"
    assert candidate(reply, CHOICE)["utilisation"] == 200 / 256


def test_the_next_smaller_size_fails_with_the_average_torque_and_the_emergency_stop(catalogue: Catalogue) -> None:
    reply = answer(worked_example(requirements={"ratios": [5]}), catalogue)
    failed = {entry["code"] for entry in candidate(reply, "HPN-14A-5")["checks"] if entry["status"] == "fail"}

    assert failed == {"average_torque", "momentary_peak_torque"}
    assert check(reply, "HPN-14A-5", "average_torque")["limit"] == 29
    assert check(reply, "HPN-14A-5", "momentary_peak_torque")["limit"] == 107


def test_without_a_wish_for_a_ratio_the_lightest_gear_that_passes_is_taken(catalogue: Catalogue) -> None:
    """The gear found by eye: of 20A single-stage, 2.6 kg, only the ratios that carry 32 Nm, 40 Nm and 200 Nm."""
    reply = answer(worked_example(), catalogue)
    single_stage = {"HPN-20A-3", "HPN-20A-4", "HPN-20A-5", "HPN-20A-7", "HPN-20A-10"}

    assert suitable(reply) & single_stage == single_stage
    # All weigh the same, so the tie falls to the lowest utilisation. T_k/T_M is 200/256 for ratios 4, 5 and 7 and
    # 200/226 and 200/216 for 3 and 10; the tie of the three falls to the longest life, which eq. 17.10 gives ratio 4.
    assert reply["selected"] == "HPN-20A-4"
