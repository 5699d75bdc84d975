"""Labels of a selection: its title block, and the parts of the ordering code that are not in the catalogue.

They stand beside the application, in the address of its page and in its form; the canonical link has none of them.
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
"""Labels of the title block by their names in an address, with their names in the form."""

FIELDS: Mapping[str, str] = {"title": "title", "ref": "reference", "author": "author", "rev": "revision"}
"""Fields of the store for the labels of the title block."""

LABELS: Mapping[str, str] = {
    **TITLE_BLOCK,
    "order_output": N_("Output shaft"),
    "order_motor": N_("Motor adapter"),
}
"""All labels: those of the title block, and the parts of the ordering code."""

OF_AXIS: Mapping[str, str] = {"name": N_("Name"), "quantity": N_("Quantity"), "note": N_("Note")}
"""Labels of an axis of a machine."""


def query_of(labels: Mapping[str, str]) -> str:
    """Tail of an address with labels, such as `&title=Axis+7`; blank labels are left out."""
    query = urlencode([(name, text.strip()) for name, text in labels.items() if text.strip()])
    return f"&{query}" if query else ""
