"""A gear that lacks an input alone: it is not rated, says which input, and stands before those that fail."""

import pytest

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.candidates import reason_of
from hpn.engine.selection import select
from tests.build import Json, answer, candidate, check, worked_example


def off_centre(radial_N: float, **load: float) -> Json:
    """The worked example with a radial load 45 mm from the shoulder."""
    return worked_example(output_load={"radial_N": radial_N, "radial_position_mm": 45.0, **load})


def test_gears_that_lack_the_shafts_centre_alone_stand_first_and_name_it(catalogue: Catalogue) -> None:
    """Before, the answer was that no gear is suitable, with one that fails its T_k as the nearest."""
    reply = answer(off_centre(1201.7), catalogue)
    lacking = [gear for gear in reply["candidates"] if gear["missing"]]

    assert reply["selected"] is None
    assert [gear["designation"] for gear in reply["candidates"][: len(lacking)]] == [g["designation"] for g in lacking]
    assert {gear["size"] for gear in lacking} == {"20A", "32A"}
    for gear in lacking:
        assert (gear["status"], gear["utilisation"]) == ("unrated", None)
        assert gear["missing"] == ["output_load.shaft_centre_mm"]
        assert "x_c" in gear["reason"]
    used = [
        max(value for one in gear["checks"] for value in (one["utilisation"], one["at_least"]) if value is not None)
        for gear in lacking
    ]
    assert used == sorted(used)


def test_a_check_that_is_not_rated_says_how_much_it_is_at_least(catalogue: Catalogue) -> None:
    """By hand: 1201.7 N of 1800 N on HPN-20A (table 12.1), at the centre, where no lever adds to it."""
    load = check(answer(off_centre(1201.7), catalogue), "HPN-20A-5", "output_bearing_load")

    assert (load["status"], load["utilisation"], load["demand"]) == ("not_rated", None, None)
    assert load["at_least"] == pytest.approx(1201.7 / 1800, rel=1e-12)


def test_a_load_that_no_centre_can_carry_fails_with_its_lower_bound(catalogue: Catalogue) -> None:
    """5000 N are above the 1800 N of HPN-20A wherever they act; the reason says that it is a lower bound."""
    question = off_centre(5000.0)
    reply = answer(question, catalogue)
    gear, load = candidate(reply, "HPN-20A-5"), check(reply, "HPN-20A-5", "output_bearing_load")

    assert gear["status"] == "unsuitable"
    assert load["status"] == "fail"
    assert load["utilisation"] == pytest.approx(5000 / 1800, rel=1e-12)
    assert load["at_least"] is None
    assert "or more, wherever the shaft’s centre is" in gear["reason"]
    typed = select(Application.model_validate(question), catalogue).candidate("HPN-20A-5")
    assert typed is not None
    assert reason_of(typed, 1.0).template.startswith("{check} is at {percent} of its limit or more")


def test_your_own_u_counts_for_the_lower_bound_too(catalogue: Catalogue) -> None:
    gear = candidate(answer(off_centre(1201.7) | {"requirements": {"utilisation": 0.6}}, catalogue), "HPN-32A-5")
    least = check(
        answer(off_centre(1201.7) | {"requirements": {"utilisation": 0.6}}, catalogue),
        "HPN-20A-5",
        "output_bearing_load",
    )

    assert least["status"] == "fail"
    assert gear["missing"] == ["output_load.shaft_centre_mm"]


def test_with_the_centre_the_gear_is_judged(catalogue: Catalogue) -> None:
    reply = answer(off_centre(400.0, shaft_centre_mm=21.0), catalogue)

    assert not any(gear["missing"] for gear in reply["candidates"])
    assert check(reply, "HPN-20A-5", "output_bearing_load")["utilisation"] == pytest.approx(400 * 45 / 21 / 1800)


def test_a_gear_without_ratings_lacks_more_than_an_input(catalogue: Catalogue) -> None:
    assert candidate(answer(off_centre(1201.7), catalogue), "HPN-40A-5")["missing"] == []
