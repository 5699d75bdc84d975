"""Outcome of a verification: each shown figure that differs, with the reason, and lines that can't be checked."""

from typing import Literal

from hpn import ENGINE_VERSION
from hpn.words.reply import Reply

Reason = Literal["catalogue", "engine", "file"]


class Finding(Reply, frozen=True):
    """One line or value that a file shows and that is not what is calculated; blank where one has none there.

    More than one reason where they can't be told apart.
    """

    place: str
    shown: str
    calculated: str
    reasons: tuple[Reason, ...]


class FileVersions(Reply, frozen=True):
    """FileVersions of calculation and catalogue, None where a file says none."""

    engine: str | None
    catalogue: str | None

    def reasons(self, catalogue: str) -> tuple[Reason, ...]:
        """Reasons for which a file of these versions may differ: it was altered where they are those of here."""
        found: list[Reason] = []
        if self.engine != ENGINE_VERSION:
            found.append("engine")
        if self.catalogue != catalogue:
            found.append("catalogue")
        return tuple(found) or ("file",)


class Verdict(Reply, frozen=True):
    """Verdict on a file: how many figures it shows that are the same, which differ, and what can't be checked."""

    file: str
    versions: FileVersions
    same: int
    differs: tuple[Finding, ...]
    unchecked: tuple[str, ...]
