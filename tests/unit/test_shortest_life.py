"""The shortest life of a candidate: gear or output bearing, on the basis on which that is judged."""

import pytest

from hpn.account.readings import shortest_life
from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.kept import decode
from hpn.engine.selection import encode, select
from tests.build import Json, answer, candidate, cycle, phase


def loaded(radial_N: float, **conditions: object) -> Json:
    """An axis at 40 Nm with a load on its shaft."""
    return cycle(phase(40.0, 200.0), output_load={"radial_N": radial_N, **conditions})


@pytest.mark.parametrize(
    ("question", "of"),
    [
        (cycle(phase(40.0, 200.0)), "gear_L10"),
        (loaded(10.0), "gear_L10"),
        (loaded(1500.0), "bearing_L50"),
        (loaded(1500.0, life_h=4000.0, life_basis="L10"), "bearing_L10"),
    ],
)
def test_the_smaller_life_stands_with_its_basis(question: Json, of: str, catalogue: Catalogue) -> None:
    """The lives themselves are compared with the contract worked out in `tests/property/test_contract.py`."""
    gear = candidate(answer(question, catalogue), "HPN-20A-5")

    fields = {"gear_L10": "life_L10_h", "bearing_L50": "bearing_life_L50_h", "bearing_L10": "bearing_life_L10_h"}
    judged = [gear["life_L10_h"], *([gear[fields[of]]] if of != "gear_L10" else [])]
    assert gear["shortest_life_of"] == of
    assert gear["shortest_life_h"] == gear[fields[of]] == min(judged)


def test_a_life_that_is_not_rated_leaves_none_to_name(catalogue: Catalogue) -> None:
    """HPN-40A has no ratings in this catalogue, and HPN-20A's bearing can't be judged without its shaft's centre."""
    unrated = candidate(answer(loaded(10.0), catalogue), "HPN-40A-5")
    off_centre = candidate(answer(loaded(10.0, radial_position_mm=45.0), catalogue), "HPN-20A-5")

    for gear in (unrated, off_centre):
        assert (gear["shortest_life_h"], gear["shortest_life_of"]) == (None, None)
    assert off_centre["life_L10_h"] is not None


def test_two_unlimited_lives_are_unlimited_and_not_unknown(catalogue: Catalogue) -> None:
    selection = select(Application.model_validate(cycle(phase(0.0, 200.0), output_load={"radial_N": 0.0})), catalogue)
    gear = selection.candidate("HPN-20A-5")

    assert gear is not None
    assert (gear.shortest_life_h, gear.shortest_life_of) == (None, None)
    life = shortest_life(gear)
    assert life is not None
    assert life.life_h is None


def test_ranking_by_life_goes_by_the_bearing_where_that_wears_out_first(catalogue: Catalogue) -> None:
    """Under a radial load larger sizes outlive the smaller one whose gear life is longer at a lower ratio."""
    reply = answer(loaded(1500.0) | {"rank_by": "life"}, catalogue)
    lives = [entry["shortest_life_h"] for entry in reply["candidates"] if entry["status"] == "suitable"]

    assert lives == sorted(lives, reverse=True)
    assert any(entry["shortest_life_of"] == "bearing_L50" for entry in reply["candidates"])


def test_a_reply_that_was_kept_before_has_no_shortest_life(catalogue: Catalogue) -> None:
    record = encode(select(Application.model_validate(loaded(1500.0)), catalogue))
    before = decode(record.replace(b'"shortest_life_h"', b'"x"').replace(b'"shortest_life_of"', b'"y"'))

    assert shortest_life(before.candidates[0]) is None
