"""A fleet gets what `select` gives each of its axes, bit for bit: every form, format and engine."""

import random
from pathlib import Path
from typing import NamedTuple

import pytest

from hpn.application import Application, InputError
from hpn.catalogue import Catalogue, load_catalogue
from hpn.engine.candidates import Candidate, WorstCase
from hpn.engine.selection import select
from hpn.fleet.order import Order
from hpn.fleet.run import here, size_fleet, threads
from tests.build import Json
from tests.fleet.tables import FAULTS, Row, in_long_form, read, row_of, spoiled, write
from tests.property.draw import at_random

SUPPLEMENT = {
    "efficiency": "source,size,ratio,torque_Nm,efficiency\n"
    + "".join(f"s,20A,{ratio},{T},{eta}\n" for ratio in (4, 5, 10) for T, eta in ((1, 0.7), (40, 0.9), (90, 0.95))),
    "ratings": "size,ratio,repeated_peak_torque_Nm,rated_torque_Nm,momentary_peak_torque_Nm,source\n"
    "40A,5,752,400,1250,s\n40A,10,370,370,1250,s\n40A,20,700,,1250,\n",
    "sizes": "size,maximum_input_speed_rpm,average_input_speed_rpm,ambient_temperature_minimum_degC,"
    "ambient_temperature_maximum_degC,dynamic_radial_load_N,dynamic_axial_load_N,note,source\n"
    "40A,4000,3000,,,,,,s\n",
    "bearing_envelopes": "size,load_coefficient,axial_N,radial_N,source\n"
    "14A,1,0,900,s\n14A,1,300,880,s\n14A,1,950,0,s\n40A,1,0,8000,s\n40A,1,6000,0,s\n",
    "motors": "designation,maximum_speed_rpm,rated_speed_rpm,rated_torque_Nm,peak_torque_Nm,inertia_kgm2,source\n"
    "M 40,6000,3000,2.4,7.2,0.00015,s\nM 60,4500,,4,12,,s\n?,3000,1500,0.1,,0.1,s\n",
}
"""Curves, motors, and ratings of 40A, which suits some axes though its weight is not published."""

NOT_A_NUMBER = "torque_Nm: phase 1: must be a finite number"
UNEQUAL = "speed_rpm: has"
MODELS = ("linear", "iso281", "digitised")
MOTORS = ("M 40", "M 60", "?", "M 41")


def expected(axis: object, application: Json, catalogue: Catalogue) -> Row:
    """Answer of `select` as a row; where it refuses, the error alone."""
    try:
        selection = select(Application.model_validate(application), catalogue)
    except InputError as error:
        return {"axis": axis, "error": error.problems[0][1]}
    best = selection.candidates[0] if selection.selected else None
    second = selection.candidates[1] if best and len(selection.candidates) > 1 else None
    return {
        "axis": axis,
        "selected": selection.selected,
        "governing_check": best and best.governing_check,
        "utilisation": best and best.utilisation,
        "life_L10_h": best and best.life_L10_h,
        "shortest_life_h": best and best.shortest_life_h,
        "shortest_life_of": best and best.shortest_life_of,
        "motor_torque_limit_Nm": best and best.motor_torque_limit_Nm,
        "suitable": sum(candidate.status == "suitable" for candidate in selection.candidates),
        "runner_up": second.designation if second and second.rank == 2 else None,
        "average_torque_Nm": selection.duty.average_torque_Nm,
        **_over_tolerance(best),
        "error": None,
    }


def _over_tolerance(best: Candidate | None) -> Row:
    worst = best.worst if best is not None and isinstance(best.worst, WorstCase) else None
    return {
        "holds": worst and worst.status == "suitable",
        "worst_utilisation": worst and worst.utilisation,
        "worst_governing_check": worst and worst.governing_check,
    }


class Fleet(NamedTuple):
    """Rows of random axes, some of them spoiled, and what each has to get; an error by what it says."""

    rows: list[Row]
    wanted: dict[str, Row]
    catalogue: Catalogue


@pytest.fixture(scope="module")
def fleet(soak: bool, tmp_path_factory: pytest.TempPathFactory) -> Fleet:
    """Random axes under a supplement with curves."""
    folder = tmp_path_factory.mktemp("supplement")
    for stem, content in SUPPLEMENT.items():
        (folder / f"{stem}.csv").write_text(content)
    chance, fleet = random.Random(17), Fleet([], {}, load_catalogue(supplement=folder))
    for number in range(10_000 if soak else 600):
        axis, application = f"axis {number}", at_random(chance, MODELS)
        if number % 4 == 0:
            wishes = application.setdefault("requirements", {})
            wishes["motor"] = {"designation": chance.choice(MOTORS)}
            if chance.random() < 0.5:
                wishes["motor"]["inertia_ratio"], wishes["load_inertia_kgm2"] = chance.uniform(1, 10), 0.01
        row = row_of(axis, application)
        if chance.random() < 0.1:
            fault = chance.choice(list(FAULTS))
            row, fleet.wanted[axis] = spoiled(row, fault), {"axis": axis, "error": fault}
        else:
            fleet.wanted[axis] = expected(axis, application, fleet.catalogue)
        fleet.rows.append(row)
    return fleet


@pytest.mark.parametrize("form", ["list", "long"])
@pytest.mark.parametrize("suffix", [".parquet", ".arrow", ".csv"])
def test_every_axis_gets_what_select_answers(suffix: str, form: str, fleet: Fleet, tmp_path: Path) -> None:
    order = Order(tmp_path / f"in{suffix}", tmp_path / f"out{suffix}", rejected=tmp_path / "rejected.parquet")
    if form == "long":
        write(order.axes, in_long_form(fleet.rows, repeated=suffix == ".csv"))
    else:
        write(order.axes, fleet.rows)

    size_fleet(order, fleet.catalogue, threads(2) if suffix == ".parquet" else here)

    answers = read(order.answers)
    assert [row["axis"] for row in answers] == [row["axis"] for row in fleet.rows]
    for row in answers:
        target = fleet.wanted[row["axis"]]
        if target["error"]:
            is_short = form == "long" and target["error"] == UNEQUAL  # a list that is too short ends in nulls there
            text = "is required" if is_short else target["error"]
            if not (target["error"] == NOT_A_NUMBER and suffix != ".parquet" and suffix != ".arrow"):  # no text has NaN
                assert text in row["error"], row["axis"]
            assert all(value is None for name, value in row.items() if name not in ("axis", "error")), row
        else:
            assert row == target
    refused = {axis for axis, target in fleet.wanted.items() if target["error"]}
    assert {row["axis"] for row in read(tmp_path / "rejected.parquet")} == refused


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"requirements.motor.peak_torque_Nm": 5.0}, "either the motor or its figures"),
        ({"requirements.motor.designation": ""}, "must have at least 1 character"),
        ({"requirements.motor.designation": "M 41"}, "the catalogue has no M 41 (available: M 40, M 60, ?)"),
        (
            {"requirements.motor.designation": "M 60", "requirements.motor.inertia_ratio": 5.0},
            "needs the inertia of this motor",
        ),
        ({"requirements.load_inertia_kgm2": None, "requirements.motor.inertia_ratio": 5.0}, "needs a motion"),
    ],
)
def test_a_motor_by_name_is_refused_as_select_refuses_it(
    wrong: Row, message: str, fleet: Fleet, tmp_path: Path
) -> None:
    row = row_of("a", at_random(random.Random(3))) | {"requirements.load_inertia_kgm2": 0.01}
    row = {name: value for name, value in row.items() if not name.startswith("requirements.motor.")}
    named = row | {"requirements.motor.designation": "M 40"}
    order = Order(write(tmp_path / "in.parquet", [named, named | wrong | {"axis": "b"}]), tmp_path / "out.parquet")

    size_fleet(order, fleet.catalogue)

    sound, refused = read(order.answers)
    assert sound["error"] is None
    assert message in refused["error"]
