"""What the operating system refuses, in words; apart from the other refusals, because it needs no other module."""

import argparse
import errno

CALLERS, OTHERS = 2, 1
MEANING = {
    errno.ENOENT: "there is no such file",
    errno.EISDIR: "is a folder, where a file belongs",
    errno.EACCES: "must not be read by this user; see its permissions",
}


def words_of(error: OSError, options: argparse.Namespace) -> tuple[int, list[str]]:
    """Exit code and line: the caller's mistake where the error names a file, or what else was given."""
    text = MEANING.get(error.errno or 0) or error.strerror or str(error)
    if error.filename is None:
        return OTHERS, [f"hpn can’t go on: {text}"]
    return CALLERS, [f"{error.filename}: {text}"]
