"""The output bearing: published limits met exactly, life by brute force, why the straight line is the safe model."""

import itertools

import mpmath
import numpy as np
import pytest

from hpn.catalogue import Catalogue
from hpn.engine.envelopes import EnvelopeQuery, life_envelopes
from hpn.physics import bearing
from tests.build import answer, candidate, check, cycle, phase
from tests.reference import handbook

SIZES = tuple(handbook.DYNAMIC_RADIAL_LOAD_N)
MODELS = ("linear", "iso281")
ROUNDING = 1e-12
"""Cube roots come out otherwise in their last bit on other processors."""

# Rows of ISO 281's table of factors for deep groove ball bearings, X = 0.56: f0 Fa/C0, e, Y.
ISO_281 = (
    (0.172, 0.19, 2.30),
    (0.345, 0.22, 1.99),
    (0.689, 0.26, 1.71),
    (1.03, 0.28, 1.55),
    (1.38, 0.30, 1.45),
    (2.07, 0.34, 1.31),
    (3.45, 0.38, 1.15),
    (5.17, 0.42, 1.04),
    (6.89, 0.44, 1.00),
)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("size", SIZES)
def test_at_the_published_condition_the_envelope_meets_the_axes_at_the_published_limits(
    catalogue: Catalogue, size: str, model: str
) -> None:
    gear = catalogue.find_size(size)
    assert gear is not None
    query = EnvelopeQuery.model_validate({"speed_rpm": 100, "life_h": 20000, "model": model})

    curves = {curve.load_coefficient: curve for curve in life_envelopes(catalogue, gear, query)}

    assert list(curves) == [1.0, 1.2, 1.5]
    for f_w, curve in curves.items():
        # The quotient is rounded once in either way of writing it, hence the last place.
        radial = pytest.approx(handbook.DYNAMIC_RADIAL_LOAD_N[size] / f_w, rel=4e-16)
        axial = pytest.approx(handbook.DYNAMIC_AXIAL_LOAD_N[size] / f_w, rel=4e-16)
        assert curve.radial_N[0] == curve.axial_N[-1] == 0
        assert curve.axial_N[0] == axial
        assert curve.radial_N[-1] == radial


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("size", SIZES)
def test_a_published_limit_alone_uses_the_bearing_fully_and_gives_the_published_life(
    catalogue: Catalogue, size: str, model: str
) -> None:
    limits = {
        "radial_N": handbook.DYNAMIC_RADIAL_LOAD_N[size],
        "axial_N": handbook.DYNAMIC_AXIAL_LOAD_N[size],
    }
    for direction, limit in limits.items():
        load = {direction: limit, "model": model}
        reply = answer(cycle(phase(1, 100), output_load=load, requirements={"sizes": [size]}), catalogue)
        for gear in reply["candidates"]:
            assert gear["bearing_life_L50_h"] == pytest.approx(handbook.BEARING_REFERENCE_LIFE_H, rel=ROUNDING)
            assert gear["bearing_life_L10_h"] == pytest.approx(handbook.BEARING_REFERENCE_LIFE_H / 5, rel=ROUNDING)
            for code in ("output_bearing_load", "output_bearing_life"):
                result = check(reply, gear["designation"], code)
                assert (result["demand"], result["limit"], result["utilisation"]) == pytest.approx(
                    (1, 1, 1), rel=ROUNDING
                )
                assert result["status"] == "pass"


@pytest.mark.parametrize("model", MODELS)
def test_halving_the_speed_at_a_fixed_load_doubles_the_bearing_life(catalogue: Catalogue, model: str) -> None:
    load = {"radial_N": 700, "axial_N": -300, "load_coefficient": 1.3, "model": model}
    lives = []
    for speed in (400, 200, 100, 50):
        reply = answer(cycle(phase(1, speed), output_load=load), catalogue)
        lives.append(candidate(reply, "HPN-20A-5")["bearing_life_L50_h"])

    ratios = [slower / faster for faster, slower in itertools.pairwise(lives)]
    assert ratios == pytest.approx([2, 2, 2], rel=1e-15)  # halving a binary fraction is exact


def test_a_requirement_as_L10_counts_five_times_and_L10_is_a_fifth_of_L50(catalogue: Catalogue) -> None:
    load = {"radial_N": 700, "axial_N": 300}
    as_L10 = answer(cycle(phase(1, 90), output_load=load | {"life_h": 4000, "life_basis": "L10"}), catalogue)
    as_L50 = answer(cycle(phase(1, 90), output_load=load | {"life_h": 20000, "life_basis": "L50"}), catalogue)

    for one, other in zip(as_L10["candidates"], as_L50["candidates"], strict=True):
        basis = {"shortest_life_h", "shortest_life_of"}  # the life that is judged, on its own basis
        assert {k: v for k, v in one.items() if k not in basis} == {k: v for k, v in other.items() if k not in basis}
    gear = candidate(as_L10, "HPN-20A-5")
    assert gear["bearing_life_L50_h"] == 5 * gear["bearing_life_L10_h"]


def test_a_varying_cycle_lives_as_long_as_its_damage_summed_phase_by_phase(catalogue: Catalogue) -> None:
    """Closed form against Palmgren and Miner: each phase alone lives L_i, so a cycle uses up sum(t_i / L_i).

    Over a grid of loads, with 40 digits: no equation of the product is used, only the published condition (100 rpm and
    20000 h at P = 1) and the exponent 3 of ball bearings.
    """
    mpf, f_w = mpmath.mpf, 1.2
    phases = ((250, 0.3), (-500, 3.0), (0, 2.0), (40, 0.4))
    pause = 4.0
    grid = [0.0, 150.0, 1100.0, -1700.0]
    for model in MODELS:
        for first in grid:
            for second in grid:
                loads = [(first, second), (second, 90.0), (1800.0, 2200.0), (300.0, first)]
                values = [phase(1, n, t, radial_N=r, axial_N=a) for (n, t), (r, a) in zip(phases, loads, strict=True)]
                with mpmath.workdps(40):
                    damage = mpf(0)
                    for (n, t), (F_R, F_A) in zip(phases, loads, strict=True):
                        r, a = abs(mpf(F_R)) / 1800, abs(mpf(F_A)) / 2200
                        P = r + a if model == "linear" else max(r, mpf("0.56") * r + a)
                        revolutions = abs(n) * mpf(t)
                        damage += revolutions / (100 * mpf(20000)) * (mpf(f_w) * P) ** 3
                    cycle_time = mpmath.fsum(mpf(t) for _, t in phases) + mpf(pause)
                    expected = float(cycle_time / damage)  # hours: the unit of time cancels

                load = {"load_coefficient": f_w, "model": model}
                reply = answer(cycle(*values, pause_s=pause, output_load=load), catalogue)
                life = candidate(reply, "HPN-20A-5")["bearing_life_L50_h"]

                assert life == pytest.approx(expected, rel=1e-12), (model, loads)


def test_the_life_check_turns_where_the_damage_over_the_required_life_reaches_one(catalogue: Catalogue) -> None:
    """Utilisation f_w P_m / k cubed is required life over life: the same verdict by the other road."""
    for life in (100, 5_000, 80_000, 3e6):
        for speed in (3, 100, 470):
            for radial in (60, 333, 1500):
                load = {"radial_N": radial, "axial_N": 120, "life_h": life, "load_coefficient": 1.5}
                reply = answer(cycle(phase(1, speed, 2), phase(1, 0), pause_s=0.7, output_load=load), catalogue)
                reached = candidate(reply, "HPN-32A-4")["bearing_life_L50_h"]
                used = check(reply, "HPN-32A-4", "output_bearing_life")["utilisation"]
                assert used**3 == pytest.approx(life / reached, rel=1e-13)  # a handful of roundings


def test_the_straight_line_lies_inside_the_region_of_the_tabulated_factors_over_the_whole_table() -> None:
    """ISO 281's Y falls as Fa/C0 rises, which makes the permissible region not convex; the line stays inside it.

    The region is {P(F_R, F_A) <= F_R,max}, anchored at both published points: P is the radial limit on the radial axis,
    and F_A,max is where Y(F_A/C0) F_A reaches it. Which C0 a bearing has is not published, so every position of F_A,max
    in the table is tried.
    """
    abscissa, e_column, Y_column = map(np.array, zip(*ISO_281, strict=True))
    share = np.linspace(0, 1, 2001)
    for position in np.geomspace(abscissa[0], abscissa[-1], 400):
        limit = np.interp(position, abscissa, Y_column)  # F_R,max over F_A,max
        axial = share * position  # f0 Fa/C0 along the line from (F_R,max, 0) to (0, F_A,max)
        radial = (1 - share) * limit * position
        # Below the first row the table gives no Y: its first row is the largest, so the hardest, printed.
        Y = np.interp(axial, abscissa, Y_column)
        e = np.interp(axial, abscissa, e_column)
        with_axial = 0.56 * radial + Y * axial
        P = np.where(axial > e * radial, with_axial, radial)

        assert P[0] == pytest.approx(limit * position, rel=1e-15)
        assert P[-1] == pytest.approx(limit * position, rel=1e-15)
        worst = (P / (limit * position)).max()
        assert worst <= 1 + 1e-12, (position, worst)  # equality at the anchors, in floating point


def test_the_knee_of_the_iso_model_is_where_the_radial_part_alone_reaches_the_limit() -> None:
    radial, axial = bearing.envelope(model="iso281", radial_limit_N=1800, axial_limit_N=2200, curve=None, factor=1)

    assert radial[1] == 1800
    assert axial[1] == pytest.approx(0.44 * 2200, rel=1e-15)
    P = bearing.iso281_load(radial=radial / 1800, axial=axial / 2200)
    assert P.tolist() == pytest.approx([1, 1, 1], rel=1e-15)
