"""A fleet that was sized, on its way into the store and out of it. Arrow is imported by this module."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import pyarrow as pa
import pyarrow.compute as pc

from hpn import ENGINE_VERSION
from hpn.catalogue import Catalogue
from hpn.explain.comparison import is_same
from hpn.fleet.columns import AXIS
from hpn.fleet.faults import Reason, reasons_of
from hpn.fleet.listing import AxisRow, rows_of
from hpn.fleet.machine import Kept, table_of
from hpn.fleet.outcome import FAULTS
from hpn.fleet.summary import Summary, summary_of
from hpn.store import FleetDraft, SavedFleet

COMPARED = ("selected", "governing_check", "utilisation", "suitable")


def draft_of(kept: Kept, catalogue: Catalogue) -> FleetDraft:
    """Fleet to be kept of axes that were sized."""
    summary = kept.summary
    return FleetDraft(
        axes=summary.axes,
        selected=summary.selected,
        unsuitable=summary.unsuitable,
        rejected=summary.rejected,
        engine_version=ENGINE_VERSION,
        catalogue_version=catalogue.version,
        asked=kept.axes,
        answers=kept.answers,
    )


class Shown(NamedTuple):
    """A fleet that was kept, ready to be shown."""

    summary: Summary
    rows: list[AxisRow]


def shown_of(saved: SavedFleet) -> Shown:
    """Counts and rows of a saved fleet."""
    answers = table_of(saved.answers)
    return Shown(summary_of(answers.to_batches()), rows_of(answers))


def asked_of(saved: SavedFleet, names: list[str]) -> pa.Table:
    """Inputs of some axes."""
    asked = table_of(saved.asked)
    return asked.filter(pc.is_in(asked[AXIS], pa.array(names, pa.string())))


# --- Today ------------------------------------------------------------------------------------------------------------


class Changed(NamedTuple):
    """An axis whose answer is another one today, or the reasons why it has none."""

    axis: str
    saved: dict[str, Any]
    today: dict[str, Any]
    reasons: Sequence[Reason]


def changes(saved: SavedFleet, answers: Sequence[dict[str, Any]]) -> list[Changed]:
    """Axes that are answered otherwise today, out of those that had an answer."""
    before = table_of(saved.answers)
    then = {row[AXIS]: row for row in before.filter(pc.is_valid(before["suitable"])).to_pylist()}
    pairs = ((row[AXIS], then[row[AXIS]], row) for row in answers)
    return [Changed(*pair, reasons_of(pair[2][FAULTS])) for pair in pairs if _differs(*pair[1:])]


def _differs(saved: Mapping[str, Any], today: Mapping[str, Any]) -> bool:
    return today["suitable"] is None or not all(is_same(saved[name], today[name]) for name in COMPARED)
