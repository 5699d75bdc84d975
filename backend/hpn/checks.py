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


def allowed(code: str | None, utilisation: float) -> float:
    """Largest utilisation with which a check passes: the user's own for a load check, 1 for another, or for none."""
    return utilisation if code is not None and EXPLANATIONS[code].group == "load" else 1.0


MOST_DECIMALS = 10


@compiled
def telling_decimals(value: float, bound: float, least: int) -> int:
    """Decimals with which a value, once rounded, still lies on its own side of a bound, `least` at least."""
    if abs(value - bound) > 1 + equations.ROUNDING * abs(bound):
        return least  # to round it moves it by half at most
    decimals = least
    while decimals < MOST_DECIMALS and _side(np.round(value, decimals), bound) != _side(value, bound):
        decimals += 1
    return decimals


@compiled
def _side(value: float, bound: float) -> int:
    if abs(value / bound - 1) <= equations.ROUNDING:
        return 0
    return 1 if value > bound else -1


DEMAND, LIMIT, USED = range(3)
"""Places along the last axis of `Evaluation.numbers`; utilisation is the last."""

COUNT = len(CHECKS)
VERDICT, GOVERNING = COUNT, COUNT + 1
"""Places along the last axis of `Evaluation.codes`, behind the checks."""

FIGURES = 9
N_IN_AV, N_IN_MAX, L10, PEAKS, BEARING_L50, MOTOR_PEAK, MOTOR_RATED, BEARING_MEAN, BEARING_LARGEST = range(FIGURES)
"""Places along the last axis of `Evaluation.figures`, which fill rows of three behind the checks."""

T_N, T_R, T_M, N_AV, N_MAX, RATIO, F_R, F_A, LOWEST, HIGHEST, PLAY, K3, MASS, LENGTH_MAX = range(14)
"""Columns of a table of gears."""


@dataclass(slots=True)
class Evaluation:
    """Checks of N applications on G gears, and how the gears stand.

    `numbers` (N, G, 20, 3) are demand, limit and utilisation of every check, the last infinite where a check fails
    without one; behind the checks stand the `figures` that they derive from. `codes` (N, G, 19) are PASS, FAIL,
    NOT_RATED or ABSENT for every check, and the gear's verdict and governing check (see `ranking.py`). `order` (N, G)
    are the places of the gears among `gears`, from best to last; `unlimited` (N, 9) tells which figures are infinite on
    any gear.
    """

    duty: Duty
    gears: GearList
    catalogue: Catalogue
    numbers: FloatArray
    codes: ByteArray
    order: NDArray[np.intp]
    unlimited: NDArray[np.bool_]

    def asked(self, index: int) -> tuple[int, ...]:
        """Checks that application `index` asks for."""
        return _present(self.codes[index, 0].tobytes())

    @property
    def figures(self) -> FloatArray:
        """What the checks derive from, shape (N, G, 9)."""
        return self.numbers[:, :, COUNT:].reshape(*self.numbers.shape[:2], -1)

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

    def _figure(self, place: int) -> FloatArray:
        figure: FloatArray = self.figures[:, :, place]
        return figure

    def bearing_life_factor(self, index: int) -> float:
        """Load factor k that speed and required life of application `index` allow."""
        return self.numbers.item((index, 0, OUTPUT_BEARING_LIFE, LIMIT))

    def bearing_loads(self) -> FloatArray:
        """Equivalent load f_w P of every phase on every gear, shape (N, phases, G); NaN where it is not rated."""
        loads = np.empty((*self.duty.phases.shape[:2], len(self.gears.rows)))
        _phase_loads(
            self.duty.phases, self.duty.wishes, table_of(self.gears), along_curves(self.duty, self.gears), loads
        )
        return loads


@lru_cache(maxsize=1024)
def _present(codes: bytes) -> tuple[int, ...]:
    return tuple(check for check, state in enumerate(codes[:COUNT]) if state != ABSENT)


@lru_cache(maxsize=1024)
def table_of(gears: GearList) -> FloatArray:
    """Figures of gears as a table, shape (G, figures)."""
    g = gears.columns
    table = np.column_stack(
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


# --- What a supplement may bring: curves ------------------------------------------------------------------------------

_NO_CURVES = np.empty((0, 0, 0))


def along_curves(duty: Duty, gears: GearList) -> FloatArray:
    """Equivalent loads along supplied curve points, shape (N, phases, G), where an application asks for them."""
    asked = [index for index, load in enumerate(duty.loads) if load and load.model == "digitised"]
    if not asked:
        return _NO_CURVES
    radial, axial = duty.loads_N
    loads = np.full((*radial.shape, len(gears.rows)), np.nan)
    for column, curve in enumerate(gears.curves):
        if curve is not None:
            loads[asked, :, column] = curve.equivalent_load(radial[asked], axial[asked])
    return loads


def motor_torques(duty: Duty, gears: GearList, catalogue: Catalogue) -> FloatArray:
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
def run_checks(
    phases: FloatArray,
    wishes: FloatArray,
    cycles: FloatArray,
    gears: FloatArray,
    series: tuple[float, float, float, float],
    curved_loads: FloatArray,
    curved_torques: FloatArray,
    numbers: FloatArray,
    codes: ByteArray,
    unlimited: NDArray[np.bool_],
) -> None:
    """Every check that the applications ask for, on every gear.

    Its parts take whole arrays and the places n, g in them: to cut out a row costs as much as a check on it.
    """
    numbers.fill(math.nan)
    figures = numbers.reshape((*codes.shape[:2], 3 * numbers.shape[2]))[:, :, 3 * COUNT :]
    loads = np.empty((1, phases.shape[1], gears.shape[0]))
    for n in range(phases.shape[0]):
        loaded, asks_for_property = not math.isnan(wishes[n, d.LOAD_COEFFICIENT]), False
        for wish in range(d.BACKLASH, d.TEMPERATURE + 1):
            asks_for_property |= not math.isnan(wishes[n, wish])
        if loaded:
            curves = curved_loads[n : n + 1] if curved_loads.size else curved_loads
            _phase_loads(phases[n : n + 1], wishes[n : n + 1], gears, curves, loads)
        _work_out(wishes, cycles, gears, series, curved_torques, n, figures)
        for g in range(gears.shape[0]):
            _load_limits(wishes, cycles, gears, figures, n, g, numbers)
            if loaded:
                _on_the_bearing(phases[n], wishes, cycles, loads[0, :, g], series, n, g, figures, numbers)
            if asks_for_property:
                _properties(wishes, gears, n, g, numbers)
            _judge(wishes, numbers, n, g, codes)
        unlimited[n] = False
        for g in range(gears.shape[0]):
            for figure in range(figures.shape[2]):
                unlimited[n, figure] |= math.isinf(figures[n, g, figure])


@compiled
def _phase_loads(
    phases: FloatArray, wishes: FloatArray, gears: FloatArray, curved_loads: FloatArray, loads: FloatArray
) -> None:
    """f_w P of every phase on every gear."""
    for n in range(phases.shape[0]):
        f_w, model = wishes[n, d.LOAD_COEFFICIENT], wishes[n, d.MODEL]
        for k in range(phases.shape[1]):
            radial, axial = phases[n, k, d.RADIAL], phases[n, k, d.AXIAL]
            for g in range(gears.shape[0]):
                if model == d.DIGITISED:
                    P = curved_loads[n, k, g]
                elif model == d.ISO281:
                    P = _iso281_load(radial / gears[g, F_R], axial / gears[g, F_A])
                else:
                    P = _linear_load(radial / gears[g, F_R], axial / gears[g, F_A])
                loads[n, k, g] = f_w * P


@compiled
def _work_out(
    wishes: FloatArray,
    cycles: FloatArray,
    gears: FloatArray,
    series: tuple[float, float, float, float],
    curved_torques: FloatArray,
    n: int,
    figures: FloatArray,
) -> None:
    """What the checks derive from; that of the output bearing only where it is loaded."""
    T_k, eta = wishes[n, d.STOP_TORQUE], 1.0 if math.isnan(wishes[n, d.EFFICIENCY]) else wishes[n, d.EFFICIENCY]
    for g in range(gears.shape[0]):  # a loop for each kind: the shorter, the faster
        n_in_av = _average_input_speed(gears[g, RATIO], cycles[n, d.N_OUT_AV])
        figures[n, g, N_IN_AV] = n_in_av
        figures[n, g, N_IN_MAX] = _maximum_input_speed(gears[g, RATIO], cycles[n, d.N_OUT_MAX])
        figures[n, g, L10] = _life(cycles[n, d.T_AV], n_in_av, gears[g, T_N], series[0], series[1])
    if not math.isnan(T_k):
        for g in range(gears.shape[0]):
            figures[n, g, PEAKS] = _allowed_momentary_peaks(T_k, gears[g, T_R])
    for g in range(gears.shape[0]):
        figures[n, g, MOTOR_PEAK] = _motor_torque(cycles[n, d.T_MAX], gears[g, RATIO], eta)
        figures[n, g, MOTOR_RATED] = _motor_torque(cycles[n, d.T_RMS], gears[g, RATIO], eta)
        if curved_torques.size and not math.isnan(curved_torques[0, n, g]):
            figures[n, g, MOTOR_PEAK], figures[n, g, MOTOR_RATED] = curved_torques[0, n, g], curved_torques[1, n, g]


@compiled
def _upper(terms: FloatArray, n: int, g: int, check: int, demand: float, limit: float) -> None:
    terms[n, g, check, DEMAND], terms[n, g, check, LIMIT], terms[n, g, check, USED] = demand, limit, demand / limit


@compiled
def _lower(terms: FloatArray, n: int, g: int, check: int, demand: float, limit: float) -> None:
    terms[n, g, check, DEMAND], terms[n, g, check, LIMIT], terms[n, g, check, USED] = demand, limit, limit / demand


@compiled
def _load_limits(
    wishes: FloatArray, cycles: FloatArray, gears: FloatArray, figures: FloatArray, n: int, g: int, terms: FloatArray
) -> None:
    """Load limits 1 to 3, input speeds, life and motor."""
    T_av, T_max, T_k = cycles[n, d.T_AV], cycles[n, d.T_MAX], wishes[n, d.STOP_TORQUE]
    _upper(terms, n, g, AVERAGE_TORQUE, T_av, gears[g, T_N])
    _upper(terms, n, g, REPEATED_PEAK_TORQUE, T_max, gears[g, T_R])
    terms[n, g, REPEATED_PEAK_TORQUE, USED] = _repeated_peak_torque_utilisation(T_max, gears[g, T_R])
    if not math.isnan(T_k):
        _upper(terms, n, g, MOMENTARY_PEAK_TORQUE, T_k, gears[g, T_M])
        terms[n, g, MOMENTARY_PEAK_TORQUE, USED] = _momentary_peak_torque_utilisation(T_k, gears[g, T_M])
    if not math.isnan(wishes[n, d.STOP_COUNT]):
        _upper(terms, n, g, MOMENTARY_PEAK_COUNT, wishes[n, d.STOP_COUNT], figures[n, g, PEAKS])
        if figures[n, g, PEAKS] == 0:  # no stop at all is allowed: fails without a utilisation, even for a count of 0
            terms[n, g, MOMENTARY_PEAK_COUNT, USED] = math.inf
    _upper(terms, n, g, AVERAGE_INPUT_SPEED, figures[n, g, N_IN_AV], gears[g, N_AV])
    _upper(terms, n, g, MAXIMUM_INPUT_SPEED, figures[n, g, N_IN_MAX], gears[g, N_MAX])
    if not math.isnan(wishes[n, d.LIFE]):
        _lower(terms, n, g, LIFE, figures[n, g, L10], wishes[n, d.LIFE])
    if not math.isnan(wishes[n, d.MOTOR_SPEED]):
        _upper(terms, n, g, MOTOR_SPEED, figures[n, g, N_IN_MAX], wishes[n, d.MOTOR_SPEED])
    if not math.isnan(wishes[n, d.MOTOR_PEAK]):
        _upper(terms, n, g, MOTOR_PEAK_TORQUE, figures[n, g, MOTOR_PEAK], wishes[n, d.MOTOR_PEAK])
    if not math.isnan(wishes[n, d.MOTOR_RATED]):
        _upper(terms, n, g, MOTOR_RATED_TORQUE, figures[n, g, MOTOR_RATED], wishes[n, d.MOTOR_RATED])


@compiled
def _on_the_bearing(
    phases: FloatArray,
    wishes: FloatArray,
    cycles: FloatArray,
    loads: FloatArray,
    series: tuple[float, float, float, float],
    n: int,
    g: int,
    figures: FloatArray,
    terms: FloatArray,
) -> None:
    mean, n_out_av = _mean_equivalent_load(loads, phases[:, d.SPEED], phases[:, d.DURATION]), cycles[n, d.N_OUT_AV]
    k = _life_factor(n_out_av, wishes[n, d.BEARING_L50], series[2], series[3])
    figures[n, g, BEARING_LARGEST], figures[n, g, BEARING_MEAN] = loads.max(), mean
    figures[n, g, BEARING_L50] = _bearing_life(mean, n_out_av, series[2], series[3])
    _upper(terms, n, g, OUTPUT_BEARING_LOAD, figures[n, g, BEARING_LARGEST], 1.0)
    _upper(terms, n, g, OUTPUT_BEARING_LIFE, mean, k)


@compiled
def _properties(wishes: FloatArray, gears: FloatArray, n: int, g: int, terms: FloatArray) -> None:
    wanted = wishes[n, d.TEMPERATURE]
    if not math.isnan(wanted):
        lowest, highest = gears[g, LOWEST], gears[g, HIGHEST]
        middle, half = (lowest + highest) / 2, (highest - lowest) / 2
        bound = math.nan if math.isnan(middle) else highest if wanted >= middle else lowest
        _upper(terms, n, g, AMBIENT_TEMPERATURE, wanted, bound)
        terms[n, g, AMBIENT_TEMPERATURE, USED] = abs(wanted - middle) / half
    if not math.isnan(wishes[n, d.BACKLASH]):
        _upper(terms, n, g, BACKLASH, gears[g, PLAY], wishes[n, d.BACKLASH])
    if not math.isnan(wishes[n, d.STIFFNESS]):
        _lower(terms, n, g, TORSIONAL_STIFFNESS, gears[g, K3], wishes[n, d.STIFFNESS])
    if not math.isnan(wishes[n, d.WEIGHT]):
        _upper(terms, n, g, WEIGHT, gears[g, MASS], wishes[n, d.WEIGHT])
    if not math.isnan(wishes[n, d.LENGTH]):
        _upper(terms, n, g, LENGTH, gears[g, LENGTH_MAX], wishes[n, d.LENGTH])


@compiled
def _judge(wishes: FloatArray, terms: FloatArray, n: int, g: int, codes: ByteArray) -> None:
    """Pass, fail or not rated: a load check against the user's own utilisation u, a property check against 1."""
    for check in range(COUNT):
        used = terms[n, g, check, USED]
        bound = (wishes[n, d.UTILISATION] if check < LOAD_CHECKS else 1.0) * (1 + equations.ROUNDING)
        if math.isnan(terms[n, g, check, DEMAND]) and math.isnan(terms[n, g, check, LIMIT]):
            codes[n, g, check] = ABSENT
        else:
            codes[n, g, check] = NOT_RATED if math.isnan(used) else PASS if used <= bound else FAIL
