"""Candidates side by side: their figures row by row, the best in each row, and those that no other outdoes."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from hpn.catalogue import Catalogue
from hpn.catalogue.gear import Gear
from hpn.engine.candidates import Candidate
from hpn.engine.selection import Selection
from hpn.physics import equations
from hpn.words.wording import N_, Quantity, Sentence, listed

Kind = Literal["figure", "percent", "words"]
MOST_PINS = 4


@dataclass(frozen=True, slots=True)
class Column:
    """One gear of the comparison: its entry in the reply, and its catalogue figures."""

    candidate: Candidate
    gear: Gear


@dataclass(frozen=True, slots=True)
class Row:
    """One quantity of all gears compared; `best` are the columns that are ahead, none where all are equal.

    `unit` is a suffix; figures are in the units of the wire, None is not published or not asked for.
    """

    code: str
    title: str
    symbol: str
    unit: str
    kind: Kind
    values: tuple[float | Sentence | None, ...]
    best: frozenset[int]


@dataclass(frozen=True, slots=True)
class RowGroup:
    """Rows under one heading."""

    title: str
    rows: tuple[Row, ...]


# --- Rows -------------------------------------------------------------------------------------------------------------

Read = Callable[[Column], float | Sentence | None]


def _figure(name: str) -> Read:
    return lambda column: getattr(column.gear, name)


def _result(name: str) -> Read:
    """A figure of the reply; infinite where it is empty because nothing limits it."""
    return lambda column: math.inf if column.candidate.is_unlimited(name) else getattr(column.candidate, name)


def groups_of(
    columns: Sequence[Column], maximum_torque_Nm: float, checks: Mapping[str, str], *, at_rest: bool = False
) -> tuple[RowGroup, ...]:
    """The comparison. `checks` are the titles of the checks that the application asks for, by code; `at_rest` says that
    the position error is that of rest alone.
    """
    return (
        RowGroup(N_("Utilisation"), tuple(_utilisations(columns, checks))),
        RowGroup(N_("Life and drive"), tuple(_results(columns, maximum_torque_Nm))),
        RowGroup(N_("Stiffness and accuracy"), tuple(_accuracies(columns, at_rest=at_rest))),
        RowGroup(N_("Ratings"), tuple(_ratings(columns))),
        RowGroup(N_("Size and mounting"), tuple(_mounting(columns))),
    )


def _utilisations(columns: Sequence[Column], checks: Mapping[str, str]) -> Iterable[Row]:
    def read(code: str) -> Read:
        return lambda column: check.utilisation if (check := column.candidate.check(code)) else None

    for code, title in checks.items():
        yield _row(columns, code, title, read(code), lowest=True, kind="percent")


def _results(columns: Sequence[Column], maximum_torque_Nm: float) -> Iterable[Row]:
    yield _row(columns, "life", N_("Life"), _result("life_L10_h"), "L_10", "h", lowest=False)
    if any(column.candidate.momentary_peak_count is not None for column in columns):
        stops = _result("momentary_peak_count")
        yield _row(columns, "stops", N_("Permitted stops"), stops, "N_k,max", lowest=False)
    if any(column.candidate.bearing_life_L50_h is not None for column in columns):
        bearing_life = _result("bearing_life_L50_h")
        yield _row(columns, "bearing_life", N_("Bearing life"), bearing_life, "L_b,50", "h", lowest=False)
    peak, average = _result("motor_peak_torque_Nm"), _result("average_input_speed_rpm")
    yield _row(columns, "motor_torque", _motor_title(columns, maximum_torque_Nm), peak, "", "Nm", lowest=True)
    limit = _result("motor_torque_limit_Nm")
    yield _row(columns, "torque_limit", N_("Torque limit of the drive"), limit, "T_lim", "Nm")
    yield _row(columns, "input_speed", N_("Average input speed"), average, "n_in,av", "rpm")
    largest = _result("maximum_input_speed_rpm")
    yield _row(columns, "largest_input_speed", N_("Maximum input speed"), largest, "n_in,max", "rpm")


def _motor_title(columns: Sequence[Column], maximum_torque_Nm: float) -> str:
    loss_free = maximum_torque_Nm * (1 + equations.ROUNDING)
    if any((column.candidate.motor_peak_torque_Nm or 0.0) * column.gear.ratio <= loss_free for column in columns):
        return N_("Peak torque at the motor, a lower bound where η is 1")
    return N_("Peak torque at the motor")


def _accuracies(columns: Sequence[Column], *, at_rest: bool) -> Iterable[Row]:
    backlash, accuracy = _figure("backlash_arcmin"), _figure("transmission_accuracy_arcmin")
    stiffness = _figure("torsional_stiffness_Nm_per_rad")
    wind_up = _result("wind_up_arcmin")
    yield _row(columns, "wind_up", N_("Wind-up at T_max"), wind_up, "φ_w", "arcmin", lowest=True)
    yield _row(columns, "backlash", N_("Backlash, at most"), backlash, "j", "arcmin", lowest=True)
    yield _row(columns, "accuracy", N_("Transmission accuracy, at most"), accuracy, "", "arcmin", lowest=True)
    yield _row(columns, "stiffness", N_("Torsional stiffness"), stiffness, "K_3", "Nm_per_rad", lowest=False)
    if any(column.candidate.natural_frequency_Hz is not None for column in columns):
        held = _result("natural_frequency_Hz")
        yield _row(columns, "frequency", N_("Natural frequency, at most"), held, "f_1", "Hz", lowest=False)
    error, name = _result("position_error_arcmin"), N_("Position error, about")
    if at_rest:
        name = N_("Position error at rest, about")
    yield _row(columns, "position_error", name, error, "φ_e", "arcmin", lowest=True)


def _ratings(columns: Sequence[Column]) -> Iterable[Row]:
    for name, title, symbol in (
        ("rated_torque_Nm", N_("Rated torque"), "T_N"),
        ("repeated_peak_torque_Nm", N_("Repeated peak torque"), "T_R"),
        ("momentary_peak_torque_Nm", N_("Momentary peak torque"), "T_M"),
        ("average_input_speed_rpm", N_("Average input speed, limit"), "n_av(max)"),
        ("maximum_input_speed_rpm", N_("Maximum input speed, limit"), "n_in(max)"),
    ):
        yield _row(columns, name, title, _figure(name), symbol, name.rpartition("_")[2], lowest=False)


def _mounting(columns: Sequence[Column]) -> Iterable[Row]:
    weight, length, longest = _figure("weight_kg"), _figure("length_min_mm"), _figure("length_max_mm")
    yield _row(columns, "weight", N_("Weight"), weight, "m", "kg", lowest=True)
    yield _row(columns, "length", N_("Length, at least"), length, "L_min", "mm", lowest=True)
    yield _row(columns, "longest", N_("Length, at most"), longest, "L_max", "mm", lowest=True)
    yield _row(columns, "housing_bolts", N_("Housing bolts"), _housing_bolts, kind="words")
    yield _row(columns, "clamp_bolts", N_("Motor coupling bolt"), _clamp_bolts, kind="words")


def _row(
    columns: Sequence[Column],
    code: str,
    title: str,
    read: Read,
    symbol: str = "",
    unit: str = "",
    *,
    lowest: bool | None = None,
    kind: Kind = "figure",
) -> Row:
    """Row of the values that `read` gives for every column; without `lowest` no column is better than another."""
    values = tuple(map(read, columns))
    numbers = np.array([value if isinstance(value, float | int) else np.nan for value in values])
    known = ~np.isnan(numbers)
    places = equations.tied(numbers if lowest else -numbers)
    is_ahead = (places == 0) & known & (lowest is not None and np.unique(places[known]).size > 1)
    return Row(code, title, symbol, unit, kind, values, frozenset(np.flatnonzero(is_ahead).tolist()))


def _housing_bolts(column: Column) -> Sentence | None:
    bolts = column.gear.housing_bolts
    if bolts is None or bolts.bolt_size is None:
        return None
    parts = [Sentence("{number} × {bolt}", {"number": bolts.number_of_bolts or "?", "bolt": bolts.bolt_size})]
    if bolts.pitch_diameter_mm is not None:
        parts.append(Sentence("Ø\u00a0{diameter}", {"diameter": Quantity(bolts.pitch_diameter_mm, "mm", 4)}))
    if bolts.tightening_torque_Nm is not None:
        parts.append(Sentence("{torque}", {"torque": Quantity(bolts.tightening_torque_Nm, "Nm", 4)}))
    return listed(parts)


def _clamp_bolts(column: Column) -> Sentence | None:
    parts = [
        Sentence("{bolt}", {"bolt": bolt.bolt_size})
        if bolt.tightening_torque_Nm is None
        else Sentence(
            "{bolt} {torque}", {"bolt": bolt.bolt_size, "torque": Quantity(bolt.tightening_torque_Nm, "Nm", 4)}
        )
        for bolt in column.gear.clamp_bolts
    ]
    return listed(parts, Sentence(N_("{first} or {rest}")).template) if parts else None


# --- Not dominated (Pareto) -------------------------------------------------------------------------------------------


def undominated(candidates: Sequence[Candidate], catalogue: Catalogue) -> frozenset[str]:
    """Designations of the suitable gears that no other suitable one outdoes (Pareto).

    A gear outdoes another if it is nowhere worse and somewhere better: in weight, utilisation, torsional stiffness,
    largest length and peak torque at the motor. An unpublished figure counts as worst.
    """
    suitable = [candidate for candidate in candidates if candidate.status == "suitable"]
    if not suitable:
        return frozenset()
    costs = np.array([_costs(candidate, catalogue.by_designation[candidate.designation]) for candidate in suitable])
    table = equations.tied(costs.T).T
    nowhere_worse = (table[:, None] <= table[None]).all(axis=2)
    outdone = np.any(nowhere_worse & (table[:, None] < table[None]).any(axis=2), axis=0)
    return frozenset(suitable[place].designation for place in np.flatnonzero(~outdone).tolist())


def _costs(candidate: Candidate, gear: Gear) -> tuple[float, ...]:
    stiffness = gear.torsional_stiffness_Nm_per_rad
    costs = (
        gear.weight_kg,
        candidate.utilisation,
        None if stiffness is None else -stiffness,
        gear.length_max_mm,
        candidate.motor_peak_torque_Nm,
    )
    return tuple(np.inf if cost is None else cost for cost in costs)


# --- Lighter ----------------------------------------------------------------------------------------------------------


def lighter_miss(selection: Selection, designation: str | None, gears: Mapping[str, Gear]) -> Candidate | None:
    """The rejected gear closest to passing among those that are judged and lighter than another; None without one."""
    weight = _weight(designation, gears)
    if weight is None:
        return None
    for candidate in selection.candidates:
        own = _weight(candidate.designation, gears)
        if candidate.status == "unsuitable" and own is not None and own < weight and candidate.is_judged:
            return candidate
    return None


def _weight(designation: str | None, gears: Mapping[str, Gear]) -> float | None:
    gear = gears.get(designation or "")
    return gear.weight_kg if gear else None
