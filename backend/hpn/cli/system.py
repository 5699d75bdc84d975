"""Errors of the operating system in words; a module of its own because it imports no other."""

import argparse
import errno
import os

CALLERS = 2
MEANING = {
    errno.ENOENT: "there is no such file",
    errno.EISDIR: "is a folder, where a file belongs",
    errno.EACCES: "this user has no permission for it",
}


def others(options: argparse.Namespace) -> int:
    """Exit code for errors that are not the caller's; in `hpn select` 1 is an answer: no gear is suitable."""
    return 3 if options.command == "select" else 1


def words_of(error: OSError, options: argparse.Namespace) -> tuple[int, list[str]]:
    """Exit code and line; the caller's mistake where the error names a file or another argument."""
    number, text = error.errno or 0, error.strerror or str(error)
    if text == os.strerror(number):  # a command's own words say more
        text = MEANING.get(number, text)
    if error.filename is None:
        return others(options), [f"hpn can’t go on: {text}"]
    return CALLERS, [f"{error.filename}: {text}"]
