"""The selection that a reader came from, handed from page to page in their addresses."""

from urllib.parse import urlencode

from hpn.web.door.bodies import pairs_of
from hpn.web.door.visit import address
from hpn.web.form.link_reader import Pairs

OWN_NAMES = frozenset(
    ("output", "motor", "find", "only_size", "only_i", "search", "reference", "cursor", "id", "a", "b", "back")
)
"""Parameters of the pages themselves; every other one belongs to that selection."""

LONGEST_LINK = 4000
"""Longest selection that is handed on."""


def carried_pairs() -> Pairs:
    """Parameters of that selection in the address of the request under way; none where it has no selection."""
    _, _, query = address().partition("?")
    pairs = [(name, text) for name, text in pairs_of(query) if name not in OWN_NAMES]
    known = any(name == "T" for name, _ in pairs)
    return pairs if known and len(urlencode(pairs)) <= LONGEST_LINK else []


def onward(path: str, **more: str) -> str:
    """Address of another page that keeps that selection; what is given here goes before the same of it."""
    pairs = [pair for pair in carried_pairs() if pair[0] not in more] + [(n, t) for n, t in more.items() if t]
    return f"{path}?{urlencode(pairs)}" if pairs else path
