"""Chapter 4's equations computed a second time with 50 digits, term by term as the handbook prints them."""

import random

import mpmath
import numpy as np
import pytest

from hpn.physics import bearing, equations

mpmath.mp.dps = 50
mpf = mpmath.mpf

# float64 carries 1.1e-16; a sum of 60 products and a power 10/3 may lose some tens of units of it.
ROUNDING = 1e-14
CASES = range(40)


def drawn(seed: int) -> tuple[list[float], list[float], list[float], float]:
    """Torque, speed and duration of some phases over many orders of magnitude, and a pause."""
    chance = random.Random(seed)
    count = chance.choice([1, 2, 3, 7, 60])
    T = [chance.choice([-1, 1]) * 10 ** chance.uniform(-3, 4) for _ in range(count)]
    n = [chance.choice([-1, 0, 1, 1]) * 10 ** chance.uniform(-3, 4) for _ in range(count - 1)] + [
        chance.uniform(1, 500)
    ]
    t = [10 ** chance.uniform(-3, 4) for _ in range(count)]
    return T, n, t, chance.choice([0.0, 10 ** chance.uniform(-3, 5)])


@pytest.mark.parametrize("seed", CASES)
def test_average_torque_17_2_agrees_with_fifty_digits(seed: int) -> None:
    T, n, t, _ = drawn(seed)
    weights = [mpf(abs(n_k)) * mpf(t_k) for n_k, t_k in zip(n, t, strict=True)]
    power = mpf(10) / 3
    damage = mpmath.fsum(w * mpf(abs(T_k)) ** power for w, T_k in zip(weights, T, strict=True))
    expected = (damage / mpmath.fsum(weights)) ** (1 / power)

    computed = equations.average_output_torque(torque_Nm=T, speed_rpm=n, duration_s=t)

    assert float(computed) == pytest.approx(float(expected), rel=ROUNDING)


@pytest.mark.parametrize("seed", CASES)
def test_average_speed_17_4_agrees_with_fifty_digits(seed: int) -> None:
    _, n, t, pause = drawn(seed)
    way = mpmath.fsum(mpf(abs(n_k)) * mpf(t_k) for n_k, t_k in zip(n, t, strict=True))
    expected = way / (mpmath.fsum(map(mpf, t)) + mpf(pause))

    computed = equations.average_output_speed(speed_rpm=n, duration_s=t, pause_s=pause)

    assert float(computed) == pytest.approx(float(expected), rel=ROUNDING)


@pytest.mark.parametrize("seed", CASES)
def test_rms_torque_agrees_with_fifty_digits(seed: int) -> None:
    T, _, t, pause = drawn(seed)
    squares = mpmath.fsum(mpf(T_k) ** 2 * mpf(t_k) for T_k, t_k in zip(T, t, strict=True))
    expected = mpmath.sqrt(squares / (mpmath.fsum(map(mpf, t)) + mpf(pause)))

    computed = equations.rms_torque(torque_Nm=T, duration_s=t, pause_s=pause)

    assert float(computed) == pytest.approx(float(expected), rel=ROUNDING)


@pytest.mark.parametrize("seed", CASES)
def test_life_17_10_agrees_with_fifty_digits(seed: int) -> None:
    chance = random.Random(seed)
    T_av, n_in, T_N = 10 ** chance.uniform(-2, 3), 10 ** chance.uniform(-1, 4), chance.uniform(9, 752)
    expected = mpf(20000) * (3000 / mpf(n_in)) * (mpf(T_N) / mpf(T_av)) ** (mpf(10) / 3)

    computed = equations.life(
        average_torque_Nm=T_av, average_input_speed_rpm=n_in, rated_torque_Nm=T_N, rated_input_speed_rpm=3000
    )

    assert float(computed) == pytest.approx(float(expected), rel=ROUNDING)


@pytest.mark.parametrize("T_R", [9, 26, 149, 376, 752])
def test_allowed_stops_17_9_agree_with_fifty_digits_for_every_whole_torque(T_R: int) -> None:
    """Counted down from T_R to where not one stop is allowed; a power of ten met exactly must not lose its one."""
    torques = range(T_R + 1, 7 * T_R)
    exponents = [mpf("8.5") - mpf("1.5") * T_k / T_R for T_k in torques]
    expected = [int(mpmath.floor(mpf(10) ** x * (1 + mpf("1e-12")))) for x in exponents]

    computed = equations.allowed_momentary_peaks(emergency_stop_torque_Nm=list(torques), repeated_peak_torque_Nm=T_R)

    assert computed.tolist() == expected


@pytest.mark.parametrize(("multiple", "count"), [(3, 10**4), (5, 10), (17 / 3, 1)])
def test_a_whole_power_of_ten_is_not_rounded_down_to_one_less(multiple: float, count: int) -> None:
    """8.5 - 1.5 * 3 is 4 exactly, so N is 10000: known by mental arithmetic."""
    for T_R in (9.0, 49.0, 149.0, 376.0):
        N = equations.allowed_momentary_peaks(emergency_stop_torque_Nm=multiple * T_R, repeated_peak_torque_Nm=T_R)
        assert float(N) == count


def test_at_or_below_the_repeated_peak_torque_equation_17_9_sets_no_limit() -> None:
    N = equations.allowed_momentary_peaks(
        emergency_stop_torque_Nm=[0, 148, 149, np.nextafter(149, 150)], repeated_peak_torque_Nm=149
    )

    assert N[:3].tolist() == [np.inf] * 3
    assert float(N[3]) == 10**7  # 8.5 - 1.5 = 7, the first value of the equation's range


def test_a_holding_phase_counts_in_no_average_torque_but_in_speed_and_rms() -> None:
    moving = {"torque_Nm": [10.0], "speed_rpm": [100.0], "duration_s": [2.0]}
    value_held = {"torque_Nm": [10.0, 99.0], "speed_rpm": [100.0, 0.0], "duration_s": [2.0, 2.0]}

    alone, with_hold = equations.average_output_torque(**moving), equations.average_output_torque(**value_held)
    assert float(alone) == pytest.approx(10, rel=ROUNDING)
    assert float(with_hold) == pytest.approx(10, rel=ROUNDING)
    speed = equations.average_output_speed(
        speed_rpm=value_held["speed_rpm"], duration_s=value_held["duration_s"], pause_s=0
    )
    assert float(speed) == 50
    rms = equations.rms_torque(torque_Nm=value_held["torque_Nm"], duration_s=value_held["duration_s"], pause_s=0)
    assert float(rms) == pytest.approx(((100 + 9801) / 2) ** 0.5, rel=ROUNDING)


def test_equations_broadcast_over_cycles_and_give_zero_dimensions_for_scalars() -> None:
    T = np.arange(24.0).reshape(2, 3, 4)
    one = equations.average_output_torque(torque_Nm=T[1, 2], speed_rpm=100.0, duration_s=np.ones(4))
    many = equations.average_output_torque(torque_Nm=T, speed_rpm=np.full(4, 100.0), duration_s=np.ones(4))

    assert many.shape == (2, 3)
    assert many[1, 2] == one
    for value in (
        equations.average_input_speed(ratio=5, average_output_speed_rpm=2.0),
        equations.maximum_input_speed(ratio=5, maximum_output_speed_rpm=2.0),
        equations.repeated_peak_torque_utilisation(maximum_torque_Nm=1, repeated_peak_torque_Nm=2),
        equations.momentary_peak_torque_utilisation(emergency_stop_torque_Nm=1, momentary_peak_torque_Nm=2),
        equations.motor_torque(output_torque_Nm=10, ratio=5),
    ):
        assert isinstance(value, np.ndarray)
        assert value.shape == ()


def test_motor_torque_is_output_torque_over_ratio_and_efficiency() -> None:
    assert float(equations.motor_torque(output_torque_Nm=40, ratio=5)) == 8
    assert float(equations.motor_torque(output_torque_Nm=40, ratio=5, efficiency=0.8)) == 10


@pytest.mark.parametrize("seed", CASES)
def test_equivalent_bearing_load_life_and_factor_agree_with_fifty_digits(seed: int) -> None:
    P, n, t, pause = drawn(seed)
    chance = random.Random(seed)
    P = [abs(p) / 1e3 for p in P]
    required = 10 ** chance.uniform(0, 6)
    weights = [mpf(abs(n_k)) * mpf(t_k) for n_k, t_k in zip(n, t, strict=True)]
    cubes = mpmath.fsum(w * mpf(p) ** 3 for w, p in zip(weights, P, strict=True))
    P_m = mpmath.cbrt(cubes / mpmath.fsum(weights))
    n_av = mpmath.fsum(weights) / (mpmath.fsum(map(mpf, t)) + mpf(pause))
    f_w = mpf(chance.uniform(1, 3))

    mean = bearing.mean_equivalent_load(equivalent_load=np.array(P), speed_rpm=np.array(n), duration_s=np.array(t))
    life = bearing.life_L50(
        equivalent_load=float(f_w) * mean,
        average_output_speed_rpm=float(n_av),
        reference_speed_rpm=100,
        reference_life_h=20000,
    )
    k = bearing.life_factor(
        average_output_speed_rpm=float(n_av),
        required_life_L50_h=required,
        reference_speed_rpm=100,
        reference_life_h=20000,
    )

    assert float(mean) == pytest.approx(float(P_m), rel=ROUNDING)
    assert float(life) == pytest.approx(float(20000 * (100 / n_av) / (f_w * P_m) ** 3), rel=ROUNDING)
    assert float(k) == pytest.approx(float(mpmath.cbrt(100 * mpf(20000) / (n_av * mpf(required)))), rel=ROUNDING)
