"""Names that occur more than once in one JSON object: parsers silently take the last one."""

import json
from collections import Counter
from typing import Any

from hpn.application import InputError
from hpn.words.wording import N_, Sentence

MOST_SHOWN = 40
"""Characters of a name, at most, in a message."""


class RepeatedNameError(InputError):
    """JSON that would lose a value; `name` occurs more than once in one object."""

    def __init__(self, name: str, count: int) -> None:
        self.name = name[:MOST_SHOWN]
        values = {"name": repr(self.name), "count": str(count)}
        super().__init__(((), Sentence(N_("contains the name {name} {count} times in one object"), values)))


def require_unique(content: bytes) -> None:
    """Raise RepeatedNameError for JSON with a name more than once in one object, ValueError for anything but JSON."""
    json.loads(content, strict=False, parse_int=str, parse_float=str, object_pairs_hook=_distinct)


def _distinct(pairs: list[tuple[str, Any]]) -> None:
    if len(dict(pairs)) < len(pairs):
        raise RepeatedNameError(*Counter(name for name, _ in pairs).most_common(1)[0])
