"""The order of candidates against Python's own sorting, with many ties and figures that are not published."""

import math
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from numpy.typing import NDArray

from hpn.engine.evaluation import RANKED_BY, SUITABLE, UNRATED, UNSUITABLE, Evaluation

GEARS = 7
RATIO = np.array([3.0, 4, 5, 3, 4, 5, 5])


def drawn(chance: np.random.Generator, *shape: int) -> NDArray[np.float64]:
    """Few different figures, some of them not published."""
    return np.where(chance.random(shape) < 0.2, np.nan, chance.integers(1, 4, shape) / 4)


def evaluation_of(chance: np.random.Generator, rank_by: NDArray[Any]) -> Evaluation:
    """Gears of drawn figures under applications with drawn verdicts."""
    axes = len(rank_by)
    verdict = chance.choice([SUITABLE, UNSUITABLE, UNRATED], (axes, GEARS), p=[0.7, 0.2, 0.1]).astype(np.int8)
    utilisation = np.where(verdict == UNRATED, np.nan, chance.integers(1, 4, (axes, GEARS)) / 4)
    gears = SimpleNamespace(
        ratio=RATIO,
        weight_kg=drawn(chance, GEARS),
        length_max_mm=drawn(chance, GEARS),
        torsional_stiffness_Nm_per_rad=drawn(chance, GEARS),
    )
    ranked = ("life_L10_h", "shortest_life_h", "motor_peak_torque_Nm", "natural_frequency_Hz", "position_error_arcmin")
    figures = SimpleNamespace(**{name: drawn(chance, axes, GEARS) for name in ranked})
    case = SimpleNamespace(gears=gears, figures=figures, inputs=SimpleNamespace(rank_by=rank_by))
    none = cast(Any, None)
    return Evaluation(cast(Any, case), none, none, (), none, none, none, verdict, utilisation)


def last_if_missing(value: float) -> tuple[bool, float]:
    """Key that sorts what is not published behind every number."""
    return (True, 0.0) if math.isnan(value) else (False, value)


def sorted_by_hand(evaluation: Evaluation, axis: int, rank_by: str) -> list[int]:
    """Places of the gears of an axis, by the words of the contract."""
    gears, figures = evaluation.case.gears, evaluation.case.figures
    wishes = {
        "weight": gears.weight_kg,
        "utilisation": evaluation.utilisation[axis],
        "length": gears.length_max_mm,
        "motor_torque": figures.motor_peak_torque_Nm[axis],
        "life": -figures.shortest_life_h[axis],
        "natural_frequency": -figures.natural_frequency_Hz[axis],
        "position_error": figures.position_error_arcmin[axis],
        "stiffness": -gears.torsional_stiffness_Nm_per_rad,
    }

    def key(place: int) -> tuple[object, ...]:
        verdict, used = evaluation.verdict[axis, place], evaluation.utilisation[axis, place]
        ties = [gears.weight_kg[place], used, -figures.life_L10_h[axis, place], gears.ratio[place]]
        first = {SUITABLE: wishes[rank_by][place], UNSUITABLE: used, UNRATED: place}[verdict]
        return (verdict, *map(last_if_missing, (first, *ties)), place)

    return sorted(range(GEARS), key=key)


@pytest.mark.parametrize(("seed", "axes"), [(seed, 1 if seed % 2 else 300) for seed in range(20)])
@pytest.mark.parametrize("wishes", [*RANKED_BY, "mixed"])
def test_gears_stand_as_sorted_by_hand_and_the_foremost_is_the_first(wishes: str, seed: int, axes: int) -> None:
    chance = np.random.default_rng(seed)
    rank_by = np.array(chance.choice([*RANKED_BY], (axes, 1)) if wishes == "mixed" else [[wishes]] * axes)
    evaluation = evaluation_of(chance, rank_by)

    by_hand = [sorted_by_hand(evaluation, axis, str(rank_by[axis, 0])) for axis in range(axes)]
    suits = evaluation.verdict == SUITABLE
    some = suits & (chance.random(suits.shape) < 0.6)

    assert evaluation.order.tolist() == by_hand
    for among in (suits, some):
        first = [next((place for place in places if among[axis, place]), None) for axis, places in enumerate(by_hand)]
        values = [
            place if any_ else None for place, any_ in zip(evaluation.foremost(among), among.any(-1), strict=True)
        ]
        assert values == first
