"""Outcome of a verification: the figures that differ, with the reasons, and the lines that can't be checked."""

from typing import Literal

from hpn import ENGINE_VERSION
from hpn.words.reply import Reply

Reason = Literal["catalogue", "engine", "file"]


class Finding(Reply, frozen=True):
    """Line or value of a file that differs from the calculated one; a side without one is blank.

    There is more than one reason where they can't be told apart.
    """

    place: str
    shown: str
    calculated: str
    reasons: tuple[Reason, ...]


class FileVersions(Reply, frozen=True):
    """Versions of calculation and catalogue; None where the file has none."""

    engine: str | None
    catalogue: str | None

    def reasons(self, catalogue: str, *limits: object) -> tuple[Reason, ...]:
        """Reasons why a file of these versions may differ: it was altered where both versions are those of this
        installation.

        Where both versions differ, the limits of its checks and those of today, if given, decide between the two.
        """
        reasons: list[Reason] = []
        if self.engine != ENGINE_VERSION:
            reasons.append("engine")
        if self.catalogue != catalogue:
            reasons.append("catalogue")
        if len(reasons) > 1 and limits:
            return ("engine",) if limits[0] == limits[1] else ("catalogue",)
        return tuple(reasons) or ("file",)


class Verdict(Reply, frozen=True):
    """Verdict on a file: number of equal figures, the figures that differ, and the lines that can't be checked."""

    file: str
    versions: FileVersions
    same: int
    differs: tuple[Finding, ...]
    unchecked: tuple[str, ...]
