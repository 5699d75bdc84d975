"""Labels of a selection: its title block, and the parts of the ordering code that no catalogue knows.

They stand beside the application, in the address of its page as in its form; the canonical link has none of them.
"""

from collections.abc import Mapping
from urllib.parse import urlencode

from hpn.words.wording import N_

TITLE_BLOCK: Mapping[str, str] = {
    "title": N_("Title"),
    "ref": N_("Reference"),
    "author": N_("Author"),
    "rev": N_("Revision"),
}
"""Labels of the title block by their names in an address, and what the form calls them."""

FIELDS: Mapping[str, str] = {"title": "title", "ref": "reference", "author": "author", "rev": "revision"}
"""Fields in which the store keeps the labels of the title block."""

LABELS: Mapping[str, str] = {
    **TITLE_BLOCK,
    "order_output": N_("Output shaft"),
    "order_motor": N_("Motor adapter"),
}
"""All labels: those of the title block, and what the ordering code is put together from."""

OF_AXIS: Mapping[str, str] = {"name": N_("Name"), "quantity": N_("Quantity"), "note": N_("Note")}
"""Labels of an axis of a machine."""


def query_of(labels: Mapping[str, str]) -> str:
    """Tail of an address that gives labels: `&title=Axis+7`, nothing for blank ones."""
    query = urlencode([(name, text.strip()) for name, text in labels.items() if text.strip()])
    return f"&{query}" if query else ""
