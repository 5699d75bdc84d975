"""Patterns over typed text, each with a limit on the text's length.

A pattern may take a time that grows with the square of the length, and holds the interpreter meanwhile. Modules of
tables use only these patterns.
"""

import re
from collections.abc import Callable, Iterator


class Pattern:
    """A regular expression for texts up to a length. A longer text is no match, stays unchanged, and is one part."""

    def __init__(self, pattern: str, longest: int, flags: re.RegexFlag = re.NOFLAG) -> None:
        self._compiled, self.longest = re.compile(pattern, flags), longest

    def fullmatch(self, text: str) -> re.Match[str] | None:
        """Match of a whole text."""
        return self._compiled.fullmatch(text) if len(text) <= self.longest else None

    def match(self, text: str) -> re.Match[str] | None:
        """Match at the beginning of a text."""
        return self._compiled.match(text) if len(text) <= self.longest else None

    def search(self, text: str) -> re.Match[str] | None:
        """First match in a text."""
        return self._compiled.search(text) if len(text) <= self.longest else None

    def finditer(self, text: str) -> Iterator[re.Match[str]]:
        """Matches in a text."""
        return self._compiled.finditer(text) if len(text) <= self.longest else iter(())

    def sub(self, new: str | Callable[[re.Match[str]], str], text: str) -> str:
        """A text with its matches replaced."""
        return self._compiled.sub(new, text) if len(text) <= self.longest else text

    def split(self, text: str) -> list[str]:
        """Parts of a text between matches."""
        return self._compiled.split(text) if len(text) <= self.longest else [text]
