"""Gears side by side: torsion, the better figure of a row, and best compromises."""

import math

import pytest

from hpn import equations
from hpn.catalogue import Catalogue
from hpn.comparison import Column, groups_of, torsion_of, undominated
from tests.build import Json, answer, candidate, worked_example


def columns(reply: Json, catalogue: Catalogue, *designations: str) -> list[Column]:
    return [Column(candidate(reply, name), catalogue.by_designation[name]) for name in designations]


def test_torsion_follows_the_glossary(catalogue: Catalogue) -> None:
    """(40 Nm - 0.15 · 80 Nm) / 26000 Nm/rad, in minutes of arc."""
    torsion = torsion_of(catalogue.by_designation["HPN-20A-5"], 40.0)
    assert torsion == pytest.approx(28 / 26000 * 180 / math.pi * 60, rel=1e-12)


def test_torsion_below_its_reference_torque_is_nothing(catalogue: Catalogue) -> None:
    assert torsion_of(catalogue.by_designation["HPN-20A-5"], 12.0) == 0
    assert torsion_of(catalogue.by_designation["HPN-20A-5"], 3.0) == 0


def test_torsion_of_what_is_not_published_is_not_made_up(catalogue: Catalogue) -> None:
    assert torsion_of(catalogue.by_designation["HPN-40A-5"], 40.0) is None
    figures = {"rated_torque_Nm": math.nan, "torsional_stiffness_Nm_per_rad": 143e3}
    assert math.isnan(equations.torsion(maximum_torque_Nm=40.0, **figures))


def test_the_better_figure_of_a_row_is_marked_and_equal_ones_are_not(catalogue: Catalogue) -> None:
    reply = answer(worked_example(), catalogue)
    compared = columns(reply, catalogue, "HPN-20A-5", "HPN-14A-5", "HPN-32A-5")
    groups = groups_of(compared, 40.0, {"average_torque": "Average torque"})
    rows = {row.code: row for group in groups for row in group.rows}

    assert rows["weight"].values == (2.6, 0.95, 6.5)
    assert rows["weight"].best == {1}
    assert rows["stiffness"].best == {2}
    assert rows["average_torque"].best == {2}
    assert rows["backlash"].best == frozenset() and not rows["backlash"].differs
    assert rows["stops"].values[2] == math.inf and rows["stops"].best == {2}


def test_best_compromises_are_those_that_no_other_suitable_gear_outdoes(catalogue: Catalogue) -> None:
    """Against a comparison of every pair, one figure at a time."""
    reply = answer(worked_example(), catalogue)
    suitable = [entry for entry in reply["candidates"] if entry["status"] == "suitable"]

    def costs(entry: Json) -> tuple[float, ...]:
        gear = catalogue.by_designation[entry["designation"]]
        assert gear.weight_kg and gear.torsional_stiffness_Nm_per_rad and gear.length_max_mm
        stiffness = -gear.torsional_stiffness_Nm_per_rad
        return gear.weight_kg, entry["utilisation"], stiffness, gear.length_max_mm, entry["motor_peak_torque_Nm"]

    expected = {
        entry["designation"]
        for entry in suitable
        if not any(
            all(a <= b for a, b in zip(costs(other), costs(entry), strict=True)) and costs(other) != costs(entry)
            for other in suitable
        )
    }
    assert undominated(reply["candidates"], catalogue) == expected
    assert 0 < len(expected) < len(suitable)
