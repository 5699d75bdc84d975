"""Magnitudes at the edge of what the input accepts: no crash, no warning, no number that JSON lacks.

Warnings are errors in the tests, so an overflow that numpy reports fails them too.
"""

import itertools
import json
import math
from collections.abc import Iterator
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hpn.application import Application
from hpn.catalogue import Catalogue, load_catalogue
from hpn.engine.envelopes import EnvelopeQuery, life_envelopes
from tests.build import Json, candidate, cycle, phase
from tests.wire import Selection, select, select_fleet

CATALOGUE: Catalogue = load_catalogue()

DENORMAL = 5e-324
TORQUES = (0.0, -0.0, DENORMAL, 1e-300, 1e-106, 1e-5, 40.0, -1e6, 1e6)
SPEEDS = (0.0, DENORMAL, 1e-300, 1e-50, 100.0, -1e6, 1e6)
DURATIONS = (DENORMAL, 1e-300, 1e-49, 1.0, 1e9)
LOADS = (0.0, DENORMAL, 1e-300, 1e-110, 1.0, -1e9, 1e9)


def numbers(value: Any) -> Iterator[float]:
    """Every number anywhere in a reply."""
    if isinstance(value, dict):
        for entry in value.values():
            yield from numbers(entry)
    elif isinstance(value, list):
        for entry in value:
            yield from numbers(entry)
    elif isinstance(value, int | float):
        yield value


def refuse(constant: str) -> float:
    raise AssertionError(f"{constant} is not JSON")


def replies(application: Json) -> list[Json]:
    """The reply alone and as a member of a fleet; empty where the input is refused."""
    try:
        model = Application.model_validate(application)
    except ValueError:
        return []
    other = Application.model_validate(cycle(phase(1, 1), phase(2, 2)))
    selections = [select(model, CATALOGUE), select_fleet([other, model], CATALOGUE)[1]]
    found = []
    for selection in selections:
        assert isinstance(selection, Selection)
        selection.summary("/")
        found.append(json.loads(selection.json("/"), parse_constant=refuse))
    return found


def assert_sound(application: Json) -> None:
    for reply in replies(application):
        assert all(math.isfinite(number) for number in numbers(reply))
        for gear in reply["candidates"]:
            for check in gear["checks"]:
                # A verdict without a number is possible in one place only (contract: the allowed number is 0).
                if check["utilisation"] is None and check["status"] == "fail":
                    assert (check["code"], check["limit"]) == ("momentary_peak_count", 0), check


def extreme(*values: float) -> st.SearchStrategy[float]:
    return st.sampled_from(values)


@st.composite
def edges(draw: st.DrawFn) -> Json:
    """Applications at the bounds of every field, and far inside them."""
    positive = extreme(1e-12, 1.0, 1e12)
    hours = extreme(1e-12, 1.0, 1e9)
    phases = [
        phase(draw(extreme(*TORQUES)), draw(extreme(*SPEEDS)), draw(extreme(*DURATIONS)))
        for _ in range(draw(st.integers(1, 4)))
    ]
    application = cycle(*phases, pause_s=draw(extreme(0.0, DENORMAL, 1e-300, 1e9)))
    if draw(st.booleans()):
        count = draw(st.sampled_from([None, 0, 1, 10**15]))
        application["emergency_stop"] = {"torque_Nm": draw(extreme(*TORQUES)), "count": count}
    if draw(st.booleans()):
        application["output_load"] = {
            "radial_N": draw(extreme(*LOADS)),
            "axial_N": draw(extreme(*LOADS)),
            "load_coefficient": draw(extreme(1.0, 3.0)),
            "life_h": draw(hours),
            "life_basis": draw(st.sampled_from(["L50", "L10"])),
            "model": draw(st.sampled_from(["linear", "iso281"])),
        }
    optional = {
        "life_h": hours,
        "backlash_arcmin": positive,
        "torsional_stiffness_Nm_per_rad": positive,
        "weight_kg": positive,
        "length_mm": positive,
        "ambient_temperature_degC": extreme(-273.15, DENORMAL, 1000.0),
        "utilisation": extreme(DENORMAL, 1e-300, 1e-3, 1.0),
        "efficiency": extreme(1e-12, 1e-3, 1.0),
        "motor": st.fixed_dictionaries(
            {}, optional=dict.fromkeys(("maximum_speed_rpm", "peak_torque_Nm", "rated_torque_Nm"), positive)
        ),
    }
    application["requirements"] = draw(st.fixed_dictionaries({}, optional=optional))
    application["rank_by"] = draw(st.sampled_from(["weight", "utilisation", "motor_torque", "life", "stiffness"]))
    return application


@settings(max_examples=400)
@given(edges())
def test_no_extreme_within_the_bounds_crashes_warns_or_leaves_json(application: Json) -> None:
    assert_sound(application)


SMALL_REQUIREMENTS: list[Json] = [
    {"backlash_arcmin": DENORMAL},
    {"torsional_stiffness_Nm_per_rad": DENORMAL},
    {"weight_kg": 1e-309},
    {"length_mm": DENORMAL},
    {"utilisation": DENORMAL},
    {"efficiency": DENORMAL},
    {"efficiency": 1e-300, "motor": {"peak_torque_Nm": 1e-300}},
    {"life_h": DENORMAL},
    {"motor": {"maximum_speed_rpm": DENORMAL, "peak_torque_Nm": DENORMAL, "rated_torque_Nm": DENORMAL}},
]


@pytest.mark.parametrize("requirements", SMALL_REQUIREMENTS, ids=str)
def test_a_requirement_next_to_zero_is_judged_or_refused_but_never_overflows(requirements: Json) -> None:
    assert_sound(cycle(phase(1e6, 1e6), requirements=requirements, output_load={"radial_N": 1}))


@pytest.mark.parametrize("life", [DENORMAL, 1e-300, 1e9])
@pytest.mark.parametrize("speed", [DENORMAL, 1e-300, 1e6])
def test_extreme_lives_and_speeds_of_an_envelope_are_drawn_or_refused(life: float, speed: float) -> None:
    try:
        query = EnvelopeQuery.model_validate({"speed_rpm": speed, "life_h": life})
    except ValueError:
        return
    gear = CATALOGUE.by_designation["HPN-20A-5"]
    for curve in life_envelopes(CATALOGUE, gear, query):
        assert all(math.isfinite(value) for value in (*curve.radial_N, *curve.axial_N))


def test_every_pair_of_extreme_phases_is_sound() -> None:
    """All combinations of two phases from a coarse grid of extremes, at once as a fleet."""
    grid = list(itertools.product((0.0, DENORMAL, 1e6), (0.0, 1e-50, 1e6), (DENORMAL, 1e-49, 1e9)))
    for first in grid:
        models = []
        for second in grid:
            try:
                models.append(Application.model_validate(cycle(phase(*first), phase(*second), pause_s=1e9)))
            except ValueError:
                continue
        for selection in select_fleet(models, CATALOGUE):
            assert isinstance(selection, Selection)
            json.loads(selection.json("/"), parse_constant=refuse)


def test_a_torque_that_is_tiny_beside_a_holding_torque_is_still_averaged() -> None:
    """Equation 17.2 gives a constant torque back as it is, whatever is held while nothing moves."""
    held = cycle(phase(1e-100, 100), phase(1e6, 0))

    assert math.isclose(replies(held)[0]["duty"]["average_torque_Nm"], 1e-100, rel_tol=1e-12)


def test_a_load_that_is_tiny_beside_a_held_load_still_gives_a_bearing_life() -> None:
    """A life of 20000 h (100 rpm / n) / P^3 for the only phase that moves, here 4e4 / (1e-95)^3 hours."""
    held = cycle(phase(1, 100, radial_N=1800e-95), phase(1, 0, radial_N=1e9))

    life = candidate(replies(held)[0], "HPN-20A-5")["bearing_life_L50_h"]

    assert life is not None
    assert math.isclose(life, 4e4 * 1e285, rel_tol=1e-12)


def test_a_cycle_that_hardly_moves_is_refused_with_words_that_fit() -> None:
    with pytest.raises(ValueError, match="no phase moves"):
        Application.model_validate(cycle(phase(1, 0)))
    with pytest.raises(ValueError, match="no phase moves"):
        Application.model_validate(cycle(phase(1, 1e-60, 1e-60)))


@pytest.mark.parametrize("name", ["life_h", "weight_kg", "length_mm", "backlash_arcmin", "efficiency"])
def test_a_requirement_too_small_to_divide_by_is_refused_with_its_bound(name: str) -> None:
    with pytest.raises(ValueError, match="at least 1e-12"):
        Application.model_validate(cycle(phase(1, 1), requirements={name: 1e-13}))
    Application.model_validate(cycle(phase(1, 1), requirements={name: 1e-12}))
