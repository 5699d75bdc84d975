"""Fleets that are sized in the process of a test."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from hpn.catalogue import Catalogue
from hpn.fleet.grouping import Part
from hpn.fleet.job import Job, compute
from hpn.fleet.run import Order, size_fleet
from hpn.store import FleetDraft
from hpn.web.pages.fleet_result import draft_of
from tests.fleet.tables import Row, write


def here(job: Job, parts: Mapping[int, Part]) -> Iterator[int]:
    """Engine of this very process."""
    for number, part in parts.items():
        compute(job, number, part)
        yield number


def fleet_draft(rows: Sequence[Row], folder: Path, catalogue: Catalogue) -> FleetDraft:
    """What is kept of a fleet of rows."""
    axes, answers = write(folder / "axes.ndjson", rows), folder / "answers.parquet"
    size_fleet(Order(axes, answers), catalogue, here, lambda *told: None)
    return draft_of(axes, answers, catalogue)
