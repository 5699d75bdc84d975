"""The drawn envelopes against the checks: the picture and the verdict must say the same."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from hpn.application import BearingModel
from hpn.catalogue import Catalogue, load_catalogue
from hpn.engine.envelopes import EnvelopeQuery, envelope_curve, life_envelopes
from hpn.physics import bearing
from tests.build import Json, answer, check, cycle, phase

CATALOGUE: Catalogue = load_catalogue()
SIZES = {"11A": "HPN-11A-5", "14A": "HPN-14A-10", "20A": "HPN-20A-5", "32A": "HPN-32A-25"}

sizes = st.sampled_from(list(SIZES))
models = st.sampled_from(["linear", "iso281"])
coefficients = st.one_of(st.sampled_from([1.0, 1.2, 1.5]), st.floats(1, 3))
speeds = st.floats(0.01, 1e4)
lives = st.floats(1, 1e7)
# A point on a segment is rounded, then divided, cubed and rooted.
ROUNDING = 1e-12


def curve_of(size: str, model: str, speed: float, life: float, f_w: float) -> list[tuple[float, float]]:
    """Corner points (radial, axial) of the envelope as the API draws it."""
    gear = CATALOGUE.by_designation[SIZES[size]]
    query = EnvelopeQuery.model_validate({"speed_rpm": speed, "life_h": life, "load_coefficient": f_w, "model": model})
    curve = next(c for c in life_envelopes(CATALOGUE, gear, query) if c.load_coefficient == f_w)
    return list(zip(curve.radial_N, curve.axial_N, strict=True))


def between(corners: list[tuple[float, float]], place: float) -> tuple[float, float]:
    """Point at `place` (0 to 1) along a drawn line, corner to corner by straight segments."""
    step = place * (len(corners) - 1)
    index = min(int(step), len(corners) - 2)
    (R0, A0), (R1, A1) = corners[index], corners[index + 1]
    share = step - index
    return R0 + share * (R1 - R0), A0 + share * (A1 - A0)


def judged(size: str, load: Json, *phases: Json) -> Json:
    return answer(cycle(*phases, output_load=load, requirements={"sizes": [size]}), CATALOGUE)


@given(sizes, models, speeds, lives, coefficients, st.floats(0, 1))
def test_a_constant_load_on_the_drawn_envelope_has_utilisation_one_by_the_check(
    size: str, model: str, speed: float, life: float, f_w: float, place: float
) -> None:
    """Where life bounds the curve (k <= 1) the life check says 1, where the published maximum does the load check."""
    radial, axial = between(curve_of(size, model, speed, life, f_w), place)
    load = {"radial_N": radial, "axial_N": axial, "load_coefficient": f_w, "life_h": life, "model": model}

    reply = judged(size, load, phase(1, speed))
    by_life = check(reply, SIZES[size], "output_bearing_life")
    by_load = check(reply, SIZES[size], "output_bearing_load")

    k = (100 / speed * 20000 / life) ** (1 / 3)
    assert math.isclose(by_life["limit"], k, rel_tol=ROUNDING)
    assert math.isclose(by_life["utilisation"], min(1, k) / k, rel_tol=ROUNDING)
    assert math.isclose(by_load["utilisation"], min(1, k), rel_tol=ROUNDING)
    larger = max(by_life["utilisation"], by_load["utilisation"])
    assert math.isclose(larger, 1, rel_tol=ROUNDING)


@given(sizes, models, coefficients, st.floats(0, 1), speeds)
def test_a_phase_on_the_published_envelope_over_the_load_coefficient_has_load_utilisation_one(
    size: str, model: BearingModel, f_w: float, place: float, speed: float
) -> None:
    gear = CATALOGUE.by_designation[SIZES[size]]
    curve = envelope_curve(CATALOGUE, gear, model, f_w)
    radial, axial = between(list(zip(curve.radial_N, curve.axial_N, strict=True)), place)
    load = {"load_coefficient": f_w, "model": model}

    other = phase(1, speed, radial_N=0.1 * radial, axial_N=0.1 * axial)
    reply = judged(size, load, other, phase(1, 0, radial_N=-radial, axial_N=-axial))

    assert math.isclose(check(reply, SIZES[size], "output_bearing_load")["utilisation"], 1, rel_tol=ROUNDING)


@given(sizes, models, speeds, lives, coefficients, st.floats(1, 10), st.sampled_from(["speed", "life", "f_w"]))
def test_more_speed_life_or_load_coefficient_never_enlarges_an_envelope(
    size: str, model: str, speed: float, life: float, f_w: float, factor: float, which: str
) -> None:
    changed = (
        speed * (factor if which == "speed" else 1),
        life * (factor if which == "life" else 1),
        min(f_w * (factor if which == "f_w" else 1), 3),
    )
    before = np.array(curve_of(size, model, speed, life, f_w))
    after = np.array(curve_of(size, model, *changed))

    assert (after <= before * (1 + 1e-15)).all()  # the factor itself is rounded


@given(sizes, models, speeds, lives, coefficients)
def test_slower_running_or_a_shorter_life_never_exceeds_the_published_maximum(
    size: str, model: str, speed: float, life: float, f_w: float
) -> None:
    gear = CATALOGUE.by_designation[SIZES[size]]
    for radial, axial in curve_of(size, model, speed, life, f_w):
        assert gear.dynamic_radial_load_N is not None and radial <= gear.dynamic_radial_load_N
        assert gear.dynamic_axial_load_N is not None and axial <= gear.dynamic_axial_load_N


@given(sizes, st.floats(0, 5000), st.floats(0, 5000), coefficients, speeds, lives)
def test_the_linear_model_permits_no_load_that_iso281_forbids(
    size: str, radial: float, axial: float, f_w: float, speed: float, life: float
) -> None:
    load = {"radial_N": radial, "axial_N": axial, "load_coefficient": f_w, "life_h": life}
    by_model = {model: judged(size, load | {"model": model}, phase(1, speed)) for model in ("linear", "iso281")}

    for code in ("output_bearing_load", "output_bearing_life"):
        linear, iso = (check(by_model[model], SIZES[size], code) for model in ("linear", "iso281"))
        assert iso["utilisation"] <= linear["utilisation"] * (1 + 1e-15)
        assert not (linear["status"] == "pass" and iso["status"] == "fail")


def test_linear_is_nowhere_below_iso281_on_a_grid_of_normalised_loads() -> None:
    r, a = np.meshgrid(np.linspace(0, 3, 301), np.linspace(0, 3, 301))

    assert (bearing.linear_load(radial=r, axial=a) >= bearing.iso281_load(radial=r, axial=a) * (1 - 1e-15)).all()


@given(models, st.lists(st.tuples(speeds, st.floats(0.1, 10), st.floats(0, 900), st.floats(0, 900)), min_size=1))
def test_the_equivalent_load_lies_between_the_smallest_and_the_largest_of_the_phases(
    model: str, rows: list[tuple[float, float, float, float]]
) -> None:
    phases = [phase(1, n, t, radial_N=r, axial_N=a) for n, t, r, a in rows]
    reply = judged("20A", {"model": model}, *phases)
    alone = [judged("20A", {"model": model}, entry) for entry in phases]

    demands = [check(one, "HPN-20A-5", "output_bearing_load")["demand"] for one in alone]
    mean = check(reply, "HPN-20A-5", "output_bearing_life")["demand"]
    assert min(demands) * (1 - ROUNDING) <= mean <= max(demands) * (1 + ROUNDING)
    assert math.isclose(check(reply, "HPN-20A-5", "output_bearing_load")["demand"], max(demands), rel_tol=ROUNDING)
