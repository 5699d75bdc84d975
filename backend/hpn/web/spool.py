"""Folder for files that exist while a request is answered: files of fleets, batches of lines."""

import asyncio
import errno
import logging
import os
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from hpn.web.door.problems import Problem
from hpn.web.settings import Settings
from hpn.words.wording import N_, Sentence

FULL = N_("The spool folder (HPN_SPOOL_FOLDER) is full: try again later.")
UNUSABLE = N_("The spool folder (HPN_SPOOL_FOLDER) is missing or not writable: try again later.")
FULL_CODES = frozenset({errno.ENOSPC, errno.EDQUOT})
CODES = FULL_CODES | {errno.ENOENT, errno.ENOTDIR, errno.EACCES, errno.EPERM, errno.EROFS, errno.EIO}
"""Error codes of a disk, which distinguish its errors from those of a connection."""

RETRY_SECONDS = 30
TRIED_BYTES = 64 * 1024
TRIAL_SECONDS = 1.0

logger = logging.getLogger(__name__)


def refusal(code: int | None) -> Problem:
    """Problem 503 for an unusable folder, by the system's error code."""
    return Problem.later(Sentence(FULL if code in FULL_CODES else UNUSABLE), RETRY_SECONDS)


@contextmanager
def usable() -> Iterator[None]:
    """Raise Problem 503 if the work inside fails for lack of the folder, or of room in it."""
    try:
        yield
    except OSError as error:
        if error.errno not in CODES:
            raise
        logger.error("the folder for files on their way can’t be used: %s", error)
        raise refusal(error.errno) from error


def require_room(folder: Path | None) -> None:
    """Raise Problem 503 if a small file can't be written to a folder; None: the system's folder for temporary files."""
    with usable(), tempfile.TemporaryFile(dir=folder, buffering=0) as file:
        left = memoryview(os.urandom(TRIED_BYTES))
        while left:  # on a full disk a write may be partial without an error
            left = left[file.write(left) :]
        os.fsync(file.fileno())


class Trial:
    """Test of whether the folder is writable, made at most once in TRIAL_SECONDS, however often it is asked for."""

    def __init__(self, settings: Settings) -> None:
        self._folder = settings.spool_folder
        self._trial: asyncio.Task[None] | None = None
        self._next = 0.0

    async def check(self) -> None:
        """Raise Problem 503 if the folder is not writable."""
        now = time.monotonic()
        if self._trial is None or (self._trial.done() and now >= self._next):
            self._next = now + TRIAL_SECONDS
            self._trial = asyncio.create_task(asyncio.to_thread(require_room, self._folder))
        await asyncio.shield(self._trial)
