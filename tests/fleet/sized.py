"""Fleets that are sized in the process of a test."""

from collections.abc import Sequence
from pathlib import Path

from hpn.catalogue import Catalogue
from hpn.fleet.listing import kept_listing_of
from hpn.fleet.order import Order
from hpn.fleet.run import size_fleet
from hpn.store import FleetDraft
from hpn.web.pages.fleet_result import draft_of
from tests.fleet.tables import Row, write


def fleet_draft(rows: Sequence[Row], folder: Path, catalogue: Catalogue) -> FleetDraft:
    """Fleet of rows as it is kept."""
    axes, answers = write(folder / "axes.ndjson", rows), folder / "answers.parquet"
    size_fleet(Order(axes, answers), catalogue)
    return draft_of(kept_listing_of(axes, answers, catalogue), catalogue)
