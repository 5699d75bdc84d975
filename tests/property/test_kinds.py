"""Fewest kinds of gears against brute force: every set of gears of every machine, weighed axis by axis."""

from itertools import combinations

import numpy as np
import pytest

from hpn.engine.kinds import NO_GEAR, GearChoices, fewest_kinds

MACHINES = 1_000


def _machine(seed: int) -> GearChoices:
    """A machine of up to 12 axes and 9 gears, of equal weights among others, as its axes have it."""
    draw = np.random.default_rng(seed)
    count, gears = int(draw.integers(1, 13)), int(draw.integers(1, 10))
    weight = draw.choice([1.0, 1.0, 2.5, 4.0, 4.0, 7.5, 12.0], gears)
    weight[draw.random(gears) < 0.1] = np.nan
    suits = draw.random((count, gears)) < draw.uniform(0.1, 0.8)
    own = [draw.choice(np.flatnonzero(row)) if row.any() and draw.random() < 0.9 else NO_GEAR for row in suits]
    return GearChoices(suits, draw.random((count, gears)), weight, draw.integers(1, 6, count), np.array(own, np.intp))


def _lightest_by_hand(machine: GearChoices, count: int) -> float:
    """Least weight of `count` gears or fewer in kg, by trying every set; infinite where none serves every axis."""
    gears = [gear for gear in range(len(machine.weight_kg)) if not np.isnan(machine.weight_kg[gear])]
    rows = [[gear for gear in gears if machine.suits[axis, gear]] for axis in range(len(machine.suits))]
    least = np.inf
    for kinds in combinations(gears, min(count, len(gears))):
        total = 0.0
        for axis, row in enumerate(rows):
            if row:
                weights = [machine.weight_kg[gear] for gear in row if gear in kinds]
                total += min(weights, default=np.inf) * machine.quantity[axis]
        least = min(least, total)
    return least


def test_every_step_is_the_lightest_of_all_sets() -> None:
    """Brute force over all subsets; 1e-9 kg is the rounding of sums of a dozen weights."""
    for seed in range(MACHINES):
        machine = _machine(seed)
        kinds = fewest_kinds(machine, seconds=60)
        for step in kinds.steps:
            assert step.is_proven
            assert step.weight_kg == pytest.approx(_lightest_by_hand(machine, len(step.gears)), abs=1e-9), seed
            served = machine.suits[:, np.isfinite(machine.weight_kg)].any(axis=1)
            assert ((step.gear_of != NO_GEAR) == served).all(), seed
            assert set(step.gear_of[served].tolist()) == set(step.gears), seed
            assert machine.suits[np.flatnonzero(served), step.gear_of[served]].all(), seed
        if kinds.least:
            assert np.isfinite(_lightest_by_hand(machine, kinds.least)), seed
            assert kinds.least == 1 or np.isinf(_lightest_by_hand(machine, kinds.least - 1)), seed
            assert kinds.steps[-1].gears and len(kinds.steps[-1].gears) == kinds.least, seed


def test_a_list_that_is_lightest_stays_as_it_is() -> None:
    """Each axis has the only lightest gear: with as many kinds nothing changes."""
    weight = np.array([1.0, 1.0, 3.0])
    suits = np.array([[True, True, True], [True, True, True], [False, False, True]])
    machine = GearChoices(suits, np.full((3, 3), 0.5), weight, np.array([1, 1, 2]), np.array([1, 0, 2]))
    first, *_ = fewest_kinds(machine).steps
    assert first.gear_of.tolist() == [1, 0, 2]
    assert [len(step.gears) for step in fewest_kinds(machine).steps] == [3, 2, 1]


def test_an_axis_that_one_gear_suits_forces_it() -> None:
    machine = GearChoices(
        np.array([[True, True], [False, True], [False, False]]),
        np.full((3, 2), 0.5),
        np.array([1.0, 2.0]),
        np.array([1, 1, 1]),
        np.array([0, 1, NO_GEAR]),
    )
    kinds = fewest_kinds(machine)
    assert kinds.forced == {1: (1,)}
    assert kinds.least == 1
    assert kinds.steps[-1].gear_of.tolist() == [1, 1, NO_GEAR]


def test_at_most_so_many_kinds_are_tried() -> None:
    kinds = fewest_kinds(_machine(5), most=2)
    assert all(len(step.gears) <= 2 for step in kinds.steps)


def test_a_machine_that_no_gear_serves_has_no_kinds() -> None:
    machine = GearChoices(
        np.zeros((2, 3), bool), np.zeros((2, 3)), np.ones(3), np.ones(2, np.int64), np.array([NO_GEAR] * 2)
    )
    assert fewest_kinds(machine).steps == ()


def test_without_time_a_set_is_there_but_not_proven() -> None:
    draw = np.random.default_rng(1)
    suits = draw.random((400, 40)) < 0.2
    suits[:, 39] = True
    own = suits.argmax(axis=1)
    machine = GearChoices(suits, draw.random((400, 40)), draw.uniform(1, 9, 40), np.ones(400, np.int64), own)
    kinds = fewest_kinds(machine, seconds=0)
    assert kinds.steps
    assert not any(step.is_proven for step in kinds.steps)
    assert all((step.gear_of != NO_GEAR).all() for step in kinds.steps)
