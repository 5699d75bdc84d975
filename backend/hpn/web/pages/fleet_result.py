"""A fleet that was sized, on its way into the store and out of it. Arrow is imported by this module."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq

from hpn import ENGINE_VERSION
from hpn.catalogue import Catalogue
from hpn.explain.comparison import is_same
from hpn.fleet.columns import AXIS
from hpn.fleet.listing import MOST_BYTES, MOST_LISTED, AxisRow, KeptListing, read_answers, rows_of
from hpn.fleet.summary import Summary, summary_of
from hpn.store import FleetDraft, SavedFleet
from hpn.web.door.problems import Problem
from hpn.web.pages.fleet_files import table_of
from hpn.web.pages.fleet_reasons import by_rows
from hpn.words.wording import N_, Quantity, Sentence

COMPARED = ("selected", "governing_check", "utilisation", "suitable")
TOO_MANY = N_(
    "The table has {axes} axes, and the limit of a page is {most}: size it with the command hpn fleet or POST "
    "/api/v1/fleet, which have no such limit."
)
TOO_LONG = N_(
    "The phases of all axes need more than {most} MB, the limit of a page: size the table with the command hpn fleet "
    "or POST /api/v1/fleet, which have no such limit."
)


def require_few(answers: Path) -> None:
    """Raise Problem 413 for more axes than a page shows."""
    count = pq.read_metadata(answers).num_rows
    if count > MOST_LISTED:
        values = {"axes": Quantity(count, "", 12), "most": Quantity(MOST_LISTED, "", 12)}
        raise Problem(413, Sentence(TOO_MANY, values))


def name_rows(answers: Path, origins: Mapping[str, Sequence[int]]) -> None:
    """Writes answers anew whose reasons name the rows of the table that its axes stand in."""
    table = pq.read_table(answers)
    rows = zip(table["error"].to_pylist(), table[AXIS].to_pylist(), strict=True)
    errors = [error and by_rows(error, origins.get(str(axis), ())) for error, axis in rows]
    place = table.column_names.index("error")
    pq.write_table(table.set_column(place, "error", pa.array(errors, pa.string())), answers)


def draft_of(listing: KeptListing | None, catalogue: Catalogue) -> FleetDraft:
    """Fleet to be kept of tables that were sized; Problem 413 for more than a page can read."""
    if listing is None:
        raise Problem(413, Sentence(TOO_LONG, {"most": MOST_BYTES // 1_000_000}))
    summary = listing.summary
    return FleetDraft(
        axes=summary.axes,
        selected=summary.selected,
        unsuitable=summary.unsuitable,
        rejected=summary.rejected,
        engine_version=ENGINE_VERSION,
        catalogue_version=catalogue.version,
        asked=listing.axes,
        answers=listing.answers,
    )


class Kept(NamedTuple):
    """A fleet that was kept, ready to be shown."""

    summary: Summary
    rows: list[AxisRow]


def kept_of(saved: SavedFleet) -> Kept:
    """Counts and rows of a saved fleet."""
    answers = table_of(saved.answers)
    return Kept(summary_of(answers.to_batches()), rows_of(answers))


def asked_of(saved: SavedFleet, names: list[str]) -> pa.Table:
    """Inputs of some axes."""
    asked = table_of(saved.asked)
    return asked.filter(pc.is_in(asked[AXIS], pa.array(names, pa.string())))


# --- Today ------------------------------------------------------------------------------------------------------------


class Changed(NamedTuple):
    """An axis whose answer is another one today."""

    axis: str
    saved: dict[str, Any]
    today: dict[str, Any]


def changes(saved: SavedFleet, answers: Path) -> list[Changed]:
    """Axes that are answered otherwise today, out of those that had an answer."""
    before = table_of(saved.answers)
    then = {row[AXIS]: row for row in before.filter(pc.is_null(before["error"])).to_pylist()}
    today = [row for batch in read_answers(answers) for row in batch.to_pylist()]
    return [Changed(row[AXIS], then[row[AXIS]], row) for row in today if _differs(then[row[AXIS]], row)]


def _differs(saved: Mapping[str, Any], today: Mapping[str, Any]) -> bool:
    return today["error"] is not None or not all(is_same(saved[name], today[name]) for name in COMPARED)
