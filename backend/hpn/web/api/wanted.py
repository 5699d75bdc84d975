"""Parameter `fields`: the names of what a reply is to have, and of what each entry of its list is to have."""

from collections.abc import Collection
from typing import NamedTuple

from hpn.web.door.problems import Problem


class FieldNames(NamedTuple):
    """Names of the fields that are wanted, and of those of each entry of the list."""

    names: Collection[str]
    of_each: Collection[str]


def field_names(text: str, thing: str, known: Collection[str], each: str, known_of_each: Collection[str]) -> FieldNames:
    """Names of a parameter, those of an entry behind `each` and a point; Problem 422 for one that is not known."""
    names = {name.strip() for name in text.split(",")}
    of_each = {name.removeprefix(f"{each}.") for name in names if name.startswith(f"{each}.")}
    names -= {f"{each}.{name}" for name in of_each}
    if unknown := (names - set(known)) | (of_each - set(known_of_each)):
        detail = f"names {min(unknown)!r:.80}, which is no field of {thing}"
        raise Problem(422, f"fields {detail}", [(("fields",), detail)])
    return FieldNames(names, known_of_each if each in names else of_each)
