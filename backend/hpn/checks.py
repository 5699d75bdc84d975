"""Every check: what it compares, evaluated for every application on every gear in one compiled pass.

NaN means not published, so not rated; infinity means unlimited. What a check tests, why, and what to turn stands in
`explanations.py`, one entry per code.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from hpn import bearing, equations
from hpn import duty as d
from hpn.catalogue import Catalogue, GearList
from hpn.compiled import compiled
from hpn.duty import Duty
from hpn.explanations import EXPLANATIONS, Explanation

FloatArray = NDArray[np.float64]
ByteArray = NDArray[np.int8]
PASS, FAIL, NOT_RATED, ABSENT = range(4)
STATUS = ("pass", "fail", "not_rated", "absent")

(
    AVERAGE_TORQUE,
    REPEATED_PEAK_TORQUE,
    MOMENTARY_PEAK_TORQUE,
    MOMENTARY_PEAK_COUNT,
    AVERAGE_INPUT_SPEED,
    MAXIMUM_INPUT_SPEED,
    LIFE,
    OUTPUT_BEARING_LOAD,
    OUTPUT_BEARING_LIFE,
    MOTOR_SPEED,
    MOTOR_PEAK_TORQUE,
    MOTOR_RATED_TORQUE,
    AMBIENT_TEMPERATURE,
    BACKLASH,
    TORSIONAL_STIFFNESS,
    WEIGHT,
    LENGTH,
) = range(17)
"""The checks in their fixed order, which is that of `EXPLANATIONS`; a tie for governing goes to the first."""


@dataclass(frozen=True)
class Check:
    """One check, by its code."""

    code: str

    @property
    def explanation(self) -> Explanation:
        """What it tests, what goes wrong, on which basis, and what to turn."""
        return EXPLANATIONS[self.code]

    @property
    def is_load_check(self) -> bool:
        """Load checks are compared with the user's own utilisation u, property checks with 1."""
        return self.explanation.group == "load"


CHECKS = tuple(Check(code) for code in EXPLANATIONS)
LOAD_CHECKS = sum(check.is_load_check for check in CHECKS)
"""The first so many are load checks, the others property checks."""

DEMAND, LIMIT, USED = range(3)
"""Rows of `Evaluation.terms`; utilisation is the last."""

N_IN_AV, N_IN_MAX, L10, PEAKS, BEARING_L50, MOTOR_PEAK, MOTOR_RATED, BEARING_MEAN, BEARING_LARGEST = range(9)
"""Rows of `Evaluation.figures`."""

T_N, T_R, T_M, N_AV, N_MAX, RATIO, F_R, F_A, LOWEST, HIGHEST, PLAY, K3, MASS, LENGTH_MAX = range(14)
"""Rows of a table of gears."""


@dataclass(slots=True)
class Evaluation:
    """Checks of N applications on G gears.

    `terms` (3, checks, N, G) are demand, limit and utilisation, the last infinite where a check fails without one;
    `status` (checks, N, G) holds PASS, FAIL, NOT_RATED or ABSENT; `figures` (9, N, G) is what they derive from.
    """

    duty: Duty
    gears: GearList
    catalogue: Catalogue
    terms: FloatArray
    status: ByteArray
    figures: FloatArray

    def asked(self, index: int) -> tuple[int, ...]:
        """Checks that application `index` asks for."""
        return _present(self.status[:, index, 0].tobytes())

    @property
    def life_L10_h(self) -> FloatArray:
        """Life L10, shape (N, G); infinite without a load, NaN where not rated."""
        return self._figure(L10)

    @property
    def momentary_peak_count(self) -> FloatArray:
        """Allowed number of emergency stops, shape (N, G); NaN without a stop and where not rated."""
        return self._figure(PEAKS)

    @property
    def bearing_life_L50_h(self) -> FloatArray:
        """Life L50 of the output bearing, shape (N, G); NaN without loads and where not rated."""
        return self._figure(BEARING_L50)

    @property
    def bearing_mean_load(self) -> FloatArray:
        """f_w P_m of the output bearing, shape (N, G); NaN likewise."""
        return self._figure(BEARING_MEAN)

    @property
    def bearing_largest_load(self) -> FloatArray:
        """Largest f_w P of the output bearing, shape (N, G); NaN likewise."""
        return self._figure(BEARING_LARGEST)

    def _figure(self, row: int) -> FloatArray:
        figure: FloatArray = self.figures[row]
        return figure

    def bearing_life_factor(self, index: int) -> float:
        """Load factor k that speed and required life of application `index` allow."""
        return self.terms.item((LIMIT, OUTPUT_BEARING_LIFE, index, 0))

    def bearing_loads(self) -> FloatArray:
        """Equivalent load f_w P of every phase on every gear, shape (N, phases, G); NaN where it is not rated."""
        loads = np.empty((*self.duty.phases.shape[:2], len(self.gears.rows)))
        _phase_loads(
            self.duty.phases, self.duty.wishes, table_of(self.gears), _along_curves(self.duty, self.gears), loads
        )
        return loads


@lru_cache(maxsize=1024)
def _present(status: bytes) -> tuple[int, ...]:
    return tuple(check for check, state in enumerate(status) if state != ABSENT)


def evaluate(duty: Duty, gears: GearList, catalogue: Catalogue) -> Evaluation:
    """Every check that the applications ask for, on every gear."""
    shape = (len(duty.applications), len(gears.rows))
    terms, status, figures = np.empty((3, 17, *shape)), np.empty((17, *shape), np.int8), np.empty((9, *shape))
    _evaluate(
        duty.phases,
        duty.wishes,
        duty.figures,
        table_of(gears),
        catalogue.references,
        _along_curves(duty, gears),
        _motor_torques(duty, gears, catalogue),
        terms,
        status,
        figures,
    )
    return Evaluation(duty, gears, catalogue, terms, status, figures)


@lru_cache(maxsize=1024)
def table_of(gears: GearList) -> FloatArray:
    """Figures of gears as a table, shape (figures, G)."""
    g = gears.columns
    table = np.array(
        [
            g.rated_torque_Nm,
            g.repeated_peak_torque_Nm,
            g.momentary_peak_torque_Nm,
            g.average_input_speed_rpm,
            g.maximum_input_speed_rpm,
            g.ratio,
            g.dynamic_radial_load_N,
            g.dynamic_axial_load_N,
            g.ambient_temperature_minimum_degC,
            g.ambient_temperature_maximum_degC,
            g.backlash_arcmin,
            g.torsional_stiffness_Nm_per_rad,
            g.weight_kg,
            g.length_max_mm,
        ]
    )
    table.flags.writeable = False
    return table


@compiled
def has_unlimited(values: FloatArray) -> bool:
    """Whether one of the values is infinite."""
    return bool(np.isinf(values).any())


# --- What a supplement may bring: curves ------------------------------------------------------------------------------

_NO_CURVES = np.empty((0, 0, 0))


def _along_curves(duty: Duty, gears: GearList) -> FloatArray:
    """Equivalent loads along supplied curve points, shape (N, phases, G), where an application asks for them."""
    asked = [index for index, a in enumerate(duty.applications) if a.loads and a.loads.model == "digitised"]
    if not asked:
        return _NO_CURVES
    radial, axial = duty.loads_N
    loads = np.full((*radial.shape, len(gears.rows)), np.nan)
    for column, curve in enumerate(gears.curves):
        if curve is not None:
            loads[asked, :, column] = curve.equivalent_load(radial[asked], axial[asked])
    return loads


def _motor_torques(duty: Duty, gears: GearList, catalogue: Catalogue) -> FloatArray:
    """Peak and RMS torque at the motor by supplied efficiency curves, shape (2, N, G); NaN on gears without a curve."""
    if not catalogue.efficiency:
        return _NO_CURVES
    stated, torques = duty.wishes[:, d.EFFICIENCY, None], np.full((2, len(duty.applications), len(gears.rows)), np.nan)
    for index, gear in enumerate(gears.rows):
        if gear.designation in catalogue.efficiency:
            # Outside the supplied curve the efficiency is not known: loss-free, the lower bound, as without a curve.
            supplied = np.interp(duty.torque_Nm, *catalogue.efficiency[gear.designation], left=1.0, right=1.0)
            eta = np.where(np.isnan(stated), supplied, stated)
            torque = equations.motor_torque(output_torque_Nm=duty.torque_Nm, ratio=gear.ratio, efficiency=eta)
            torques[0, :, index] = torque.max(axis=1)
            torques[1, :, index] = equations.rms_torque(
                torque_Nm=torque, duration_s=duty.duration_s, pause_s=duty.pause_s
            )
    return torques


# --- One pass over applications and gears -----------------------------------------------------------------------------

_average_input_speed = equations.average_input_speed.case
_maximum_input_speed = equations.maximum_input_speed.case
_repeated_peak_torque_utilisation = equations.repeated_peak_torque_utilisation.case
_momentary_peak_torque_utilisation = equations.momentary_peak_torque_utilisation.case
_allowed_momentary_peaks = equations.allowed_momentary_peaks.case
_life = equations.life.case
_motor_torque = equations.motor_torque.case
_linear_load, _iso281_load = bearing.linear_load.case, bearing.iso281_load.case
_mean_equivalent_load, _life_factor = bearing.mean_equivalent_load.case, bearing.life_factor.case
_bearing_life = bearing.life_L50.case


@compiled
def _evaluate(
    phases: FloatArray,
    wishes: FloatArray,
    cycles: FloatArray,
    gears: FloatArray,
    series: tuple[float, float, float, float],
    along_curves: FloatArray,
    motor_torques: FloatArray,
    terms: FloatArray,
    status: ByteArray,
    figures: FloatArray,
) -> None:
    status[:] = ABSENT
    terms[:] = math.nan
    loads = np.empty((1, phases.shape[1], gears.shape[1]))
    for n in range(phases.shape[0]):
        w, cycle = wishes[n], cycles[n]
        loaded, asks_for_property = not math.isnan(w[d.LOAD_COEFFICIENT]), False
        for wish in range(d.BACKLASH, d.TEMPERATURE + 1):
            asks_for_property |= not math.isnan(w[wish])
        if loaded:
            curves = along_curves[n : n + 1] if along_curves.size else along_curves
            _phase_loads(phases[n : n + 1], wishes[n : n + 1], gears, curves, loads)
        for g in range(gears.shape[1]):
            gear, f = gears[:, g], figures[:, n, g]
            f[N_IN_AV] = _average_input_speed(gear[RATIO], cycle[d.N_OUT_AV])
            f[N_IN_MAX] = _maximum_input_speed(gear[RATIO], cycle[d.N_OUT_MAX])
            f[L10] = _life(cycle[d.T_AV], f[N_IN_AV], gear[T_N], series[0], series[1])
            _at_the_motor(w, cycle, gear, f)
            if motor_torques.size and not math.isnan(motor_torques[0, n, g]):
                f[MOTOR_PEAK], f[MOTOR_RATED] = motor_torques[0, n, g], motor_torques[1, n, g]
            put = terms[:, :, n, g]
            _load_limits(w, cycle, gear, f, put)
            f[BEARING_LARGEST] = f[BEARING_MEAN] = f[BEARING_L50] = math.nan
            if loaded:
                _on_the_bearing(w, phases[n], cycle, loads[0, :, g], series, f, put)
            if asks_for_property:
                _properties(w, gear, put)
            _judge(w, put, status[:, n, g])


@compiled
def _phase_loads(
    phases: FloatArray, wishes: FloatArray, gears: FloatArray, along_curves: FloatArray, loads: FloatArray
) -> None:
    """f_w P of every phase on every gear."""
    for n in range(phases.shape[0]):
        f_w, model = wishes[n, d.LOAD_COEFFICIENT], wishes[n, d.MODEL]
        for k in range(phases.shape[1]):
            radial, axial = phases[n, k, d.RADIAL], phases[n, k, d.AXIAL]
            for g in range(gears.shape[1]):
                if model == d.DIGITISED:
                    P = along_curves[n, k, g]
                elif model == d.ISO281:
                    P = _iso281_load(radial / gears[F_R, g], axial / gears[F_A, g])
                else:
                    P = _linear_load(radial / gears[F_R, g], axial / gears[F_A, g])
                loads[n, k, g] = f_w * P


@compiled
def _at_the_motor(w: FloatArray, cycle: FloatArray, gear: FloatArray, f: FloatArray) -> None:
    eta = 1.0 if math.isnan(w[d.EFFICIENCY]) else w[d.EFFICIENCY]
    f[MOTOR_PEAK] = _motor_torque(cycle[d.T_MAX], gear[RATIO], eta)
    f[MOTOR_RATED] = _motor_torque(cycle[d.T_RMS], gear[RATIO], eta)


@compiled
def _upper(put: FloatArray, check: int, demand: float, limit: float) -> None:
    put[DEMAND, check], put[LIMIT, check], put[USED, check] = demand, limit, demand / limit


@compiled
def _lower(put: FloatArray, check: int, demand: float, limit: float) -> None:
    put[DEMAND, check], put[LIMIT, check], put[USED, check] = demand, limit, limit / demand


@compiled
def _load_limits(w: FloatArray, cycle: FloatArray, gear: FloatArray, f: FloatArray, put: FloatArray) -> None:
    """Load limits 1 to 3, input speeds, life and motor."""
    _upper(put, AVERAGE_TORQUE, cycle[d.T_AV], gear[T_N])
    _upper(put, REPEATED_PEAK_TORQUE, cycle[d.T_MAX], gear[T_R])
    put[USED, REPEATED_PEAK_TORQUE] = _repeated_peak_torque_utilisation(cycle[d.T_MAX], gear[T_R])
    T_k, count = w[d.STOP_TORQUE], w[d.STOP_COUNT]
    f[PEAKS] = math.nan
    if not math.isnan(T_k):
        f[PEAKS] = _allowed_momentary_peaks(T_k, gear[T_R])
        _upper(put, MOMENTARY_PEAK_TORQUE, T_k, gear[T_M])
        put[USED, MOMENTARY_PEAK_TORQUE] = _momentary_peak_torque_utilisation(T_k, gear[T_M])
    if not math.isnan(count):
        _upper(put, MOMENTARY_PEAK_COUNT, count, f[PEAKS])
        if (
            f[PEAKS] == 0
        ):  # where no stop at all is allowed the check fails without a utilisation, even for a count of 0
            put[USED, MOMENTARY_PEAK_COUNT] = math.inf
    _upper(put, AVERAGE_INPUT_SPEED, f[N_IN_AV], gear[N_AV])
    _upper(put, MAXIMUM_INPUT_SPEED, f[N_IN_MAX], gear[N_MAX])
    if not math.isnan(w[d.LIFE]):
        _lower(put, LIFE, f[L10], w[d.LIFE])
    if not math.isnan(w[d.MOTOR_SPEED]):
        _upper(put, MOTOR_SPEED, f[N_IN_MAX], w[d.MOTOR_SPEED])
    if not math.isnan(w[d.MOTOR_PEAK]):
        _upper(put, MOTOR_PEAK_TORQUE, f[MOTOR_PEAK], w[d.MOTOR_PEAK])
    if not math.isnan(w[d.MOTOR_RATED]):
        _upper(put, MOTOR_RATED_TORQUE, f[MOTOR_RATED], w[d.MOTOR_RATED])


@compiled
def _on_the_bearing(
    w: FloatArray,
    phases: FloatArray,
    cycle: FloatArray,
    loads: FloatArray,
    series: tuple[float, float, float, float],
    f: FloatArray,
    put: FloatArray,
) -> None:
    mean = _mean_equivalent_load(loads, phases[:, d.SPEED], phases[:, d.DURATION])
    k = _life_factor(cycle[d.N_OUT_AV], w[d.BEARING_L50], series[2], series[3])
    f[BEARING_LARGEST], f[BEARING_MEAN] = loads.max(), mean
    f[BEARING_L50] = _bearing_life(mean, cycle[d.N_OUT_AV], series[2], series[3])
    _upper(put, OUTPUT_BEARING_LOAD, f[BEARING_LARGEST], 1.0)
    _upper(put, OUTPUT_BEARING_LIFE, mean, k)


@compiled
def _properties(w: FloatArray, gear: FloatArray, put: FloatArray) -> None:
    if not math.isnan(w[d.TEMPERATURE]):
        middle, half = (gear[LOWEST] + gear[HIGHEST]) / 2, (gear[HIGHEST] - gear[LOWEST]) / 2
        put[DEMAND, AMBIENT_TEMPERATURE] = w[d.TEMPERATURE]
        bound = gear[HIGHEST] if w[d.TEMPERATURE] >= middle else gear[LOWEST]
        put[LIMIT, AMBIENT_TEMPERATURE] = math.nan if math.isnan(middle) else bound
        put[USED, AMBIENT_TEMPERATURE] = abs(w[d.TEMPERATURE] - middle) / half
    if not math.isnan(w[d.BACKLASH]):
        _upper(put, BACKLASH, gear[PLAY], w[d.BACKLASH])
    if not math.isnan(w[d.STIFFNESS]):
        _lower(put, TORSIONAL_STIFFNESS, gear[K3], w[d.STIFFNESS])
    if not math.isnan(w[d.WEIGHT]):
        _upper(put, WEIGHT, gear[MASS], w[d.WEIGHT])
    if not math.isnan(w[d.LENGTH]):
        _upper(put, LENGTH, gear[LENGTH_MAX], w[d.LENGTH])


@compiled
def _judge(w: FloatArray, put: FloatArray, status: ByteArray) -> None:
    """Pass, fail or not rated: a load check against the user's own utilisation u, a property check against 1."""
    for check in range(status.size):
        used = put[USED, check]
        if math.isnan(put[DEMAND, check]) and math.isnan(put[LIMIT, check]):
            continue
        bound = (w[d.UTILISATION] if check < LOAD_CHECKS else 1.0) * (1 + equations.ROUNDING)
        status[check] = NOT_RATED if math.isnan(used) else PASS if used <= bound else FAIL
