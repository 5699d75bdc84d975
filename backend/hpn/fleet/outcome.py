"""Answers to a table of axes in list form: a row for each axis, and a row for each fault."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import chain
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray
from pydantic import ValidationError

from hpn.application import Application, InputError, Location
from hpn.application.faults import REQUIRED, sentences_of
from hpn.catalogue import Catalogue
from hpn.engine.allowed import gears_for, with_listed_motor
from hpn.engine.candidates import Candidate, Reserve, WorstCase, candidates_of
from hpn.engine.checks import CHECKS
from hpn.engine.evaluation import SUITABLE, UNRATED, Evaluation, Worst, evaluate
from hpn.fleet.axes import Axes, BoolArray, IntArray, cells_of
from hpn.fleet.columns import AXIS, COLUMNS
from hpn.fleet.faults import CellFault, cell_of, text_of
from hpn.fleet.tables import RowBatch
from hpn.fleet.toleranced import have_tolerances, over_tolerances
from hpn.physics.equations import FloatArray
from hpn.words.wording import N_, Sentence

MOST_FAULTS = 20
"""Most faults of one axis in the list."""

DISAGREED = Sentence(
    N_("is rejected by the rules for columns but accepted for a single axis; please report it with this axis")
)
"""Reason of a row on which the two rules disagree: a fault of the service, which does not end a fleet."""


LENGTHS = N_("has {found} phases where torque_Nm has {count}")

ROW, FAULTS = "row", "faults"
"""Columns that are in no file: the row of a fault's or candidate's axis among the answers beside it, and the reasons of
a rejected axis among the answers, in stored form."""


def answer_fields(axis: pa.DataType) -> pa.Schema:
    """Columns of the answers, for axes of a type."""
    return pa.schema(
        [
            (AXIS, axis),
            ("selected", pa.string()),
            ("governing_check", pa.string()),
            ("utilisation", pa.float64()),
            ("life_L10_h", pa.float64()),
            ("shortest_life_h", pa.float64()),
            ("shortest_life_of", pa.string()),
            ("motor_torque_limit_Nm", pa.float64()),
            ("suitable", pa.int64()),
            ("runner_up", pa.string()),
            ("average_torque_Nm", pa.float64()),
            ("holds", pa.bool_()),
            ("worst_utilisation", pa.float64()),
            ("worst_governing_check", pa.string()),
            ("error", pa.string()),
            (FAULTS, pa.string()),
        ]
    )


def rejected_fields(axis: pa.DataType) -> pa.Schema:
    """Columns of the faults, with the row of their axis."""
    return pa.schema([(ROW, pa.int64()), (AXIS, axis), *((name, pa.string()) for name in ("column", "code", "reason"))])


def outcome(
    batch: RowBatch,
    catalogue: Catalogue,
    *,
    with_candidates: bool = False,
    placed: Callable[[CellFault], CellFault] = lambda fault: fault,
) -> dict[str, pa.Table]:
    """Answers to axes, their faults, and on request their candidates, by kind.

    `placed` moves a fault to its place in the caller's table.
    """
    axis, count = batch.rows[AXIS], batch.rows.num_rows
    is_faulty = np.zeros(count, np.bool_)
    is_faulty[[fault.row for fault in batch.faults]] = True
    bear = have_tolerances(batch.rows)
    axes = Axes(batch.rows, catalogue, is_faulty | bear)
    answers, candidates = _Answers(count), _Candidates()
    is_sound = np.zeros(count, np.bool_)
    judged = ((evaluate(axes.duty(some), gears, catalogue), axes.places[some]) for gears, some in axes.chunks())
    for evaluation, places in chain(judged, over_tolerances(batch.rows, bear & ~is_faulty, catalogue)):
        answers.add(evaluation, places)
        is_sound[places] = True
        if with_candidates:
            candidates.add(evaluation, places)
    faults = [placed(fault) for fault in _all_faults(batch, is_sound, catalogue)]
    tables = {"answers": answers.table(axis, faults), "rejected": _fault_table(axis, faults)}
    return tables | ({"candidates": candidates.table(axis)} if with_candidates else {})


# --- Answers ----------------------------------------------------------------------------------------------------------

CODES = [check.code for check in CHECKS]


class _Answers:
    """Columns of the answers, filled chunk by chunk; empty places are null."""

    def __init__(self, count: int) -> None:
        self.selected, self.runner_up, self.governing = (np.full(count, -1, np.int32) for _ in range(3))
        self.utilisation, self.average_torque_Nm = np.full(count, np.nan), np.full(count, np.nan)
        self.life_L10_h, self.shortest_life_h = np.full(count, np.nan), np.full(count, np.nan)
        self.shortest_life_of, self.limit_Nm = np.full(count, "", object), np.full(count, np.nan)
        self.suitable = np.full(count, -1, np.int64)
        self.holds, self.worst_governing = np.full(count, -1, np.int8), np.full(count, -1, np.int32)
        self.worst_utilisation = np.full(count, np.nan)
        self.designations: list[str] = []

    def add(self, evaluation: Evaluation, places: IntArray) -> None:
        """Add the answers of some axes."""
        suits = evaluation.verdict == SUITABLE
        count = suits.sum(axis=-1)
        best, has_gear, figures = evaluation.foremost(suits), count > 0, evaluation.case.figures
        names = np.array([self._number(gear.designation) for gear in evaluation.gears.rows], np.int32)
        codes = np.array([CODES.index(check.code) for check in evaluation.checks], np.int32)
        rows = np.arange(len(places))
        self.suitable[places] = count
        self.average_torque_Nm[places] = evaluation.case.duty.average_torque_Nm[:, 0]
        self.selected[places] = np.where(has_gear, names[best], -1)
        self.governing[places] = np.where(has_gear, codes[evaluation.governing_of(best)], -1)
        self.utilisation[places] = np.where(has_gear, evaluation.utilisation[rows, best], np.nan)
        lives = (self.life_L10_h, figures.life_L10_h), (self.shortest_life_h, figures.shortest_life_h)
        for own, figure in (*lives, (self.limit_Nm, figures.motor_torque_limit_Nm)):
            own[places] = np.where(has_gear, figure[rows, best], np.nan)
        self.shortest_life_of[places] = np.where(has_gear, figures.shortest_life_of[rows, best], "")
        if evaluation.worst is not None:
            self._add_worst(evaluation.worst, places, best, has_gear)
        suits[rows, best] = False
        self.runner_up[places] = np.where(count > 1, names[evaluation.foremost(suits)], -1)

    def _add_worst(self, worst: Worst, places: IntArray, best: IntArray, has_gear: BoolArray) -> None:
        """Add the worst cases of the selected gears."""
        judged, rows = worst.evaluation, np.arange(len(places))
        codes = np.array([CODES.index(check.code) for check in judged.checks], np.int32)
        has_gear = has_gear & worst.has_tolerances
        rated = has_gear & (judged.verdict[rows, best] != UNRATED)
        self.holds[places] = np.where(has_gear, judged.verdict[rows, best] == SUITABLE, -1)
        self.worst_utilisation[places] = np.where(has_gear, judged.utilisation[rows, best], np.nan)
        self.worst_governing[places] = np.where(rated, codes[judged.governing[rows, best]], -1)

    def table(self, axis: pa.ChunkedArray, faults: Sequence[CellFault]) -> pa.Table:
        """Answers with the faults of rejected axes."""
        columns = [
            axis,
            _name_column(self.selected, self.designations),
            _name_column(self.governing, CODES),
            _finite(self.utilisation),
            _finite(self.life_L10_h),
            _finite(self.shortest_life_h),
            pa.array([life or None for life in self.shortest_life_of.tolist()], pa.string()),
            _finite(self.limit_Nm),
            pa.array(self.suitable, mask=self.suitable < 0),
            _name_column(self.runner_up, self.designations),
            _finite(self.average_torque_Nm),
            pa.array(self.holds == 1, mask=self.holds < 0),
            _finite(self.worst_utilisation),
            _name_column(self.worst_governing, CODES),
            *_reasons(len(self.suitable), faults),
        ]
        return pa.Table.from_arrays(columns, schema=answer_fields(axis.type))

    def _number(self, designation: str) -> int:
        if designation not in self.designations:
            self.designations.append(designation)
        return self.designations.index(designation)


def _name_column(places: NDArray[np.int32], names: Sequence[str]) -> pa.Array:
    return pa.DictionaryArray.from_arrays(pa.array(places, mask=places < 0), pa.array(names, pa.string())).cast(
        pa.string()
    )


def _finite(values: FloatArray) -> pa.Array:
    return pa.array(values, mask=~np.isfinite(values))


# --- Faults -----------------------------------------------------------------------------------------------------------


def _fault_table(axis: pa.ChunkedArray, faults: Sequence[CellFault]) -> pa.Table:
    """Table with a row for each fault."""
    rows = pa.array([fault.row for fault in faults], pa.int64())
    reasons = [(fault.column, fault.code, fault.reason.text) for fault in faults]
    texts = zip(*reasons, strict=True) if reasons else [(), (), ()]
    columns = [rows, axis.take(rows), *(pa.array(values, pa.string()) for values in texts)]
    return pa.Table.from_arrays(columns, schema=rejected_fields(axis.type))


def _reasons(count: int, faults: Sequence[CellFault]) -> tuple[pa.Array, pa.Array]:
    """Faults of each axis as one text, and in stored form; null for an axis without faults."""
    by_row = dict[int, list[CellFault]]()
    for fault in faults:
        by_row.setdefault(fault.row, []).append(fault)
    texts: list[str | None] = [None] * count
    cells = texts.copy()
    for row, own in by_row.items():
        texts[row], cells[row] = text_of(own), cell_of(own)
    return pa.array(texts, pa.string()), pa.array(cells, pa.string())


def _all_faults(batch: RowBatch, is_sound: BoolArray, catalogue: Catalogue) -> list[CellFault]:
    """Faults in the order of the rows, at most MOST_FAULTS of each axis."""
    known: dict[int, list[CellFault]] = {row: [] for row in np.flatnonzero(~is_sound).tolist()}
    for fault in batch.faults:
        known[fault.row].append(fault)
    for row, cells in cells_of(batch.rows, [row for row, faults in known.items() if not faults]):
        known[row] = _faults_of(row, cells, catalogue)
    return [fault for faults in known.values() for fault in faults[:MOST_FAULTS]]


def _faults_of(row: int, cells: Mapping[str, Any], catalogue: Catalogue) -> list[CellFault]:
    """Faults of an axis's lists, else those that the models or the selection find."""
    faults = [] if cells.get(AXIS) is not None else [CellFault(row, AXIS, Sentence(REQUIRED), "missing")]
    if all_faults := faults + [CellFault(row, *fault) for fault in faults_of_lists(cells)]:
        return all_faults
    try:
        application = Application.model_validate(COLUMNS.application_of(cells))
        gears_for(application, catalogue)
        with_listed_motor(application, catalogue)
    except (ValidationError, InputError) as error:
        return [located(row, location, sentence, code) for location, sentence, code in sentences_of(error)]
    return [CellFault(row, AXIS, DISAGREED, "invalid")]


def faults_of_lists(cells: Mapping[str, Any]) -> Iterator[tuple[str, Sentence, str]]:
    """Column, reason and code of lists of phases that are missing or differ in length."""
    count = len(cells.get("torque_Nm") or ())
    for name, column in COLUMNS.phases.items():
        values = cells.get(name)
        if values is None and column.required:
            yield name, Sentence(REQUIRED), "missing"
        elif values is not None and len(values) != count:
            yield name, Sentence(LENGTHS, {"found": str(len(values)), "count": str(count)}), "list_length"


def located(row: int, location: Location, sentence: Sentence, code: str) -> CellFault:
    """Fault at a place of an application, with the column of that place."""
    column, place = COLUMNS.column_at(location)
    if place:
        template, name, value = place
        sentence = Sentence(template, {name: value, "reason": sentence})
    return CellFault(row, column, sentence, code)


# --- Candidates -------------------------------------------------------------------------------------------------------

RESERVE = {f"reserve.{name}": name for name in Reserve.__struct_fields__}
WORST = {f"worst.{name}": name for name in WorstCase.__struct_fields__}
PLAIN = tuple(name for name in Candidate.__struct_fields__ if name not in ("reserve", "worst", "checks"))
WHOLE, TEXTS = (
    ("ratio", "stages", "rank"),
    (
        *("designation", "size", "status", "governing_check", "reason", "missing", "shortest_life_of"),
        *("worst.governing_check", "worst.status"),
    ),
)


def candidate_fields(axis: pa.DataType) -> pa.Schema:
    """Columns of the candidates, with the row of their axis: those of the reply, without their checks."""
    kinds = {**dict.fromkeys(WHOLE, pa.int64()), **dict.fromkeys(TEXTS, pa.string())}
    return pa.schema(
        [
            (ROW, pa.int64()),
            (AXIS, axis),
            *((name, kinds.get(name, pa.float64())) for name in (*PLAIN, *RESERVE, *WORST)),
        ]
    )


class _Candidates:
    """Candidates of all axes, best first."""

    def __init__(self) -> None:
        self.of_axis: dict[int, list[Candidate]] = {}

    def add(self, evaluation: Evaluation, places: IntArray) -> None:
        """Add the candidates of some axes."""
        for index, place in enumerate(places.tolist()):
            self.of_axis[place] = list(candidates_of(evaluation, index))

    def table(self, axis: pa.ChunkedArray) -> pa.Table:
        """Table with a row for each candidate, in the order of the axes."""
        places = sorted(self.of_axis)
        rows = [candidate for place in places for candidate in self.of_axis[place]]
        of = np.repeat(np.array(places, np.int64), [len(self.of_axis[place]) for place in places])
        columns = [pa.array(of), axis.take(pa.array(of)).combine_chunks()]
        schema = candidate_fields(axis.type)
        columns += [pa.array([_plain(getattr(row, name)) for row in rows], schema.field(name).type) for name in PLAIN]
        columns += [pa.array([getattr(row.reserve, name) for row in rows], pa.float64()) for name in RESERVE.values()]
        columns += [
            pa.array([getattr(row.worst, name, None) for row in rows], schema.field(column).type)
            for column, name in WORST.items()
        ]
        return pa.Table.from_arrays(columns, schema=schema)


def _plain(value: Any) -> Any:
    """Field of a candidate as a cell: a tuple becomes one text, null where it is empty."""
    return (", ".join(value) or None) if isinstance(value, tuple) else value


FIELDS = {"answers": answer_fields, "rejected": rejected_fields, "candidates": candidate_fields}
"""Columns of the files by kind, for axes of a type."""
