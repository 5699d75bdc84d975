"""Axes in list form as arrays: the sound ones among them, and their inputs for the engine.

No object is made for an axis. Numbers are compared with the bounds of the models on arrays. All other rules depend on
texts and on which inputs are given, not on numbers. Axes alike in those share a pattern, and the models judge one axis
of each pattern. A rejected axis gets its reasons from the models themselves (`faults.py`).
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from numpy.typing import NDArray
from pydantic import ValidationError

from hpn.application import LEAST_MOTION, STOP_LOADS, Application, InputError
from hpn.application.phase import ROOM
from hpn.catalogue import Catalogue, GearList
from hpn.engine.allowed import gears_for, with_listed_motor
from hpn.engine.batch import chunks_of
from hpn.engine.duty import Duty, Phases, least_torque
from hpn.engine.input_arrays import InputArrays
from hpn.fleet.columns import AXIS, COLUMNS, NUMBER, InputColumn, is_list, is_text
from hpn.fleet.columns import TEXTS as KINDS_OF_TEXT
from hpn.physics.equations import FloatArray
from hpn.words.fields import MAXIMUM_PHASES
from hpn.words.titles import LONGEST_NAME, is_title

BoolArray = NDArray[np.bool_]
IntArray = NDArray[np.intp]

LOADS = ("radial_N", "axial_N")
STEADY = {"peak_torque_Nm": "torque_Nm", "peak_speed_rpm": "speed_rpm", "rms_torque_Nm": "torque_Nm"}
"""Figures of phases that vary, and the figure that replaces each in a steady phase."""

PAUSE, REVERSES = "duty_cycle.pause_s", "requirements.load_reverses"
TEXTS = ("bearing_model", "life_basis", "rank_by", "position_error_at", "shaft_drive", "motor_curves")
"""Inputs other than numbers, by the engine's names."""

LEAST, ERROR_AT = "least_torque_Nm", "requirements.position_error_at"

MOST_CELLS = 100_000
"""Most cells and items of lists that are objects at once, while the models judge axes."""


class Axes:
    """Sound axes of a table in list form: `places` are their rows; their phases stand one after another.

    An axis is sound where `select` takes it under the same catalogue; rows in `is_excluded` are never sound.
    """

    def __init__(self, table: pa.Table, catalogue: Catalogue, is_excluded: BoolArray | None = None) -> None:
        self._catalogue = catalogue
        mask = _have_sound_lists(table)
        if is_excluded is not None:
            mask &= ~is_excluded
        self._take(table if mask.all() else table.filter(pa.array(mask)), np.flatnonzero(mask))
        with np.errstate(all="ignore"):  # values out of bounds are rejected anyway
            sound = self._have_sound_phases() & self._have_sound_stops() & self._have_sound_names()
            self._keep(self._in_bounds() & sound)
        self._judge()

    def _take(self, table: pa.Table, places: IntArray) -> None:
        self._table, self.places = table, places
        self.counts = _lengths(table["torque_Nm"])
        self._starts = np.concatenate((np.zeros(1, np.intp), np.cumsum(self.counts)))[:-1]
        self._cells: dict[str, FloatArray] = {}

    def _keep(self, mask: BoolArray) -> None:
        if not mask.all():
            self._take(self._table.filter(pa.array(mask)), self.places[mask])

    # --- Cells --------------------------------------------------------------------------------------------------------

    def _is_given(self, name: str) -> bool:
        """True where any axis has a value in a column."""
        return name in self._table.column_names and self._table[name].null_count < self._table.num_rows

    def _numbers(self, name: str) -> FloatArray:
        """Numbers of a column, shape (N,), or of a field of the phases, shape (all phases,): NaN where no number is
        given, infinite for a given NaN."""
        if name not in self._cells:
            is_of_phases = name in COLUMNS.phases
            values = np.full(self.counts.sum() if is_of_phases else len(self.counts), np.nan)
            if self._is_given(name):
                column = self._table[name]
                if is_of_phases:
                    values[np.repeat(np.asarray(pc.is_valid(column)), self.counts)] = _values(pc.list_flatten(column))
                else:
                    values = _values(column)
            self._cells[name] = values
        return self._cells[name]

    def _any_phase(self, holds: BoolArray) -> BoolArray:
        return np.logical_or.reduceat(holds, self._starts) if len(self._starts) else np.zeros(0, np.bool_)

    # --- Rules --------------------------------------------------------------------------------------------------------

    def _in_bounds(self) -> BoolArray:
        mask = np.ones(len(self.counts), np.bool_)
        for name, column in COLUMNS.all.items():
            if not _is_number(name) or not self._is_given(name):
                continue
            inside = _inside(column, self._numbers(name))
            mask &= ~self._any_phase(~inside) if name in COLUMNS.phases else inside
        return mask

    def _have_sound_phases(self) -> BoolArray:
        """True for axes where a phase moves, no phase contradicts itself, and an axis with its error at rest rests,
        (N,)."""
        T, n, t = (np.abs(self._numbers(name)) for name in ("torque_Nm", "speed_rpm", "duration_s"))
        mask = self._any_phase(n * t > LEAST_MOTION)
        if any(map(self._is_given, (*STEADY, LEAST))):
            peak_T, peak_n, rms, least = map(self._numbers, (*STEADY, LEAST))
            wrong = (peak_T < T * (1 - ROOM)) | (peak_n < n * (1 - ROOM)) | ((n == 0) & (peak_n > 0))
            wrong |= (rms > np.where(np.isnan(peak_T), T, peak_T) * (1 + ROOM)) | (least > np.fmin(T, rms) * (1 + ROOM))
            mask &= ~self._any_phase(wrong)
        if self._is_given(ERROR_AT):
            of_cycle = np.asarray(pc.fill_null(pc.not_equal(self._table[ERROR_AT], "rest"), fill_value=True))
            mask &= of_cycle | (self._numbers("pause_s") > 0) | self._any_phase(n == 0)
        return mask

    def _have_sound_stops(self) -> BoolArray:
        """True where the torque against a stop is not less than the load's torque, a part of it; shape (N,)."""
        load, opposing = (self._numbers(f"emergency_stop.brake.{name}") for name in STOP_LOADS)
        return ~(opposing < np.nan_to_num(load))

    def _have_sound_names(self) -> BoolArray:
        """True where each phase has a valid name or none, shape (N,)."""
        mask = np.ones(len(self.counts), np.bool_)
        for name in (name for name in COLUMNS.phases if not _is_number(name) and self._is_given(name)):
            texts = pc.list_flatten(self._table[name]).combine_chunks().dictionary_encode()
            sound = np.array([is_title(text, LONGEST_NAME) for text in texts.dictionary.to_pylist()], np.bool_)
            is_sound = np.ones(self.counts.sum(), np.bool_)
            is_given = np.repeat(np.asarray(pc.is_valid(self._table[name])), self.counts)
            places = np.asarray(pc.fill_null(texts.indices, -1))
            is_sound[is_given] = np.append(sound, True)[places]  # the last one stands for no name
            mask &= ~self._any_phase(~is_sound)
        return mask

    def _judge(self) -> None:
        """Keep the axes whose pattern the models accept; each gets the gears and defaults of its pattern."""
        first, pattern = self._patterns()
        judged = [self._judged(cells) for _, cells in cells_of(self._table, first.tolist())]
        sound = np.array([each is not None for each in judged], np.bool_)
        self._gears = [each[1] for each in judged if each]
        applications = [each[0] for each in judged if each]
        self._inputs = InputArrays.of(applications) if applications else None
        self._keep(sound[pattern])
        self._pattern = (np.cumsum(sound) - 1)[pattern[sound[pattern]]]

    def _patterns(self) -> tuple[IntArray, IntArray]:
        """First axis of each pattern, and pattern of each axis."""
        pattern = np.zeros(len(self.counts), np.intp)
        for name, column in COLUMNS.all.items():
            is_name = name in COLUMNS.phases and not _is_number(name)
            if column.required or is_name or not self._is_given(name):
                continue
            codes = self._codes(name)
            pattern = np.unique(pattern * (codes.max() + 1) + codes, return_inverse=True)[1]
        _, first, pattern = np.unique(pattern, return_index=True, return_inverse=True)
        return first, pattern

    def _codes(self, name: str) -> IntArray:
        """Number for each axis, the same where the rules make no difference between the cells of a column."""
        if COLUMNS.all[name].kind == "boolean":  # null, false or true
            return (np.nan_to_num(self._numbers(name), nan=-1.0) + 1).astype(np.intp)
        if _is_number(name) and not (COLUMNS.all[name].by_size and is_text(self._table[name].type)):
            known = ~np.isnan(self._numbers(name))
            return (self._any_phase(known) if name in COLUMNS.phases else known).astype(np.intp)
        numbers: dict[object, int] = {}
        texts = self._table[name].to_pylist()
        keys: Iterable[object] = (tuple(text) if isinstance(text, list) else text for text in texts)
        if COLUMNS.all[name].by_size:
            known = ~np.isnan(self._numbers(name))
            keys = (is_number or text for text, is_number in zip(texts, known.tolist(), strict=True))
        return np.array([numbers.setdefault(key, len(numbers)) for key in keys], np.intp)

    def _judged(self, cells: Mapping[str, Any]) -> tuple[Application, GearList] | None:
        try:
            application = Application.model_validate(COLUMNS.application_of(cells))
            return with_listed_motor(application, self._catalogue), gears_for(application, self._catalogue)
        except (ValidationError, InputError):
            return None

    # --- Inputs of the engine
    # ---------------------------------------------------------------------------------------------

    def chunks(self) -> Iterator[tuple[GearList, IntArray]]:
        """Axes to evaluate together: with the same gears, and cycles with a similar number of phases."""
        lists = list(dict.fromkeys(self._gears))
        which = np.array([lists.index(gears) for gears in self._gears], np.intp)[self._pattern]
        for number, gears in enumerate(lists):
            members = np.flatnonzero(which == number)
            for chunk in chunks_of(self.counts[members]):
                yield gears, members[chunk]

    def duty(self, axes: IntArray) -> Duty:
        """Duty of some of the axes."""
        counts = self.counts[axes]
        longest = int(counts.max())
        if (counts == longest).all() and axes[-1] - axes[0] == len(axes) - 1:  # contiguous: no copy
            part = slice(self._starts[axes[0]], self._starts[axes[0]] + len(axes) * longest)
            series = [values[part].reshape(-1, 1, longest) for values in self._phases.values()]
        else:
            inside = np.arange(longest) < counts[:, None]
            place = np.where(inside, self._starts[axes][:, None] + np.arange(longest), 0)
            series = [(values[place] * inside)[:, None, :] for values in self._phases.values()]
        assert self._inputs is not None
        numbers = {path: values[axes, None] for path, values in self._values.items()}
        texts = (getattr(self._inputs, name)[self._pattern[axes]] for name in TEXTS)
        of_sizes = self._inputs.shaft_centres_mm.items()
        centres = {size: values[self._pattern[axes]] for size, values in of_sizes}
        return Duty(Phases(*series), InputArrays(numbers, *[*texts, self._numbers(REVERSES)[axes, None], centres]))

    @cached_property
    def _phases(self) -> dict[str, FloatArray]:
        """Magnitudes of all phases; each load is the phase's, else the cycle's, else 0."""
        values = {name: np.abs(self._numbers(name)) for name in COLUMNS.phases if _is_number(name)}
        for name in LOADS:
            whole = np.repeat(np.abs(self._numbers(f"output_load.{name}")), self.counts)
            values[name] = np.nan_to_num(np.where(np.isnan(values[name]), whole, values[name]))
        for name, steady in STEADY.items():
            values[name] = np.where(np.isnan(values[name]), values[steady], values[name])
        T, peak, _, rms = (values[name] for name in ("torque_Nm", *STEADY))
        by_default = least_torque(torque_Nm=T, peak_torque_Nm=peak, rms_torque_Nm=rms)
        values[LEAST] = np.where(np.isnan(values[LEAST]), by_default, values[LEAST])
        return values | {"torque_sign": np.sign(self._numbers("torque_Nm"))}

    @cached_property
    def _values(self) -> dict[str, FloatArray]:
        """Every number that the engine needs, shape (N,): the axis's own where it is given, else its pattern's."""
        numbers = {}
        for path, values in self._inputs.numbers.items() if self._inputs else ():
            own, of_pattern = self._numbers("pause_s" if path == PAUSE else path), values[self._pattern, 0]
            numbers[path] = np.where(np.isnan(own), of_pattern, own)
        return numbers


def _is_number(name: str) -> bool:
    """True for a column of numbers, one for each axis or phase."""
    column = COLUMNS.all[name]
    return column.kind not in KINDS_OF_TEXT and (name in COLUMNS.phases or not column.is_list)


def _have_sound_lists(table: pa.Table) -> BoolArray:
    """True for axes with a name, and with lists of phases of equal length within the limit, shape (N,)."""
    lengths = {name: _lengths(table[name]) for name in COLUMNS.phases if name in table.column_names}
    count = lengths["torque_Nm"]
    mask: BoolArray = np.asarray(pc.is_valid(table[AXIS])) & (count >= 1) & (count <= MAXIMUM_PHASES)
    for name, length in lengths.items():
        mask &= (length == count) | ((length < 0) & (not COLUMNS.phases[name].required))
    return mask


def _lengths(column: pa.ChunkedArray) -> IntArray:
    """Lengths of lists, -1 for null."""
    return np.asarray(pc.fill_null(pc.list_value_length(column), -1)).astype(np.intp)


def _values(column: pa.ChunkedArray) -> FloatArray:
    """Numbers of cells; a text that is no number is NaN, a given NaN is infinite."""
    if is_text(column.type):
        texts = pc.ascii_trim_whitespace(column)
        column = pc.if_else(pc.match_substring_regex(texts, f"^({NUMBER.pattern})$", ignore_case=True), texts, None)
    values = np.asarray(pc.cast(column, pa.float64(), safe=False).to_numpy())
    wrong = np.isnan(values)
    if wrong.any() and column.null_count < wrong.sum():
        known = np.asarray(pc.is_valid(column))
        values = np.where(wrong & known, np.inf, values)
    return values


def _inside(column: InputColumn, values: FloatArray) -> BoolArray:
    inside = (values >= column.least) & (values <= column.most) & (values > column.above) & (values < np.inf)
    if column.kind == "integer":
        inside &= values == np.floor(values)
    return inside if column.required else inside | np.isnan(values)


def cells_of(table: pa.Table, rows: Sequence[int]) -> Iterator[tuple[int, dict[str, Any]]]:
    """Rows with their cells, without columns that none of these rows fills."""
    chosen = table.take(pa.array(rows, pa.int64()))
    chosen = chosen.select([name for name in chosen.column_names if chosen[name].null_count < len(rows)])
    size = np.full(len(rows), max(chosen.num_columns, 1))
    for column in chosen.columns:
        if is_list(column.type):
            size += np.asarray(pc.fill_null(pc.list_value_length(column), 0))
    starts = np.unique(np.cumsum(size) // MOST_CELLS, return_index=True)[1].tolist()
    for start, end in pairwise([*starts, len(rows)]):
        some = chosen.slice(start, end - start).to_pylist() if chosen.num_columns else [{}] * (end - start)
        yield from zip(rows[start:end], some, strict=True)
