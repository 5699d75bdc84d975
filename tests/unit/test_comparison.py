"""Gears side by side: wind-up, the better figure of a row, and best compromises."""

import math

import pytest

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.candidates import Candidate
from hpn.engine.selection import Selection, select
from hpn.explain.comparison import Column, Row, groups_of, undominated
from tests.build import Json, cycle, phase, worked_example
from tests.conftest import Supplement


def selected(application: Json, catalogue: Catalogue) -> Selection:
    return select(Application.model_validate(application), catalogue)


def candidate(selection: Selection, designation: str) -> Candidate:
    found = selection.candidate(designation)
    assert found is not None
    return found


def columns(selection: Selection, catalogue: Catalogue, *designations: str) -> list[Column]:
    return [Column(candidate(selection, name), catalogue.by_designation[name]) for name in designations]


def rows(compared: list[Column], maximum_torque_Nm: float) -> dict[str, Row]:
    return {row.code: row for group in groups_of(compared, maximum_torque_Nm, {}) for row in group.rows}


def test_wind_up_is_that_of_the_drive_and_the_report(catalogue: Catalogue) -> None:
    """T_max over K3 in minutes of arc: 40 Nm over 26000 Nm/rad and over 143000 Nm/rad (table 15.2)."""
    compared = columns(selected(worked_example(), catalogue), catalogue, "HPN-20A-5", "HPN-40A-5")
    smaller, larger = rows(compared, 40.0)["wind_up"].values
    assert smaller == pytest.approx(40 / 26000 * 180 / math.pi * 60, rel=1e-12)
    assert larger == pytest.approx(40 / 143000 * 180 / math.pi * 60, rel=1e-12)


def test_the_best_gear_of_each_row_is_the_one_with_the_smaller_or_the_larger_figure(catalogue: Catalogue) -> None:
    """HPN-14A-5 is smaller and has one stage, HPN-32A-50 is larger and has two: size or stage makes one better."""
    loaded = worked_example(output_load={"radial_N": 100.0}, requirements={"load_inertia_kgm2": 0.2, "efficiency": 0.9})
    compared = columns(selected(loaded, catalogue), catalogue, "HPN-14A-5", "HPN-32A-50")
    best = {code: row.best for code, row in rows(compared, 40.0).items() if row.best}
    assert {code for code in best if best[code] == {0}} == {"backlash", "accuracy", "weight", "length", "longest"}
    assert {code for code in best if best[code] == {1}} == {
        *("life", "stops", "bearing_life", "motor_torque", "wind_up", "stiffness", "frequency", "position_error"),
        *("rated_torque_Nm", "repeated_peak_torque_Nm", "momentary_peak_torque_Nm"),
    }


def test_motor_torque_without_an_efficiency_is_said_to_be_a_lower_bound(catalogue: Catalogue) -> None:
    def title(**requirements: float) -> str:
        selection = selected(worked_example(requirements=requirements), catalogue)
        return rows(columns(selection, catalogue, "HPN-20A-5", "HPN-14A-5"), 40.0)["motor_torque"].title

    assert title() == "Peak torque at the motor, a lower bound where η is 1"
    assert title(efficiency=0.9) == "Peak torque at the motor"


def test_best_compromises_are_those_that_no_other_suitable_gear_outdoes(catalogue: Catalogue) -> None:
    """Against a comparison of every pair, one figure at a time."""
    selection = selected(worked_example(), catalogue)
    suitable = [entry for entry in selection.candidates if entry.status == "suitable"]

    def costs(entry: Candidate) -> tuple[float, ...]:
        gear = catalogue.by_designation[entry.designation]
        assert gear.weight_kg and gear.torsional_stiffness_Nm_per_rad and gear.length_max_mm
        stiffness = -gear.torsional_stiffness_Nm_per_rad
        assert entry.utilisation is not None and entry.motor_peak_torque_Nm is not None
        return gear.weight_kg, entry.utilisation, stiffness, gear.length_max_mm, entry.motor_peak_torque_Nm

    expected = {
        entry.designation
        for entry in suitable
        if not any(
            all(a <= b for a, b in zip(costs(other), costs(entry), strict=True)) and costs(other) != costs(entry)
            for other in suitable
        )
    }
    assert undominated(selection.candidates, catalogue) == expected
    assert 0 < len(expected) < len(suitable)


def test_an_unrated_gear_is_not_unlimited_though_it_fails_a_property_check(catalogue: Catalogue) -> None:
    """HPN-40A has a published backlash above 4 arcmin and no ratings: unsuitable, not unrated."""
    asked = cycle(phase(100, 10), emergency_stop={"torque_Nm": 160}, requirements={"backlash_arcmin": 4})
    selection = selected(asked, catalogue)
    gear = candidate(selection, "HPN-40A-5")

    assert gear.status == "unsuitable"
    assert not gear.is_unlimited("life_L10_h")
    assert not gear.is_unlimited("momentary_peak_count")
    values = rows(columns(selection, catalogue, "HPN-40A-5", "HPN-20A-5"), 100.0)
    assert values["life"].values[0] is None
    assert values["stops"].values[0] is None and values["stops"].best == frozenset()


def test_each_figure_is_unlimited_by_its_own_rating(supplemented: Supplement) -> None:
    """T_R without T_N: the stops are known to be free, the life is not known."""
    titles = "size,ratio,repeated_peak_torque_Nm,rated_torque_Nm,momentary_peak_torque_Nm,source"
    filled = supplemented(ratings=f"{titles}\n40A,5,752,,,page 12\n")
    gear = candidate(selected(cycle(phase(0, 10), emergency_stop={"torque_Nm": 700}), filled), "HPN-40A-5")

    assert gear.is_unlimited("momentary_peak_count")
    assert not gear.is_unlimited("life_L10_h")


def test_without_a_torque_the_life_is_unlimited_and_without_a_stop_there_is_no_count(catalogue: Catalogue) -> None:
    gear = candidate(selected(cycle(phase(0, 10)), catalogue), "HPN-20A-5")

    assert gear.is_unlimited("life_L10_h")
    assert not gear.is_unlimited("momentary_peak_count")


def test_a_bearing_without_points_of_its_curve_has_no_life_to_compare(supplemented: Supplement) -> None:
    points = "size,load_coefficient,axial_N,radial_N,source\n20A,1,2200,0,p\n20A,1,1500,900,p\n20A,1,0,1800,p\n"
    filled = supplemented(bearing_envelopes=points)
    selection = selected(cycle(phase(10, 100), output_load={"radial_N": 500, "model": "digitised"}), filled)

    life = rows(columns(selection, filled, "HPN-20A-5", "HPN-14A-5"), 10.0)["bearing_life"]

    assert life.values == (candidate(selection, "HPN-20A-5").bearing_life_L50_h, None)
    assert life.best == frozenset()


def test_a_bearing_under_no_load_is_unlimited(catalogue: Catalogue) -> None:
    gear = candidate(selected(cycle(phase(10, 100), output_load={"radial_N": 0}), catalogue), "HPN-20A-5")

    assert gear.is_unlimited("bearing_life_L50_h")
