"""Gears side by side: wind-up, the better figure of a row, and best compromises."""

import math

import pytest

from hpn.account.account import Account
from hpn.account.published import ranged
from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.candidates import Candidate
from hpn.engine.selection import Selection, select
from hpn.explain.comparison import Row, groups_of, undominated
from tests.build import Json, cycle, phase, worked_example
from tests.conftest import Supplement


def selected(application: Json, catalogue: Catalogue) -> Selection:
    return select(Application.model_validate(application), catalogue)


def candidate(selection: Selection, designation: str) -> Candidate:
    result = selection.candidate(designation)
    assert result is not None
    return result


def compared(application: Json, catalogue: Catalogue, *designations: str) -> dict[str, Row]:
    """Figures of some gears side by side, by their places."""
    selection = selected(application, catalogue)
    question = Application.model_validate(application)
    accounts = [Account(selection, candidate(selection, name), question, catalogue) for name in designations]
    rows = [row for group in groups_of(accounts) for row in group.rows]
    return {row.head.code: row for row in rows if isinstance(row, Row)}


def values(row: Row) -> list[object]:
    """Values of a row."""
    return [line and line.value for line in row.lines]


def test_wind_up_is_that_of_the_drive_and_the_report(catalogue: Catalogue) -> None:
    """T_max over K3 in minutes of arc: 40 Nm over 26000 Nm/rad and over 143000 Nm/rad (table 15.2)."""
    rows = compared(worked_example(), catalogue, "HPN-20A-5", "HPN-40A-5")
    smaller, larger = values(rows["candidate.wind_up_arcmin"])
    assert smaller == pytest.approx(40 / 26000 * 180 / math.pi * 60, rel=1e-12)
    assert larger == pytest.approx(40 / 143000 * 180 / math.pi * 60, rel=1e-12)


def test_a_gear_is_better_than_the_reference_where_its_figure_is_the_smaller_or_the_larger_one(
    catalogue: Catalogue,
) -> None:
    """HPN-14A-5 is smaller and has one stage, HPN-32A-50 is larger and has two: size or stage makes one better."""
    loaded = worked_example(output_load={"radial_N": 100.0}, requirements={"load_inertia_kgm2": 0.2, "efficiency": 0.9})

    def better(reference: str, other: str) -> set[str]:
        rows = compared(loaded, catalogue, reference, other)
        return {code for code, row in rows.items() if row.standings == ("reference", "better")}

    lighter = {"backlash_arcmin", "transmission_accuracy_arcmin", "weight_kg", "length"}
    figures = {
        *("life_L10_h", "momentary_peak_count", "bearing_life_L50_h", "bearing_life_L10_h", "shortest_life_h"),
        *("motor_peak_torque_Nm", "motor_rated_torque_Nm"),
        *("wind_up_arcmin", "natural_frequency_Hz", "position_error_arcmin"),
    }
    rated = {"rated_torque_Nm", "repeated_peak_torque_Nm", "momentary_peak_torque_Nm", "torsional_stiffness_Nm_per_rad"}
    assert better("HPN-32A-50", "HPN-14A-5") == {f"gear.{name}" for name in lighter}
    assert better("HPN-14A-5", "HPN-32A-50") == {
        *(f"candidate.{name}" for name in figures),
        *(f"gear.{name}" for name in rated),
    }


def test_rows_in_which_all_are_alike_stand_at_the_foot_and_no_others(catalogue: Catalogue) -> None:
    """HPN-20A-5 and HPN-20A-7: one housing and one set of speeds (table 12.1), other ratings and figures."""
    selection, case = (
        selected(worked_example(requirements={}), catalogue),
        Application.model_validate(worked_example(requirements={})),
    )
    accounts = [Account(selection, candidate(selection, f"HPN-20A-{i}"), case, catalogue) for i in (5, 7)]
    *others, foot = groups_of(accounts)

    assert {row.standings for row in foot.rows} == {("reference", "alike")}
    assert all(row.standings != ("reference", "alike") for group in others for row in group.rows)
    assert {"gear.weight_kg", "gear.length"} <= {row.head.code for row in foot.rows}
    assert "candidate.life_L10_h" not in {row.head.code for row in foot.rows}


def test_each_check_and_each_published_figure_stands_in_the_comparison_once(catalogue: Catalogue) -> None:
    selection, case = selected(worked_example(), catalogue), Application.model_validate(worked_example())
    accounts = [Account(selection, candidate(selection, f"HPN-{size}-5"), case, catalogue) for size in ("14A", "20A")]
    codes = [row.head.code for group in groups_of(accounts) for row in group.rows]
    known = [line.code for line in ranged(accounts[0].published) if line.value is not None]

    assert len(codes) == len(set(codes))
    assert {*selection.check_definitions, *known} <= set(codes)


def test_motor_torque_without_an_efficiency_is_said_to_be_a_lower_bound(catalogue: Catalogue) -> None:
    def is_lower_bound(**requirements: float) -> bool:
        rows = compared(worked_example(requirements=requirements), catalogue, "HPN-20A-5", "HPN-14A-5")
        return rows["candidate.motor_peak_torque_Nm"].is_lower_bound

    assert is_lower_bound()
    assert not is_lower_bound(efficiency=0.9)


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
    question = cycle(phase(100, 10), emergency_stop={"torque_Nm": 160}, requirements={"backlash_arcmin": 4})
    selection = selected(question, catalogue)
    gear = candidate(selection, "HPN-40A-5")

    assert gear.status == "unsuitable"
    assert not gear.is_unlimited("life_L10_h")
    assert not gear.is_unlimited("momentary_peak_count")
    rows = compared(question, catalogue, "HPN-40A-5", "HPN-20A-5")
    assert values(rows["candidate.life_L10_h"])[0] is None
    stops = rows["candidate.momentary_peak_count"]
    assert values(stops)[0] is None and stops.standings == ("reference", "")


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
    question = cycle(phase(10, 100), output_load={"radial_N": 500, "model": "digitised"})
    life = compared(question, filled, "HPN-20A-5", "HPN-14A-5")["candidate.bearing_life_L50_h"]

    assert values(life) == [candidate(selected(question, filled), "HPN-20A-5").bearing_life_L50_h, None]
    assert life.standings == ("reference", "")


def test_a_bearing_under_no_load_is_unlimited(catalogue: Catalogue) -> None:
    gear = candidate(selected(cycle(phase(10, 100), output_load={"radial_N": 0}), catalogue), "HPN-20A-5")

    assert gear.is_unlimited("bearing_life_L50_h")
