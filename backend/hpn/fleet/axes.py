"""Axes in list form as arrays: which of them are sound, and what the engine takes of them.

No object is made for an axis. The bounds are those of the models, and the rules between columns are the models' own on
arrays; an axis that breaks one is told why by the models themselves (`faults.py`), so that its reasons read the same.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray

from hpn.application import LEAST_MOTION, LISTED_FIGURES, MOST_WISHES, NUMBERS, InputError
from hpn.application.phase import ROOM
from hpn.catalogue import Catalogue, GearList, ListedMotor
from hpn.engine.allowed import gears_allowed
from hpn.engine.batch import chunks_of
from hpn.engine.duty import Asked, Duty, Phases, TextArray
from hpn.fleet.columns import AXIS, COLUMNS, Column
from hpn.physics.equations import FloatArray
from hpn.words.designations import canonical_size
from hpn.words.fields import MAXIMUM_PHASES

BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.intp]

LOADS = ("radial_N", "axial_N")
LOAD_CONDITIONS = tuple(name for name in COLUMNS.others if name.startswith("output_load."))
SIZES, RATIOS, MODEL, BASIS = "requirements.sizes", "requirements.ratios", "output_load.model", "output_load.life_basis"
MOTOR, INERTIA_RATIO = "requirements.motor.designation", "requirements.motor.inertia_ratio"
LISTED = {name: f"requirements.motor.{name}" for name in LISTED_FIGURES}


def have_sound_lists(table: pa.Table) -> BoolArray:
    """Which axes have lists of phases of one length, no longer than a duty cycle may be, shape (N,)."""
    lengths = {name: _lengths(table[name]) for name in COLUMNS.phases if name in table.column_names}
    count = lengths["torque_Nm"]
    mask: BoolArray = np.asarray(pc.is_valid(table[AXIS])) & (count >= 1) & (count <= MAXIMUM_PHASES)
    for name, length in lengths.items():
        mask &= (length == count) | ((length < 0) & (not COLUMNS.phases[name].required))
    return mask


def _lengths(column: pa.ChunkedArray) -> IntArray:
    """Lengths of lists, -1 for null."""
    return np.asarray(pc.fill_null(pc.list_value_length(column), -1)).astype(np.intp)


VARYING = {"peak_torque_Nm": "torque_Nm", "peak_speed_rpm": "speed_rpm", "rms_torque_Nm": "torque_Nm"}
"""Figures of phases that vary, and what they are of a steady one."""


class Axes:
    """Axes of a table in list form whose lists of phases are sound: N axes, all their phases one after another."""

    def __init__(self, table: pa.Table) -> None:
        self.table = table
        self.count = table.num_rows
        self.phase_counts = _lengths(table["torque_Nm"])
        self.starts = np.concatenate((np.zeros(1, np.intp), np.cumsum(self.phase_counts)))[:-1]
        self._cells: dict[str, FloatArray] = {}

    # --- Cells --------------------------------------------------------------------------------------------------------

    def has(self, name: str) -> bool:
        """Whether the table has a column with anything in it."""
        return name in self.table.column_names and self.table[name].null_count < self.count

    def cells(self, name: str) -> FloatArray:
        """Numbers of a column, of shape (N,), or of a field of the phases, of shape (all phases,).

        NaN where none is given; infinite where NaN is.
        """
        if name not in self._cells:
            self._cells[name] = self._read(name)
        return self._cells[name]

    def _read(self, name: str) -> FloatArray:
        is_of_phases = name in COLUMNS.phases
        values = np.full(self.phase_counts.sum() if is_of_phases else self.count, np.nan)
        if not self.has(name):
            return values
        column = self.table[name]
        if not is_of_phases:
            return _values(column)
        given = np.repeat(np.asarray(pc.is_valid(column)), self.phase_counts)
        values[given] = _values(pc.list_flatten(column))
        return values

    def texts(self, name: str) -> TextArray:
        """Texts of a column, shape (N,); empty where none is given."""
        if not self.has(name):
            return np.broadcast_to(np.array(""), (self.count,))
        texts = pc.cast(self.table[name], pa.string())
        return np.asarray(pc.if_else(pc.is_null(texts), "", pc.if_else(pc.equal(texts, ""), "?", texts)), dtype=np.str_)

    def lists(self, name: str) -> list[list[Any] | None]:
        """Lists of a column."""
        return list(self.table[name].to_pylist()) if self.has(name) else [None] * self.count

    def is_given(self, name: str) -> BoolArray:
        """Which axes have something in a column, shape (N,)."""
        return np.asarray(pc.is_valid(self.table[name])) if self.has(name) else np.zeros(self.count, np.bool_)

    # --- Rules --------------------------------------------------------------------------------------------------------

    @cached_property
    def are_sound(self) -> BoolArray:
        """Which axes the models would take, shape (N,); which gears there are is not their business."""
        mask = np.ones(self.count, np.bool_)
        for name, column in COLUMNS.all.items():
            if not self.has(name):
                continue
            if column.choices:
                mask &= np.isin(self.texts(name), ("", *column.choices))
            elif name in COLUMNS.phases:
                mask &= ~self._in_any_phase(~_in_bounds(column, self.cells(name)))
            elif column.kind != "string" and not column.is_list:
                mask &= _in_bounds(column, self.cells(name))
        with np.errstate(all="ignore"):  # what is out of its bounds is refused for that
            return mask & self._in_any_phase(self._moving) & self._keep_rules

    @property
    def _moving(self) -> BoolArray:
        moving: BoolArray = np.abs(self.cells("speed_rpm")) * self.cells("duration_s") > LEAST_MOTION
        return moving

    @property
    def _keep_rules(self) -> BoolArray:
        """Whether a load is there where its conditions are given, and a torque where stops are counted."""
        conditions = np.logical_or.reduce([self.is_given(name) for name in LOAD_CONDITIONS])
        counted, stops = self.is_given("emergency_stop.count"), self.is_given("emergency_stop.torque_Nm")
        loads_and_stops = (self.are_loaded | ~conditions) & (stops | ~counted)
        result: BoolArray = loads_and_stops & self._know_their_motors & self._vary_within_peaks
        return result

    @property
    def _know_their_motors(self) -> BoolArray:
        """Whether a motor has either a name or figures, and an inertia ratio both inertias."""
        named, figures = self.is_given(MOTOR), np.logical_or.reduce([self.is_given(path) for path in LISTED.values()])
        inertias = (named | self.is_given(LISTED["inertia_kgm2"])) & self.is_given("requirements.load_inertia_kgm2")
        result: BoolArray = ~(named & figures) & (inertias | ~self.is_given(INERTIA_RATIO))
        return result

    @property
    def _vary_within_peaks(self) -> BoolArray:
        """Whether no phase has a peak below its own torque or speed, nor an RMS above its peak."""
        T, n = np.abs(self.cells("torque_Nm")), np.abs(self.cells("speed_rpm"))
        peak_T, peak_n, rms = (self.cells(name) for name in ("peak_torque_Nm", "peak_speed_rpm", "rms_torque_Nm"))
        wrong = (peak_T < T * (1 - ROOM)) | (peak_n < n * (1 - ROOM)) | ((n == 0) & (peak_n > 0))
        wrong |= rms > np.where(np.isnan(peak_T), T, peak_T) * (1 + ROOM)
        return ~self._in_any_phase(wrong)

    @cached_property
    def are_loaded(self) -> BoolArray:
        """Which axes carry a load, in a phase or all the time, shape (N,)."""
        mask = np.zeros(self.count, np.bool_)
        for name in LOADS:
            if self.has(name):
                mask |= self._in_any_phase(~np.isnan(self.cells(name)))
            mask |= self.is_given(f"output_load.{name}")
        return mask

    def _in_any_phase(self, holds: BoolArray) -> BoolArray:
        return np.logical_or.reduceat(holds, self.starts) if self.count else np.zeros(0, np.bool_)

    # --- What the engine takes ----------------------------------------------------------------------------------------

    def gears(self, catalogue: Catalogue) -> "Allowed":
        """Gears that each axis allows; none where it is refused as `select` refuses it."""
        if not any(map(self.has, (SIZES, RATIOS, MODEL))):
            return Allowed([_allowed(None, None, "", catalogue)], np.zeros(self.count, np.intp))
        numbers: dict[tuple[Any, ...], int] = {}
        wishes = zip(
            map(_key, self.lists(SIZES)), map(_key, self.lists(RATIOS)), self.texts(MODEL).tolist(), strict=True
        )
        which = np.array([numbers.setdefault(key, len(numbers)) for key in wishes], np.intp)
        lists = [_allowed(sizes, ratios, model, catalogue) for sizes, ratios, model in numbers]
        return Allowed(lists, which)

    def have_motors(self, catalogue: Catalogue) -> BoolArray:
        """Which axes have the motor that they name, with the inertia that an inertia ratio needs, shape (N,)."""
        named, ratios = self.is_given(MOTOR), self.is_given(INERTIA_RATIO)
        listed = self._name_one_of(catalogue.motors)
        turning = self._name_one_of(motor for motor in catalogue.motors if motor.inertia_kgm2 is not None)
        return ~named | (listed & (turning | ~ratios))

    def _name_one_of(self, motors: Iterable[ListedMotor]) -> BoolArray:
        if not self.has(MOTOR):
            return np.zeros(self.count, np.bool_)
        return np.asarray(pc.is_in(self.table[MOTOR], _names(motors)))

    def equipped(self, catalogue: Catalogue) -> "Axes":
        """The axes with the figures of the motors that they name."""
        if not self.has(MOTOR):
            return self
        table, places = self.table, pc.index_in(self.table[MOTOR].combine_chunks(), _names(catalogue.motors))
        for name, path in LISTED.items():
            figures = pa.array([getattr(motor, name) for motor in catalogue.motors], pa.float64()).take(places)
            if path in table.column_names:
                figures = pc.coalesce(table[path], figures)
                table = table.drop_columns(path)
            table = table.append_column(path, figures)
        return Axes(table)

    def duty(self, rows: IntArray) -> Duty:
        """Duty of some sound axes."""
        counts = self.phase_counts[rows]
        longest = int(counts.max())
        if (counts == longest).all() and rows[-1] - rows[0] == len(rows) - 1:  # as they lie
            part = slice(self.starts[rows[0]], self.starts[rows[0]] + len(rows) * longest)
            series = [values[part].reshape(-1, 1, longest) for values in self._phases.values()]
        else:
            inside = np.arange(longest) < counts[:, None]
            place = np.where(inside, self.starts[rows][:, None] + np.arange(longest), 0)
            series = [(values[place] * inside)[:, None, :] for values in self._phases.values()]
        return Duty(Phases(*series), self._asked(rows))

    @cached_property
    def _phases(self) -> dict[str, FloatArray]:
        """Magnitudes of all phases; each load is the phase's, else the cycle's, else 0."""
        values = {name: np.abs(self.cells(name)) for name in COLUMNS.phases}
        for name in LOADS:
            whole = np.repeat(np.abs(self.cells(f"output_load.{name}")), self.phase_counts)
            values[name] = np.nan_to_num(np.where(np.isnan(values[name]), whole, values[name]))
        for name, steady in VARYING.items():
            values[name] = np.where(np.isnan(values[name]), values[steady], values[name])
        return values

    def _asked(self, rows: IntArray) -> Asked:
        numbers = {name: values[rows, None] for name, values in self._numbers.items()}
        return Asked(numbers, *(texts[rows, None] for texts in self._texts))

    @cached_property
    def _numbers(self) -> dict[str, FloatArray]:
        """Every number that is asked for, shape (N,), or its default; those of a load where one is given."""
        numbers = {}
        for path in NUMBERS:
            column = COLUMNS.at[path]
            default = np.nan if column.default is None else column.default
            values = np.broadcast_to(np.float64(default), (self.count,))
            if self.has(column.name):
                values = np.where(self.is_given(column.name), self.cells(column.name), default)
            numbers[".".join(path)] = values if path[0] != "output_load" else np.where(self.are_loaded, values, np.nan)
        return numbers

    @cached_property
    def _texts(self) -> tuple[TextArray, TextArray, TextArray]:
        """Model and basis of life of the output bearing where a load is given, and what gears are ranked by."""
        model, basis, rank_by = (
            np.where((texts := self.texts(name)) == "", COLUMNS.all[name].default, texts)
            for name in (MODEL, BASIS, "rank_by")
        )
        return np.where(self.are_loaded, model, ""), np.where(self.are_loaded, basis, ""), rank_by


@dataclass(frozen=True)
class Allowed:
    """Lists of gears, None where there is none, and which of them each of N axes has, shape (N,)."""

    lists: list[GearList | None]
    which: IntArray

    @property
    def are_there(self) -> BoolArray:
        """Which axes have gears."""
        return np.array([gears is not None for gears in self.lists], np.bool_)[self.which]

    def chunks(self, counts: IntArray) -> Iterator[tuple[GearList, IntArray]]:
        """Axes that are evaluated together: of the same gears, of cycles with a like number of phases."""
        for number, gears in enumerate(self.lists):
            members = np.flatnonzero(self.which == number)
            if gears is not None and len(members):
                for chunk in chunks_of(counts[members]):
                    yield gears, members[chunk]


def _values(column: pa.ChunkedArray) -> FloatArray:
    values = np.asarray(pc.cast(column, pa.float64(), safe=False).to_numpy())
    wrong = np.isnan(values)
    if wrong.any() and column.null_count < wrong.sum():
        given = np.asarray(pc.is_valid(column))
        values = np.where(wrong & given, np.inf, values)
    return values


def _in_bounds(column: Column, values: FloatArray) -> BoolArray:
    inside = (values >= column.least) & (values <= column.most) & (values > column.above) & (values < np.inf)
    if column.kind == "integer":
        inside &= values == np.floor(values)
    return inside if column.required else inside | np.isnan(values)


def _names(motors: Iterable[ListedMotor]) -> pa.Array:
    return pa.array([motor.designation for motor in motors], pa.string())


def _key(wishes: list[Any] | None) -> tuple[Any, ...] | None:
    return None if wishes is None else tuple(map(canonical_size, wishes))


def _allowed(
    sizes: tuple[Any, ...] | None, ratios: tuple[Any, ...] | None, model: str, catalogue: Catalogue
) -> GearList | None:
    if any(wishes is not None and not 1 <= len(wishes) <= MOST_WISHES for wishes in (sizes, ratios)):
        return None
    try:
        return gears_allowed(sizes, ratios, model, catalogue)
    except InputError:
        return None
