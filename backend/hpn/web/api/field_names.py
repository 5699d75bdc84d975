"""Parameter `fields`: names of the fields that a reply and each entry of its list contain."""

from collections.abc import Collection
from typing import NamedTuple

from hpn.web.door.problems import Problem


class FieldNames(NamedTuple):
    """Names of the wanted fields, and of the wanted fields of each entry of the list."""

    names: Collection[str]
    of_each: Collection[str]


def field_names(text: str, thing: str, known: Collection[str], each: str, known_of_each: Collection[str]) -> FieldNames:
    """Names in a parameter; `each` and a point precede those of an entry. Problem 422 for an unknown name."""
    names = {name.strip() for name in text.split(",")}
    of_each = {name.removeprefix(f"{each}.") for name in names if name.startswith(f"{each}.")}
    names -= {f"{each}.{name}" for name in of_each}
    if unknown := (names - set(known)) | (of_each - set(known_of_each)):
        detail = f"names {min(unknown)!r:.80}, which is no field of {thing}"
        raise Problem(422, f"fields {detail}", [(("fields",), detail)])
    return FieldNames(names, known_of_each if each in names else of_each)
