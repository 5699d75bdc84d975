"""Distance of the shaft's centre that each size needs: the shortest with which the checks of its bearing pass."""

import pytest

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.centres import needed_centres
from hpn.explain.drawings import Subject
from tests.build import Json, answer, check, cycle, phase


def loaded(**load: float) -> Json:
    """A constant load that acts 45 mm from the shoulder, on one phase."""
    return cycle(phase(10, 100), output_load={"radial_N": 400.0, "radial_position_mm": 45.0, **load})


def needed(asked: Json, catalogue: Catalogue) -> dict[str, float | None]:
    """Distances by size, of those that are rated."""
    application = Application.model_validate(asked)
    subject = Subject(application, catalogue.gears[0], catalogue)
    return {one.size: one.needed_mm for one in needed_centres(subject.of_sizes) if one.is_rated}


def test_the_distance_is_where_the_lever_brings_the_load_to_its_limit(catalogue: Catalogue) -> None:
    """By hand at 100 rpm and 20 000 h, where k is 1: 400 N · 45 / x_c = F_R,dyn(max) of 11A 480, 14A 840 N.

    The limits are those of tables 10.1 to 12.2. Sixty halvings leave less than 1e-9 of the distance.
    """
    result = needed(loaded(), catalogue)

    assert result["11A"] == pytest.approx(400 * 45 / 480, rel=1e-9)
    assert result["14A"] == pytest.approx(400 * 45 / 840, rel=1e-9)
    assert result["20A"] == pytest.approx(400 * 45 / 1800, rel=1e-9)


def test_the_largest_load_of_a_phase_needs_the_distance_where_the_mean_is_small(catalogue: Catalogue) -> None:
    """By hand: a load of 400 N in one phase of a thousandth of the time, whose share of the mean is 0.1 at most."""
    phases = phase(10, 100, 0.01, radial_N=400.0), phase(10, 100, 9.99, radial_N=1.0)
    result = needed(cycle(*phases, output_load={"radial_position_mm": 45.0}), catalogue)

    assert result["11A"] == pytest.approx(400 * 45 / 480, rel=1e-9)


def test_a_size_that_fails_without_a_lever_needs_a_distance_that_there_is_not(catalogue: Catalogue) -> None:
    assert needed(loaded(radial_N=500.0), catalogue)["11A"] is None


@pytest.mark.parametrize("load", [{}, {"axial_N": 120.0, "axial_radius_mm": 20.0}, {"load_coefficient": 1.5}])
def test_with_that_distance_the_checks_pass_and_with_a_shorter_one_they_fail(
    catalogue: Catalogue, load: dict[str, float]
) -> None:
    """The engine's own checks, a thousandth to both sides; the distance was found apart from them."""
    for size, x_c in needed(loaded(**load), catalogue).items():
        if x_c is None:
            continue
        for factor, status in ((1.001, "pass"), (0.999, "fail")):
            reply = answer(loaded(**load, shaft_centre_mm=factor * x_c), catalogue)
            states = {check(reply, f"HPN-{size}-5", f"output_bearing_{of}")["status"] for of in ("load", "life")}
            assert states == ({"pass"} if status == "pass" else states | {"fail"}), (size, factor)
