"""Links in requests: the source of a file's content, and the selection that is carried from page to page."""

from collections.abc import Mapping
from dataclasses import dataclass
from urllib.parse import urlencode

from starlette.requests import Request

from hpn.application import Application
from hpn.web.door.bodies import pairs_of
from hpn.web.door.problems import Problem
from hpn.web.door.uploads import read_fields
from hpn.web.door.visit import address
from hpn.web.form import link_reader
from hpn.web.form.form import Form
from hpn.web.form.query import CONDITION, Pairs


@dataclass(frozen=True, slots=True)
class Link:
    """Content of a link: an application, the gear shown or an empty text, labels, and options of a file."""

    application: Application
    gear: str
    labels: Mapping[str, str]
    options: Mapping[str, str]


async def query_of(request: Request, *options: str) -> str:
    """Query of the link in the address, or in the field `link` of a form for links too long for an address.

    Of the form's other fields only `options` are used.
    """
    if request.method != "POST":
        query: bytes = request.scope["query_string"]
        return query.decode("latin-1")
    fields = await read_fields(request)
    options_query = "".join(f"&{name}={fields[name]}" for name in options if name in fields)
    return query_part(fields.get("link", "")) + options_query


def query_part(link: str) -> str:
    """Query of a link, which may lack its path."""
    return link.removeprefix("/").removeprefix("?")


def linked(query: str, *options: str) -> Link:
    """Content of the query of a link; Problem 422 names each parameter that can't be read."""
    pairs = pairs_of(query)
    form = link_reader.parse([pair for pair in pairs if pair[0] not in options])
    if form.application is None:
        raise _unreadable(form)
    return Link(form.application, form.gear, form.labels, {name: value for name, value in pairs if name in options})


def _unreadable(form: Form) -> Problem:
    errors = [
        ((problem.name, *(() if problem.index is None else (problem.index,))), problem.message.text)
        for problem in form.problems
    ]
    listed = "; ".join(f"{location[0]} {text}" for location, text in errors[:3])
    return Problem(422, listed or "the link has no application: give T, n and t for each phase", errors)


# --- From page to page ------------------------------------------------------------------------------------------------

WRITTEN_AT = "at_written"
"""Parameter for the marker of the language and units in which a condition is typed."""

OWN_NAMES = frozenset(
    (
        *("output", "motor", "find", "only_size", "only_i", "sort", "search", "reference", "cursor", "id", "a", "b"),
        *("back", WRITTEN_AT, *CONDITION),
    )
)
"""Parameters of the pages themselves; all others belong to the carried selection."""

LONGEST_LINK = 4000
"""Characters of the longest selection that is carried on."""


def carried_pairs() -> Pairs:
    """Parameters of the selection in the address of the request under way; none if it has no selection."""
    _, _, query = address().partition("?")
    pairs = [(name, text) for name, text in pairs_of(query) if name not in OWN_NAMES]
    known = any(name == "T" for name, _ in pairs)
    return pairs if known and len(urlencode(pairs)) <= LONGEST_LINK else []


def onward(path: str, **more: str) -> str:
    """Address of another page with the carried selection; parameters given here replace those of the selection."""
    pairs = [pair for pair in carried_pairs() if pair[0] not in more] + [(n, t) for n, t in more.items() if t]
    return f"{path}?{urlencode(pairs)}" if pairs else path
