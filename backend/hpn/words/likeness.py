"""Likeness of a misspelt name to a known one."""

from collections.abc import Iterable
from difflib import get_close_matches

from hpn.words.units import suffix_of

LONGEST = 80
"""Characters of a name that are compared: the time grows with their square."""


def likeness(name: str, known: Iterable[str], least: float = 0.6) -> str | None:
    """The known name most like another, with its unit or without, in upper or lower case; None if none is close.

    `least` is the ratio of `difflib`, 1 for the same letters.
    """
    names = tuple(known)
    bare = {each.removesuffix(f"_{suffix_of(each)}").casefold(): each for each in names}
    folded = bare | {each.casefold(): each for each in names}
    close = get_close_matches(name[:LONGEST].casefold(), folded, 1, least)
    return folded[close[0]] if close else None
