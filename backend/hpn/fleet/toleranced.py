"""Axes with tolerances: the models read each one, and the engine judges it with its worst cases."""

from collections import defaultdict
from collections.abc import Iterator

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
from pydantic import ValidationError

from hpn.application import Application, InputError
from hpn.catalogue import Catalogue, GearList
from hpn.engine.allowed import gears_for, with_listed_motor
from hpn.engine.batch import chunks_of
from hpn.engine.duty import Duty
from hpn.engine.evaluation import Evaluation, evaluate
from hpn.engine.tolerance import with_worst
from hpn.fleet.axes import BoolArray, IntArray, cells_of
from hpn.fleet.columns import COLUMNS, tolerance_column

READ_AT_ONCE = 1024


def have_tolerances(rows: pa.Table) -> BoolArray:
    """True for axes with a value in a column of a tolerance, shape (N,)."""
    mask = np.zeros(rows.num_rows, np.bool_)
    for name in rows.column_names:
        if tolerance_column(name) is not None:
            mask |= np.asarray(pc.is_valid(rows[name]))
    return mask


def over_tolerances(rows: pa.Table, chosen: BoolArray, catalogue: Catalogue) -> Iterator[tuple[Evaluation, IntArray]]:
    """Evaluations of axes with their worst cases, and the axes' places; an axis with a fault is left out."""
    places = np.flatnonzero(chosen).tolist()
    for start in range(0, len(places), READ_AT_ONCE):
        groups: dict[GearList, list[tuple[int, Application, Application]]] = defaultdict(list)
        for place, cells in cells_of(rows, places[start : start + READ_AT_ONCE]):
            try:
                application = Application.model_validate(COLUMNS.application_of(cells))
                equipped = with_listed_motor(application, catalogue)
                groups[gears_for(application, catalogue)].append((place, application, equipped))
            except (ValidationError, InputError):
                continue  # its faults are found with those of all axes
        for gears, rows_of_gears in groups.items():
            for chunk in chunks_of([len(application.duty_cycle.load_phases) for _, application, _ in rows_of_gears]):
                some = [rows_of_gears[at] for at in chunk.tolist()]
                duty = Duty.of([equipped for _, _, equipped in some])
                judged = with_worst([application for _, application, _ in some], evaluate(duty, gears, catalogue))
                yield judged, np.array([place for place, _, _ in some], np.intp)
