"""Every check: what it compares, and how it is evaluated on every gear at once.

A check turns columns of N applications, shape (N, 1), and columns of G gears, shape (G,), into demand, limit and
utilisation that broadcast to (N, G). NaN means not published, so not rated; infinity means unlimited. What a check
tests, why, and what to turn stands in `explanations.py`, one entry per code.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from hpn import bearing, equations
from hpn.application import Application
from hpn.catalogue import Catalogue, GearColumns, GearList
from hpn.duty import Duty
from hpn.explanations import EXPLANATIONS, Explanation

FloatArray = NDArray[np.float64]
Terms = tuple[FloatArray, FloatArray, FloatArray]
PASS, FAIL, NOT_RATED, ABSENT = range(4)
STATUS = ("pass", "fail", "not_rated", "absent")


class Case:
    """N applications on G gears: the derived quantities that more than one check needs."""

    def __init__(self, duty: Duty, gears: GearList, catalogue: Catalogue) -> None:
        self.duty, self.gears, self.catalogue = duty, gears, catalogue
        g = gears.columns
        self.average_input_speed_rpm = equations.average_input_speed(
            ratio=g.ratio, average_output_speed_rpm=duty.average_output_speed_rpm
        )
        self.maximum_input_speed_rpm = equations.maximum_input_speed(
            ratio=g.ratio, maximum_output_speed_rpm=duty.maximum_output_speed_rpm
        )
        self.life_L10_h = equations.life(
            average_torque_Nm=duty.average_torque_Nm,
            average_input_speed_rpm=self.average_input_speed_rpm,
            rated_torque_Nm=g.rated_torque_Nm,
            rated_input_speed_rpm=catalogue.rated_input_speed_rpm,
            life_at_rated_torque_h=catalogue.life_at_rated_torque_h,
        )
        self.momentary_peak_count: FloatArray | None = None
        if any(application.emergency_stop for application in duty.applications):
            self.momentary_peak_count = equations.allowed_momentary_peaks(
                emergency_stop_torque_Nm=duty.emergency_stop_torque_Nm,
                repeated_peak_torque_Nm=g.repeated_peak_torque_Nm,
            )
        self.bearing = BearingCase(duty, gears, catalogue) if any(a.loads for a in duty.applications) else None
        self._motor_torque()

    def _motor_torque(self) -> None:
        duty, ratio = self.duty, self.gears.columns.ratio
        efficiency = duty.column(lambda a: a.requirements.efficiency or 1.0)
        self.motor_peak_torque_Nm = equations.motor_torque(
            output_torque_Nm=duty.maximum_torque_Nm, ratio=ratio, efficiency=efficiency
        )
        self.motor_rated_torque_Nm = equations.motor_torque(
            output_torque_Nm=duty.rms_torque_Nm, ratio=ratio, efficiency=efficiency
        )
        curves = self.catalogue.efficiency
        if not curves:
            return
        stated = duty.column(lambda a: a.requirements.efficiency)
        for index, gear in enumerate(self.gears.rows):
            if gear.designation not in curves:
                continue
            # Outside the supplied curve the efficiency is not known: loss-free, the lower bound, as without a curve.
            supplied = np.interp(duty.torque_Nm, *curves[gear.designation], left=1.0, right=1.0)
            eta = np.where(np.isnan(stated), supplied, stated)
            torque = equations.motor_torque(output_torque_Nm=duty.torque_Nm, ratio=gear.ratio, efficiency=eta)
            self.motor_peak_torque_Nm[:, index] = torque.max(axis=1)
            self.motor_rated_torque_Nm[:, index] = equations.rms_torque(
                torque_Nm=torque, duration_s=duty.duration_s, pause_s=duty.pause_s
            )


class BearingCase:
    """Output bearings of G gears under the loads of N applications (bearing-model: `hpn.bearing`)."""

    def __init__(self, duty: Duty, gears: GearList, catalogue: Catalogue) -> None:
        self.duty, self.gears = duty, gears
        speed, life = catalogue.bearing_reference
        load = self.phase_loads = self._phase_loads() * duty.load_coefficient[:, :, None]
        self.largest = load.max(axis=1)
        self.mean = bearing.mean_equivalent_load(
            equivalent_load=load, speed_rpm=duty.speed_rpm[:, :, None], duration_s=duty.duration_s[:, :, None], axis=1
        )
        self.life_L50_h = bearing.life_L50(
            equivalent_load=self.mean,
            average_output_speed_rpm=duty.average_output_speed_rpm,
            reference_speed_rpm=speed,
            reference_life_h=life,
        )
        self.life_factor = bearing.life_factor(
            average_output_speed_rpm=duty.average_output_speed_rpm,
            required_life_L50_h=duty.required_bearing_L50_h,
            reference_speed_rpm=speed,
            reference_life_h=life,
        )

    def _phase_loads(self) -> FloatArray:
        """Equivalent load P of every phase on every gear, shape (N, phases, G); NaN where it is not rated."""
        radial, axial = self.duty.loads_N
        g = self.gears.columns
        r, a = radial[:, :, None] / g.dynamic_radial_load_N, axial[:, :, None] / g.dynamic_axial_load_N
        models = [a.loads.model if a.loads else "linear" for a in self.duty.applications]
        P = bearing.linear_load(r, a)
        for index, model in enumerate(models):
            if model == "iso281":
                P[index] = bearing.iso281_load(r[index], a[index])
            elif model == "digitised":
                for column, curve in enumerate(self.gears.curves):
                    P[index, :, column] = (
                        curve.equivalent_load(radial[index], axial[index]) if curve is not None else np.nan
                    )
        return P


@dataclass(frozen=True)
class Check:
    """One check: whether an application asks for it, and its terms (demand, limit, utilisation)."""

    code: str
    asked: Callable[[Application], bool]
    terms: Callable[[Case], Terms]

    @property
    def explanation(self) -> Explanation:
        """What it tests, what goes wrong, on which basis, and what to turn."""
        return EXPLANATIONS[self.code]

    @property
    def is_load_check(self) -> bool:
        """Load checks are compared with the user's own utilisation u, property checks with 1."""
        return self.explanation.group == "load"


def _upper(demand: FloatArray, limit: FloatArray) -> Terms:
    return demand, limit, demand / limit


def _lower(demand: FloatArray, limit: FloatArray) -> Terms:
    return demand, limit, limit / demand


def _momentary_peak_count(case: Case) -> Terms:
    count = case.duty.column(lambda a: a.emergency_stop.count if a.emergency_stop else None)
    allowed = case.momentary_peak_count
    assert allowed is not None  # asked for only with an emergency stop
    # Where no stop at all is allowed the check fails without a utilisation, even for a count of 0.
    return count, allowed, np.where(allowed == 0, np.inf, count / allowed)


def _ambient_temperature(case: Case) -> Terms:
    g = case.gears.columns
    temperature = case.duty.column(lambda a: a.requirements.ambient_temperature_degC)
    low, high = g.ambient_temperature_minimum_degC, g.ambient_temperature_maximum_degC
    middle = (low + high) / 2
    limit = np.where(np.isnan(middle), np.nan, np.where(temperature >= middle, high, low))
    return temperature, limit, np.abs(temperature - middle) / ((high - low) / 2)


def _bearing(case: Case) -> BearingCase:
    assert case.bearing is not None  # asked for only with loads
    return case.bearing


def _requirement(name: str) -> Callable[[Application], float | None]:
    def read(application: Application) -> float | None:
        value: float | None = getattr(application.requirements, name)
        return value

    return read


def _motor(name: str) -> Callable[[Application], float | None]:
    def read(application: Application) -> float | None:
        motor = application.requirements.motor
        value: float | None = getattr(motor, name) if motor else None
        return value

    return read


def _given(read: Callable[[Application], float | None]) -> Callable[[Application], bool]:
    return lambda application: read(application) is not None


def _property(name: str, compare: Callable[[FloatArray, FloatArray], Terms], gear_field: str | None = None) -> Check:
    """Check of a published property of the gear against the requirement of the same name."""
    read = _requirement(name)
    code = name.removesuffix("_arcmin").removesuffix("_Nm_per_rad").removesuffix("_kg").removesuffix("_mm")
    return Check(
        code,
        _given(read),
        lambda case: compare(getattr(case.gears.columns, gear_field or name), case.duty.column(read)),
    )


def _of_motor(code: str, name: str, demand: Callable[[Case], FloatArray]) -> Check:
    read = _motor(name)
    return Check(code, _given(read), lambda case: _upper(demand(case), case.duty.column(read)))


def _always(application: Application) -> bool:
    return True


def _columns(case: Case) -> GearColumns:
    return case.gears.columns


_life = _requirement("life_h")

CHECKS: tuple[Check, ...] = (
    Check("average_torque", _always, lambda case: _upper(case.duty.average_torque_Nm, _columns(case).rated_torque_Nm)),
    Check(
        "repeated_peak_torque",
        _always,
        lambda case: (
            case.duty.maximum_torque_Nm,
            _columns(case).repeated_peak_torque_Nm,
            equations.repeated_peak_torque_utilisation(
                maximum_torque_Nm=case.duty.maximum_torque_Nm,
                repeated_peak_torque_Nm=_columns(case).repeated_peak_torque_Nm,
            ),
        ),
    ),
    Check(
        "momentary_peak_torque",
        lambda a: a.emergency_stop is not None,
        lambda case: (
            case.duty.emergency_stop_torque_Nm,
            _columns(case).momentary_peak_torque_Nm,
            equations.momentary_peak_torque_utilisation(
                emergency_stop_torque_Nm=case.duty.emergency_stop_torque_Nm,
                momentary_peak_torque_Nm=_columns(case).momentary_peak_torque_Nm,
            ),
        ),
    ),
    Check(
        "momentary_peak_count",
        lambda a: a.emergency_stop is not None and a.emergency_stop.count is not None,
        _momentary_peak_count,
    ),
    Check(
        "average_input_speed",
        _always,
        lambda case: _upper(case.average_input_speed_rpm, _columns(case).average_input_speed_rpm),
    ),
    Check(
        "maximum_input_speed",
        _always,
        lambda case: _upper(case.maximum_input_speed_rpm, _columns(case).maximum_input_speed_rpm),
    ),
    Check("life", _given(_life), lambda case: _lower(case.life_L10_h, case.duty.column(_life))),
    Check(
        "output_bearing_load",
        lambda a: a.loads is not None,
        lambda case: _upper(_bearing(case).largest, np.ones((1, 1))),
    ),
    Check(
        "output_bearing_life",
        lambda a: a.loads is not None,
        lambda case: _upper(_bearing(case).mean, _bearing(case).life_factor),
    ),
    _of_motor("motor_speed", "maximum_speed_rpm", lambda case: case.maximum_input_speed_rpm),
    _of_motor("motor_peak_torque", "peak_torque_Nm", lambda case: case.motor_peak_torque_Nm),
    _of_motor("motor_rated_torque", "rated_torque_Nm", lambda case: case.motor_rated_torque_Nm),
    Check("ambient_temperature", _given(_requirement("ambient_temperature_degC")), _ambient_temperature),
    _property("backlash_arcmin", _upper),
    _property("torsional_stiffness_Nm_per_rad", _lower),
    _property("weight_kg", _upper),
    _property("length_mm", _upper, "length_max_mm"),
)
"""The checks in their fixed order; a tie for governing goes to the first."""


@dataclass(frozen=True, slots=True)
class Evaluation:
    """Checks of N applications on G gears; `checks` are those that at least one of the applications asks for.

    `demand` and `limit` broadcast to (N, G) check by check; `utilisation` (checks, N, G) is infinite where a check
    fails without one; `status` (checks, N, G) holds PASS, FAIL, NOT_RATED or ABSENT.
    """

    checks: tuple[Check, ...]
    demand: list[FloatArray]
    limit: list[FloatArray]
    utilisation: FloatArray
    status: NDArray[np.int8]
    case: Case

    @property
    def load_checks(self) -> NDArray[np.bool_]:
        """Which of the checks are load checks, shape (checks, 1, 1)."""
        return _load_checks(self.checks)


@lru_cache(maxsize=1024)
def _load_checks(checks: tuple[Check, ...]) -> NDArray[np.bool_]:
    return np.array([check.is_load_check for check in checks])[:, None, None]


def evaluate(duty: Duty, gears: GearList, catalogue: Catalogue) -> Evaluation:
    """Every check that the applications ask for, on every gear."""
    asked = [(check, [check.asked(a) for a in duty.applications]) for check in CHECKS]
    active = [(check, mask) for check, mask in asked if any(mask)]
    checks = tuple(check for check, _ in active)
    with np.errstate(divide="ignore", invalid="ignore"):
        case = Case(duty, gears, catalogue)
        terms = [check.terms(case) for check in checks]
    utilisation = np.empty((len(checks), len(duty.applications), len(gears.rows)))
    for index, (_, _, values) in enumerate(terms):
        utilisation[index] = values
    bound = np.where(_load_checks(checks), duty.reserve_utilisation, 1.0) * (1 + equations.ROUNDING)
    # PASS is 0; what is not within the bound counts 1, FAIL, and once more where it is NaN: NOT_RATED.
    status = np.add(~(utilisation <= bound), np.isnan(utilisation), dtype=np.int8)
    if not all(all(mask) for _, mask in active):
        status[~np.array([mask for _, mask in active])] = ABSENT
    demands, limits = [demand for demand, _, _ in terms], [limit for _, limit, _ in terms]
    return Evaluation(checks, demands, limits, utilisation, status, case)
