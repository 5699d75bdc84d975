"""Machines of a table, sized in the process of a test."""

from collections.abc import Sequence

from hpn import ENGINE_VERSION
from hpn.catalogue import Catalogue
from hpn.store import MachineDraft
from hpn.web.axis_tables import drafts_in
from tests.fleet.tables import Row


def machine_draft(rows: Sequence[Row], catalogue: Catalogue) -> MachineDraft:
    """Machine of rows as it is kept."""
    return MachineDraft(drafts_in(rows, (), {}, catalogue), ENGINE_VERSION, catalogue.version)
