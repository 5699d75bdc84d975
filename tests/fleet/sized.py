"""Machines of a table, sized in the process of a test."""

from collections.abc import Sequence

from hpn.catalogue import Catalogue
from hpn.fleet.machine import kept_of
from hpn.store import MachineDraft
from hpn.web.pages.machine_answers import draft_of
from tests.fleet.tables import Row


def machine_draft(rows: Sequence[Row], catalogue: Catalogue) -> MachineDraft:
    """Machine of rows as it is kept."""
    return draft_of(kept_of(rows, (), {}, catalogue), catalogue)
