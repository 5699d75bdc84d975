"""Demand and limit of the checks of the output bearing in hours and newtons."""

import math
import random

import pytest

from hpn.account.account import Account
from hpn.account.readings import CheckReading, readings_of
from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.selection import select
from tests.build import Json, cycle, phase, worked_example
from tests.conftest import Supplement
from tests.property.draw import at_random
from tests.reference.test_motion import CONTRACT

LIGHT_STOPS = worked_example(emergency_stop={"torque_Nm": 5, "count": 10}, requirements={"utilisation": 0.93})


def readings(application: Json, designation: str, catalogue: Catalogue) -> dict[str, CheckReading]:
    """Readings of a gear's checks."""
    question = Application.model_validate(application)
    selection = select(question, catalogue)
    candidate = selection.candidate(designation)
    assert candidate is not None
    return readings_of(candidate, selection, question, catalogue)


def test_the_load_of_the_worst_phase_stands_beside_the_published_maximum_in_its_direction(catalogue: Catalogue) -> None:
    """Purely radial and purely axial loads stand beside the rating table's own maxima of HPN-20A."""
    first, second = phase(1.0, 100.0, radial_N=100.0), phase(1.0, 100.0, radial_N=-600.0)
    radial = readings(
        cycle(first, second, output_load={"axial_N": 0.0, "load_coefficient": 1.2}), "HPN-20A-5", catalogue
    )
    axial = readings(cycle(phase(1.0, 100.0), output_load={"axial_N": 700.0}), "HPN-20A-5", catalogue)

    load = radial["output_bearing_load"]
    assert (load.unit, load.sign) == ("N", "≤")
    assert load.demand == pytest.approx(720.0)
    assert load.limit == pytest.approx(1800.0)
    assert axial["output_bearing_load"].limit == pytest.approx(2200.0)


@pytest.mark.parametrize(("basis", "life_h"), [("L50", 20_000.0 * 8), ("L10", 4_000.0 * 8)])
def test_the_life_stands_beside_the_required_one_on_its_own_basis(
    basis: str, life_h: float, catalogue: Catalogue
) -> None:
    """At half of the radial maximum and 100 rpm a bearing reaches eight times its 20000 h as L50, a fifth as L10."""
    load = {"radial_N": 900.0, "life_h": 5000.0, "life_basis": basis}
    life = readings(cycle(phase(1.0, 100.0), output_load=load), "HPN-20A-5", catalogue)["output_bearing_life"]

    assert (life.limit, life.unit, life.sign, life.limit_name) == (5000.0, "h", "≥", f"{basis} required")
    assert life.demand == pytest.approx(life_h)


def test_a_load_of_nothing_reaches_any_life_and_has_no_direction(catalogue: Catalogue) -> None:
    nothing = readings(cycle(phase(1.0, 100.0), output_load={"radial_N": 0.0}), "HPN-20A-5", catalogue)
    assert nothing["output_bearing_life"].is_unlimited
    assert nothing["output_bearing_load"].demand == 0


def test_a_size_without_published_limits_has_no_figures(catalogue: Catalogue) -> None:
    unrated = readings(cycle(phase(1.0, 100.0), output_load={"radial_N": 10.0}), "HPN-40A-5", catalogue)
    life, load = unrated["output_bearing_life"], unrated["output_bearing_load"]
    assert (life.demand, life.is_unlimited, load.demand) == (None, False, None)


def test_other_checks_read_as_they_were_computed(catalogue: Catalogue) -> None:
    read = readings(worked_example(requirements={"utilisation": 0.8}), "HPN-20A-5", catalogue)
    torque = read["average_torque"]
    assert torque.demand == pytest.approx(32.0210136)
    assert (torque.limit, torque.unit, torque.sign) == (80.0, "Nm", "≤")
    assert (torque.part, torque.limit_name, torque.relation) == (0.8, "T_A = T_N", "T_av ≤ T_A = T_N")


def test_a_motor_that_is_turned_along_has_torques_of_its_own(catalogue: Catalogue) -> None:
    """Its inertia counts along a motion alone, and nothing else that a notice says makes it count."""
    motor = {"peak_torque_Nm": 50, "rated_torque_Nm": 20}
    turned = {"duty_cycle": {"motion": CONTRACT}, "requirements": {"motor": motor | {"inertia_kgm2": 1e-4}}}
    plain = worked_example(requirements={"motor": motor})

    for application, peak, rated in ((turned, "T_in,max", "T_in,rms"), (plain, "T_max / (i · η)", "T_rms / (i · η)")):
        read = readings(application, "HPN-20A-5", catalogue)
        assert read["motor_peak_torque"].relation == f"{peak} ≤ T_mot"
        assert read["motor_rated_torque"].relation == f"{rated} ≤ T_mot,N"


@pytest.mark.parametrize("ratios", [[5], [4, 5]], ids=["all gears", "some gears"])
def test_a_torque_with_the_gears_no_load_torque_in_it_is_no_quotient_of_the_loads(
    ratios: list[int], supplemented: Supplement
) -> None:
    """Nor without a motion; of a gear that the supplement does not name it stays one."""
    catalogue = supplemented(gears="size,ratio,stages,no_load_torque_Nm,source\n20A,5,1,0.5,measured\n")
    motor = {"peak_torque_Nm": 50}
    question = worked_example(requirements={"motor": motor, "ratios": ratios, "sizes": ["20A"]})
    application = Application.model_validate(question)
    selection = select(application, catalogue)

    for gear in selection.candidates:
        symbols = [line.named.symbol for line in Account(selection, gear, application, catalogue).figures]
        relation = readings(question, gear.designation, catalogue)["motor_peak_torque"].relation
        own = gear.ratio == 5
        assert ("T_in,max" in symbols, "T_max/(i·η)" in symbols) == (own, not own)
        assert relation == f"{'T_in,max' if own else 'T_max / (i · η)'} ≤ T_mot"


def test_a_reading_compares_as_its_check_does(catalogue: Catalogue) -> None:
    """On gears at random: u times the limit, or the limit over its part, is passed exactly where the check fails."""
    chance = random.Random(18)
    seen: set[tuple[str, str]] = set()
    for _ in range(60):
        application = Application.model_validate(at_random(chance))
        selection = select(application, catalogue)
        candidate = chance.choice(selection.candidates)
        for code, read in readings_of(candidate, selection, application, catalogue).items():
            check = candidate.check(code)
            if check is None or not read.demand or not read.limit or read.kind == "range":
                continue
            assert read.bound is not None
            relative = read.bound / read.demand if read.kind == "minimum" else read.demand / read.bound
            if not math.isclose(relative, 1, rel_tol=1e-9):
                assert (relative < 1) == (check.status == "pass"), (code, read, check)
                seen.add((code, check.status))
    assert {(f"output_bearing_{of}", status) for of in ("load", "life") for status in ("pass", "fail")} <= seen


def test_without_application_or_catalogue_the_pure_numbers_stand(catalogue: Catalogue) -> None:
    application = Application.model_validate(cycle(phase(1.0, 100.0), output_load={"radial_N": 900.0}))
    selection = select(application, catalogue)
    read = readings_of(selection.candidates[0], selection, None, None)
    check = selection.candidates[0].check("output_bearing_load")
    assert check is not None
    assert (read["output_bearing_load"].demand, read["output_bearing_load"].unit) == (check.demand, "")


def test_a_figure_that_nothing_limits_is_unlimited_on_its_own_side(catalogue: Catalogue) -> None:
    """A stop below T_R may come any number of times (17.9); without a torque the life (17.10) has no end."""
    idle = readings(cycle(phase(0.0, 100.0), requirements={"life_h": 1e4}), "HPN-20A-5", catalogue)["life"]
    stops = readings(LIGHT_STOPS, "HPN-20A-5", catalogue)["momentary_peak_count"]
    ended = readings(worked_example(emergency_stop={"torque_Nm": 200, "count": 10}), "HPN-20A-5", catalogue)

    assert (idle.demand, idle.has_unlimited_demand, idle.has_unlimited_limit) == (None, True, False)
    assert (stops.limit, stops.has_unlimited_demand, stops.has_unlimited_limit) == (None, False, True)
    assert not ended["momentary_peak_count"].is_unlimited
