"""Fewest kinds for the axes of a machine, against `select` for each axis alone and weights added by hand."""

from typing import Any

import msgspec
import pytest

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.documents.kinds import Sought, kinds_of
from hpn.engine.selection import select


def _application(torque_Nm: float, speed_rpm: float, **requirements: Any) -> Application:
    phase = {"torque_Nm": torque_Nm, "speed_rpm": speed_rpm, "duration_s": 1.0}
    return Application.model_validate({"duty_cycle": {"phases": [phase]}, "requirements": requirements})


def _machine(catalogue: Catalogue) -> list[Sought]:
    question = [
        _application(4, 300),
        _application(25, 120),
        _application(60, 80, ratios=[5, 7]),
        _application(90, 60, sizes=["20A", "32A"]),
        _application(4, 200, weight_kg=1),
    ]
    return [
        Sought(number, number, application, select(application, catalogue).selected)
        for number, application in enumerate(question, 1)
    ]


def test_every_step_serves_every_axis_as_select_says(catalogue: Catalogue) -> None:
    machine = _machine(catalogue)
    kinds = kinds_of(machine, catalogue)
    assert kinds.kinds[0].count == len({axis.designation for axis in machine})
    assert kinds.kinds[-1].count == kinds.least < kinds.kinds[0].count
    for step in kinds.kinds:
        changed = {change.axis: change for change in step.changes}
        weight_kg = 0.0
        for axis in machine:
            gear = changed[axis.number].gear_to if axis.number in changed else axis.designation
            answer = next(one for one in select(axis.application, catalogue).candidates if one.designation == gear)
            assert answer.status == "suitable"
            assert gear in step.gears
            weight = catalogue.by_designation[answer.designation].weight_kg
            assert weight is not None
            weight_kg += weight * axis.quantity
            if axis.number in changed:
                # Sums of the same engine in another order: 1e-12 of them.
                assert changed[axis.number].utilisation == pytest.approx(answer.utilisation, rel=1e-12)
        assert step.weight_kg == pytest.approx(weight_kg, rel=1e-12)
        assert step.proven


def test_a_change_says_what_the_axis_gives_up(catalogue: Catalogue) -> None:
    change = kinds_of(_machine(catalogue), catalogue).kinds[-1].changes[0]
    sent = msgspec.to_builtins(change)
    assert {"axis", "from", "to", "weight_kg", "utilisation"} == set(sent)
    machine = {axis.number: axis for axis in _machine(catalogue)}
    before, after = (catalogue.by_designation[sent[name]].weight_kg or 0 for name in ("from", "to"))
    assert sent["weight_kg"] == pytest.approx((after - before) * machine[sent["axis"]].quantity, rel=1e-12)


def test_an_axis_that_no_gear_suits_is_left_out(catalogue: Catalogue) -> None:
    machine = [*_machine(catalogue), Sought(6, 1, _application(100_000, 10), None)]
    kinds, without = kinds_of(machine, catalogue), kinds_of(machine[:-1], catalogue)
    assert kinds == without


def test_an_axis_with_one_gear_forces_it(catalogue: Catalogue) -> None:
    forced = Sought(9, 1, _application(25, 120, sizes=["20A"], ratios=[10]), "HPN-20A-10")
    kinds = kinds_of([*_machine(catalogue), forced], catalogue)
    assert [(only.gear, only.axes) for only in kinds.forced if 9 in only.axes] == [("HPN-20A-10", (9,))]
    assert all("HPN-20A-10" in step.gears for step in kinds.kinds)


def test_at_most_so_many_kinds(catalogue: Catalogue) -> None:
    kinds = kinds_of(_machine(catalogue), catalogue)
    some = kinds_of(_machine(catalogue), catalogue, most=kinds.least)
    assert [step.count for step in some.kinds] == [kinds.least]
