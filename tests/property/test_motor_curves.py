"""Motors judged along torque curves against a derivation of its own, from the words of the contract in plain Python."""

import copy
import math
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hpn.application import Application, MotorEntry
from hpn.catalogue import Catalogue, load_catalogue
from hpn.engine.pairs import table_of
from hpn.engine.selection import select
from hpn.engine.tried import needed_of, tried
from tests.build import Json, cycle, phase

OWN = {"HPN-20A-5": (0.002, 0.5), "HPN-20A-15": (0.0004, 0.15)}
"""Inertia in kg m² and torque without load in Nm at the input, of a gear of one stage and of one of two."""

EFFICIENCY = ((10.0, 30.0), (0.7, 0.9))
"""Torques in Nm and efficiencies of HPN-20A-5."""

GEARS = {"HPN-20A-5": 5, "HPN-20A-10": 10, "HPN-20A-15": 15}

REL = 1e-9
"""Both ways are closed sums; the integral of a parabola's rule and a golden section end well below this."""


@pytest.fixture(scope="module")
def catalogues(tmp_path_factory: pytest.TempPathFactory) -> tuple[Catalogue, Catalogue]:
    """The shipped catalogue, and that under a supplement with figures of two gears and an efficiency curve."""
    place: Path = tmp_path_factory.mktemp("supplement")
    (J5, M5), (J15, M15) = OWN.values()
    rows = f"20A,5,1,{J5},{M5},\n20A,15,2,{J15},{M15},\n"
    (place / "gears.csv").write_text(f"size,ratio,stages,inertia_kgm2,no_load_torque_Nm,source\n{rows}")
    points = "".join(f"20A,5,{T},{eta},\n" for T, eta in zip(*EFFICIENCY, strict=True))
    (place / "efficiency.csv").write_text(f"size,ratio,torque_Nm,efficiency,source\n{points}")
    return load_catalogue(), load_catalogue(supplement=place)


# --- The derivation ---------------------------------------------------------------------------------------------------


def line(points: Sequence[tuple[float, float]], x: float) -> float:
    """Value at x of straight lines between points, that of the nearer end beyond them."""
    if x <= points[0][0]:
        return points[0][1]
    for (x0, y0), (x1, y1) in pairwise(points):
        if x <= x1:
            return y0 + (y1 - y0) * (x - x0) / (x1 - x0)
    return points[-1][1]


class Expected:
    """Figures of a motor on a gear; `stretches` are start and end speed, torques and acceleration of the gear."""

    def __init__(self, document: Json, designation: str, supplemented: bool) -> None:
        self.duty, self.motor = document["duty_cycle"], document["requirements"]["motor"]
        self.i, self.stated = GEARS[designation], document["requirements"].get("efficiency")
        self.own = OWN.get(designation, (0.0, 0.0)) if supplemented else (0.0, 0.0)
        self.has_eta = supplemented and designation == "HPN-20A-5"
        self.M_c, self.M_p = (
            [(p["speed_rpm"], p[name]) for p in self.motor["curve"]] for name in ("continuous_Nm", "peak_Nm")
        )
        self.pause: float = self.duty.get("pause_s", 0.0)
        by = self.of_motion if "motion" in self.duty else self.of_phases
        self.fastest, self.peaks, squares, currents, angle, time = by()
        self.demand, self.limit = max(self.peaks, key=lambda pair: pair[0] / pair[1])
        whole = time + self.pause
        self.rms = math.sqrt(squares / whole)
        self.balance = math.sqrt((currents + self.M_c[0][1] ** 2 * self.pause) / whole)
        self.makers = line(self.M_c, angle / whole)

    def eta(self, torque: float) -> float:
        if self.stated is not None:
            return float(self.stated)
        return line(list(zip(*EFFICIENCY, strict=True)), torque) if self.has_eta else 1.0

    def of_phases(self) -> Any:
        """Typed phases: peak torque against the least limit up to the peak speed, mean speeds for the heat."""
        fastest = squares = currents = angle = time = 0.0
        peaks = []
        for one in self.duty["phases"]:
            T, n, t = abs(one["torque_Nm"]), one["speed_rpm"] * self.i, one["duration_s"]
            top, T_pk = one.get("peak_speed_rpm", one["speed_rpm"]) * self.i, one.get("peak_torque_Nm", T)
            without_load = self.own[1] if n > 0 else 0.0
            least = min(line(self.M_p, top), *(M for knot, M in self.M_p if knot <= top))
            peaks.append((T_pk / self.i / self.eta(T_pk) + without_load, least))
            squares += (T / self.i / self.eta(T) + without_load) ** 2 * t
            currents += line(self.M_c, n) ** 2 * t
            fastest, angle, time = max(fastest, top), angle + n * t, time + t
        return fastest, peaks, squares, currents, angle, time

    def of_motion(self) -> Any:
        """Triangular moves of a table: the speed rises and falls evenly, each ramp with one torque."""
        fastest = squares = currents = angle = time = 0.0
        peaks = []
        J_L, J_m = self.duty["motion"]["mechanism"]["inertia_kgm2"], self.motor.get("inertia_kgm2")
        for move in self.duty["motion"]["moves"]:
            sense, t = math.copysign(1, move["angle_deg"]), move["time_s"] / 2
            top = abs(move["angle_deg"]) / move["time_s"] / 3 * self.i  # at the motor, in rpm
            alpha = top / self.i * math.pi / 30 / t * sense
            for ramp in (1, -1):
                T = J_L * alpha * ramp + move.get("external_torque_Nm", 0.0)
                share = self.eta(abs(T)) if T * sense < 0 else 1 / self.eta(abs(T))
                if J_m is None:  # the rotor is left out, and no part of the load's torque with it
                    M = abs(T) / self.eta(abs(T)) / self.i + self.own[1]
                else:
                    M = abs(T * share / self.i + (J_m + self.own[0]) * self.i * alpha * ramp + self.own[1] * sense)
                knots = [0.0, *(knot for knot, _ in self.M_c if 0 < knot < top), top]
                peaks += [(M, line(self.M_p, n)) for n in knots]
                squares += M**2 * t
                for n0, n1 in pairwise(knots):  # the square of a line over its length
                    a, b = line(self.M_c, n0), line(self.M_c, n1)
                    currents += (a * a + a * b + b * b) / 3 * t * (n1 - n0) / top
                angle, time = angle + top / 2 * t, time + t
            fastest = max(fastest, top)
        return fastest, peaks, squares, currents, angle, time


# --- Applications -----------------------------------------------------------------------------------------------------


@st.composite
def motors(draw: st.DrawFn, with_inertia: bool) -> Json:
    """A motor with a curve, whose peak torque may rise and whose continuous torque may exceed that at rest."""
    speeds = sorted(draw(st.sets(st.integers(5, 90), min_size=1, max_size=5)))
    continuous = [draw(st.floats(0.5, 6)) for _ in range(len(speeds) + 1)]
    points = [
        {"speed_rpm": n * 100.0, "continuous_Nm": min(M, continuous[0]), "peak_Nm": M * draw(st.floats(1, 4))}
        for n, M in zip([0, *speeds], continuous, strict=True)
    ]
    motor: Json = {"curve": points}
    if draw(st.booleans()):
        motor["maximum_speed_rpm"] = draw(st.floats(500, 9000))
    if draw(st.booleans()):
        motor |= {"rated_speed_rpm": 1.0, "rated_torque_Nm": 0.01, "peak_torque_Nm": 0.02}  # not judged beside a curve
    if with_inertia:
        motor["inertia_kgm2"] = draw(st.floats(1e-5, 1e-3))
    return motor


@st.composite
def typed(draw: st.DrawFn) -> Json:
    phases = []
    for _ in range(draw(st.integers(1, 4))):
        T, n = draw(st.floats(0.5, 90)), draw(st.floats(5, 500))
        more: Json = {}
        if draw(st.booleans()):
            more["peak_torque_Nm"] = T * draw(st.floats(1, 2))
        if draw(st.booleans()):
            more["peak_speed_rpm"] = n * draw(st.floats(1, 2))
        phases.append(phase(T, n, draw(st.floats(0.1, 2)), **more))
    return cycle(*phases, pause_s=draw(st.sampled_from([0.0, 0.7, 4.0])))


@st.composite
def moved(draw: st.DrawFn) -> Json:
    moves = []
    for _ in range(draw(st.integers(1, 3))):
        time, top = draw(st.floats(0.2, 2)), draw(st.floats(20, 500))
        angle = top * time * 3 * draw(st.sampled_from([1, -1]))
        move = {"profile": "triangular", "angle_deg": angle, "time_s": time}
        moves.append(move | {"external_torque_Nm": draw(st.floats(-30, 30))})
    table = {"type": "rotary", "inertia_kgm2": draw(st.floats(0.01, 0.5))}
    pause = draw(st.sampled_from([0.0, 0.7, 4.0]))
    return {"duty_cycle": {"motion": {"mechanism": table, "moves": moves}, "pause_s": pause}}


@st.composite
def applications(draw: st.DrawFn) -> Json:
    along = draw(st.booleans())
    motor = draw(motors(along and draw(st.booleans())))
    asked: Json = {"sizes": ["20A"], "ratios": list(GEARS.values()), "motor": motor}
    if draw(st.booleans()):
        asked["efficiency"] = draw(st.floats(0.6, 1))
    if draw(st.booleans()):
        asked |= {"utilisation": draw(st.floats(0.5, 1)), "life_h": draw(st.floats(1000, 50000))}
    return draw(moved() if along else typed()) | {"requirements": asked}


def scaled(document: Json, factor: float) -> Json:
    """The application with all torques of its phases by a factor; of a motion those of inertia and load."""
    names = ("torque_Nm", "peak_torque_Nm")
    if "motion" in document["duty_cycle"]:
        motion = copy.deepcopy(document["duty_cycle"]["motion"])
        motion["mechanism"]["inertia_kgm2"] *= factor
        for move in motion["moves"]:
            move["external_torque_Nm"] *= factor
        return document | {"duty_cycle": document["duty_cycle"] | {"motion": motion}}
    phases = [one | {k: one[k] * factor for k in names if k in one} for one in document["duty_cycle"]["phases"]]
    return document | {"duty_cycle": document["duty_cycle"] | {"phases": phases}}


# --- Properties -------------------------------------------------------------------------------------------------------


@settings(max_examples=30, deadline=None)
@given(applications(), st.booleans())
def test_a_motor_with_a_curve_is_judged_as_the_contract_derives_it(
    catalogues: tuple[Catalogue, Catalogue], document: Json, supplemented: bool
) -> None:
    catalogue = catalogues[supplemented]
    asked = Application.model_validate(document)
    reply = select(asked, catalogue)
    motor = document["requirements"]["motor"]
    last = motor["curve"][-1]["speed_rpm"]
    entry = MotorEntry.model_validate({"designation": "M"} | motor)
    bare = Application.model_validate(
        document | {"requirements": {k: v for k, v in document["requirements"].items() if k != "motor"}}
    )
    pairs = table_of(bare, [entry], catalogue)
    for designation in GEARS:
        expected, found = Expected(document, designation, supplemented), reply.candidate(designation)
        assert found is not None
        checks = {one.code: one for one in found.checks}
        assert "motor_rated_speed" not in checks
        speed, peak, rated = (checks[f"motor_{name}"] for name in ("speed", "peak_torque", "rated_torque"))
        assert speed.demand == pytest.approx(expected.fastest, rel=REL)
        assert speed.limit == min(last, motor.get("maximum_speed_rpm", math.inf))
        column = [gear.designation for gear in pairs.gears.rows].index(designation)
        if expected.fastest > last * (1 + 1e-9):
            assert (speed.status, peak.status, rated.status) == ("fail", "not_rated", "not_rated")
            assert (found.motor_thermal_torque_Nm, found.motor_mean_speed_torque_Nm) == (None, None)
            assert math.isnan(pairs.thermal[0, column])
            continue
        if expected.fastest > last * (1 - 1e-9):
            continue
        assert peak.utilisation == pytest.approx(expected.demand / expected.limit, rel=REL)
        assert rated.demand == pytest.approx(expected.rms, rel=REL)
        assert found.motor_thermal_torque_Nm == pytest.approx(expected.balance, rel=REL)
        assert found.motor_mean_speed_torque_Nm == pytest.approx(expected.makers, rel=REL)
        thermal = expected.rms / min(expected.balance, expected.makers)
        assert rated.utilisation == pytest.approx(thermal, rel=REL)
        assert pairs.thermal[0, column] == pytest.approx(thermal, rel=REL)
        assert pairs.utilisation[0, column] == pytest.approx(found.utilisation, rel=REL)


@settings(max_examples=30, deadline=None)
@given(applications(), st.booleans())
def test_what_is_said_to_fit_along_a_curve_fits(
    catalogues: tuple[Catalogue, Catalogue], document: Json, supplemented: bool
) -> None:
    """Each alternative as printed, and the factor of the reserve; a little above it the derivation or a gear fails."""
    catalogue = catalogues[supplemented]
    asked = Application.model_validate(document)
    for found in select(asked, catalogue).candidates:
        for alternative in needed_of(found, asked, catalogue):
            followed = select(tried(asked, alternative, catalogue), catalogue).candidate(found.designation)
            assert followed is not None
            assert followed.status == "suitable", alternative
        factor = found.reserve.torque_factor
        assert found.reserve.speed_factor is None
        if "inertia_kgm2" in document["requirements"]["motor"]:
            assert factor is None  # the motor's own inertia takes part
            continue
        if factor is None or math.isinf(factor):
            continue
        within, beyond = (scaled(document, factor * (1 + step)) for step in (-1e-9, 1e-6))
        moved_by = ("repeated_peak_torque", "average_torque", "life", "motor_peak_torque", "motor_rated_torque")
        for one, passes in ((within, True), (beyond, False)):
            again = select(Application.model_validate(one), catalogue).candidate(found.designation)
            assert again is not None
            failing = [check.code for check in again.failing if check.code in moved_by]
            assert not failing if passes else failing


@settings(max_examples=4, deadline=None)
@given(typed(), motors(False), st.floats(1, 20))
def test_over_tolerances_the_ends_of_each_input_count_and_nothing_is_proved(
    catalogues: tuple[Catalogue, Catalogue], document: Json, motor: Json, percent: float
) -> None:
    document = document | {"requirements": {"sizes": ["20A"], "ratios": [5, 10], "motor": motor}}
    fields = ("torque_Nm", "speed_rpm", "duration_s")
    tolerances = {name: {"percent": percent} for name in fields}
    reply = select(Application.model_validate(document | {"tolerances": tolerances}), catalogues[0])
    with_them = ("torque_Nm", "peak_torque_Nm"), ("speed_rpm", "peak_speed_rpm"), ("duration_s",)
    for names in with_them:
        for factor in (1 - percent / 100, 1 + percent / 100):
            phases = [one | {k: one[k] * factor for k in names if k in one} for one in document["duty_cycle"]["phases"]]
            end = document | {"duty_cycle": document["duty_cycle"] | {"phases": phases}}
            for found in reply.candidates:
                expected = Expected(end, found.designation, supplemented=False)
                checks = {one.code: one for one in found.checks}
                peak, rated, speed = (checks[f"motor_{name}"] for name in ("peak_torque", "rated_torque", "speed"))
                assert isinstance(speed.worst, float)
                assert speed.worst >= expected.fastest / (speed.limit or math.inf) * (1 - 1e-9)
                if expected.fastest > motor["curve"][-1]["speed_rpm"]:
                    continue
                thermal = expected.rms / min(expected.balance, expected.makers)
                for check, least in ((peak, expected.demand / expected.limit), (rated, thermal)):
                    assert not check.exact
                    if isinstance(check.worst, float):  # else an end lies beyond the curve
                        assert check.worst >= least * (1 - 1e-9)


ALONG = ("motion.mechanism.inertia_kgm2", "pause_s", "requirements.motor.inertia_kgm2", "requirements.efficiency")


@settings(max_examples=4, deadline=None)
@given(moved(), motors(True), st.floats(1, 20))
def test_over_tolerances_of_a_motion_the_ends_of_each_input_count_and_nothing_is_proved(
    catalogues: tuple[Catalogue, Catalogue], document: Json, motor: Json, percent: float
) -> None:
    requirements = {"sizes": ["20A"], "ratios": [5, 15], "motor": motor, "efficiency": 0.8}
    document = document | {"requirements": requirements}
    document["duty_cycle"]["pause_s"] = 0.5
    tolerances = {path: {"percent": percent} for path in ALONG}
    reply = select(Application.model_validate(document | {"tolerances": tolerances}), catalogues[1])
    for path in ALONG:
        *way, name = path.split(".") if path.startswith("requirements") else ("duty_cycle", *path.split("."))
        for factor in (1 - percent / 100, 1 + percent / 100):
            end = copy.deepcopy(document)
            place = end
            for step in way:
                place = place[step]
            place[name] *= factor
            for found in reply.candidates:
                expected = Expected(end, found.designation, supplemented=True)
                if expected.fastest > motor["curve"][-1]["speed_rpm"] * (1 - 1e-9):
                    continue
                thermal = expected.rms / min(expected.balance, expected.makers)
                for code, least in (("peak", expected.demand / expected.limit), ("rated", thermal)):
                    check = found.check(f"motor_{code}_torque")
                    assert check is not None
                    assert not check.exact
                    assert isinstance(check.worst, float)
                    assert check.worst >= least * (1 - 1e-9)


@pytest.mark.parametrize("inertia", [None, 4e-4])
@pytest.mark.parametrize("angle", [150.0, -150.0])
def test_along_the_course_the_efficiency_is_read_at_the_torque_of_each_instant(
    catalogues: tuple[Catalogue, Catalogue], angle: float, inertia: float | None
) -> None:
    """Gravity loads the arm most in its slow first half, the curve is low in its fast second one.

    The other way steps through time. η at the phase's peak, as for a typed phase, would be too high at lower torques.
    """
    J, held, time, i = 0.4, 2.0 * 9.80665 * 0.4, 0.8, 5
    curve = [(0.0, 9.0), (600.0, 8.0), (1200.0, 2.0), (3000.0, 1.0)]
    t = np.linspace(0, time, 800_001)
    steep, sense = abs(angle) / (time / 2) ** 2, math.copysign(1, angle)
    first = t <= time / 2
    travel = np.where(first, steep * t**2 / 2, abs(angle) - steep * (time - t) ** 2 / 2)
    speed, alpha = np.where(first, t, time - t) * steep / 6 * i, np.radians(steep) * np.where(first, 1, -1) * sense
    T = J * alpha + held * np.cos(np.radians(travel * sense)) + 12.0
    eta = np.interp(np.abs(T), *EFFICIENCY)
    if inertia is None:
        M = np.abs(T) / eta / i + OWN["HPN-20A-5"][1]
    else:
        own = (inertia + OWN["HPN-20A-5"][0]) * i * alpha + OWN["HPN-20A-5"][1] * sense
        M = np.abs(np.where(T * sense >= 0, T / eta, T * eta) / i + own)
    share = M / np.interp(speed, *np.array(curve).T)

    arm = {"type": "rotary", "inertia_kgm2": J, "gravity_mass_kg": 2.0, "gravity_radius_mm": 400.0}
    move = {"profile": "triangular", "angle_deg": angle, "time_s": time, "external_torque_Nm": 12.0}
    points = [{"speed_rpm": n, "continuous_Nm": 1.0, "peak_Nm": M_p} for n, M_p in curve]
    motor = {"curve": points} | ({} if inertia is None else {"inertia_kgm2": inertia})
    asked = {"sizes": ["20A"], "ratios": [i], "motor": motor}
    document = {"duty_cycle": {"motion": {"mechanism": arm, "moves": [move]}}, "requirements": asked}
    gear = select(Application.model_validate(document), catalogues[True]).candidate("HPN-20A-5")
    assert gear is not None
    [found] = [check.utilisation for check in gear.checks if check.code == "motor_peak_torque"]
    assert found == pytest.approx(share.max(), rel=1e-5)  # a step is 1e-6 of the time
