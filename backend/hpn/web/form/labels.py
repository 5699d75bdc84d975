"""What people write on a selection: its title block, and the parts of its ordering code that no catalogue knows.

They stand beside the application, in the address of its page as in its form; the canonical link has none of them.
"""

import re
from collections.abc import Iterator, Mapping
from urllib.parse import urlencode

from hpn.words.wording import N_, Sentence

LONGEST_LABEL = 200
"""Characters of a label."""

TITLE_BLOCK: Mapping[str, str] = {
    "title": N_("Title"),
    "ref": N_("Reference"),
    "author": N_("Author"),
    "rev": N_("Revision"),
}
"""Labels of the title block by their names in an address, and what the form calls them."""

LABELS: Mapping[str, str] = {
    **TITLE_BLOCK,
    "order_output": N_("Output shaft"),
    "order_motor": N_("Motor adapter"),
}
"""All labels: those of the title block, and what the ordering code is put together from."""

CONTROLS = re.compile(r"[\x00-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069\ufffe\uffff]")
"""Control characters, line separators, marks that turn the direction of the text around them, and no characters."""

NO_CONTROLS = N_("must not contain control characters or line breaks")


def faults_of(text: str) -> Iterator[Sentence]:
    """Why a text can't be a label."""
    if CONTROLS.search(text):
        yield Sentence(NO_CONTROLS)
    if len(text.strip()) > LONGEST_LABEL:
        yield Sentence(N_("takes at most {most} characters"), {"most": str(LONGEST_LABEL)})


def query_of(labels: Mapping[str, str]) -> str:
    """Tail of an address that gives labels: `&title=Axis+7`, nothing for blank ones."""
    given = urlencode([(name, text.strip()) for name, text in labels.items() if text.strip()])
    return f"&{given}" if given else ""
