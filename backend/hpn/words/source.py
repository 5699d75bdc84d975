"""Source of a catalogue's figure as text: the only module that writes and reads it.

Copies of the catalogue and the API hold it as text, such as `table 12.1, page 12`.
"""

from collections.abc import Mapping

from hpn.words.wording import N_, Sentence

_PAGE, _SUPPLIED = ", page ", "supplied by the user: "

_PLACES: Mapping[str, str] = {"table": N_("table {number}"), "section": N_("section {number}")}


def printed_source(place: str, page: int) -> str:
    """Source of a figure printed in the handbook, by its key in `sources.csv`."""
    return f"{place}{_PAGE}{page}"


def supplied_source(name: str) -> str:
    """Source of a figure from a supplement."""
    return f"{_SUPPLIED}{name}"


def is_supplied(source: str) -> bool:
    """True for a figure of the user's own."""
    return source.startswith(_SUPPLIED)


def source_sentence(source: str) -> Sentence:
    """Short source for any language: `table 12.1, p. 12`; any other text is a msgid."""
    if is_supplied(source):
        return Sentence(N_("supplied by the user: {source}"), {"source": source.removeprefix(_SUPPLIED)})
    place, _, page = source.partition(_PAGE)
    kind, _, number = place.partition(" ")
    if kind not in _PLACES:
        return Sentence("{text}", {"text": source}, ("text",))
    name = Sentence(_PLACES[kind], {"number": number})
    return Sentence(N_("{place}, p.\u202f{page}"), {"place": name, "page": page}) if page else name
