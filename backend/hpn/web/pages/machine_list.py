"""List of saved machines: last changed first, in parts, searched, filtered and sorted, beside the ways to begin
another."""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import Any, Literal, NamedTuple

import orjson
from fastapi import APIRouter
from pydantic import ValidationError
from starlette.requests import Request
from starlette.responses import Response

from hpn.store import LineFilter, MachineLine, SavedAxis, Versions
from hpn.web.archive import Line
from hpn.web.door.access import admit
from hpn.web.door.pools import compute
from hpn.web.door.problems import Problem, needs
from hpn.web.form.linked import onward
from hpn.web.pages.machine_upload import WORDS, Upload
from hpn.web.pages.machine_values import bound_of
from hpn.web.pages.machine_view import ADDRESS, REASON
from hpn.web.pages.rendering import or_reason, page
from hpn.web.pages.saved_list import LINES_ON_PAGE, NO_SUCH_PART
from hpn.web.todays import versions_of
from hpn.words.fields import Model
from hpn.words.wording import N_, Sentence

Order = Literal[
    "-updated",
    "updated",
    "title",
    "-title",
    "axes",
    "-axes",
    "utilisation",
    "-utilisation",
    "weight",
    "-weight",
]

SORTINGS = {"-updated": N_("last changed first"), "title": N_("title"), "-utilisation": N_("largest utilisation")}
"""Orders offered by name; the heads of columns offer the others."""

FILTERS = {"": N_("All"), "todo": N_("To do"), "mine": N_("Mine"), "differs": N_("other verdict today")}
"""Filters: all machines, those that need work, those of the reader's key, those with another verdict today."""


class MachineFilter(Model):
    """Filter and order of the list."""

    search: Line = ""
    show: Literal["", "todo", "mine", "differs"] = ""
    sort: Order = "-updated"


class MachineListed(NamedTuple):
    """Machine of the list, and its most used axis; None if no axis is suitable."""

    saved: MachineLine
    governing: SavedAxis | None

    @property
    def bound(self) -> float:
        """Largest utilisation with which the governing check of the most used axis passes."""
        return 1.0 if self.governing is None else bound_of(self.governing, orjson.loads(self.saved.common))

    @property
    def worst(self) -> float | None:
        """Utilisation of the most used axis in its worst case over the tolerances; None without tolerances."""
        worst: float | None = None if self.governing is None else self.governing.answer["worst_utilisation"]
        return worst


@or_reason(REASON)
async def show_machines(request: Request) -> Response:
    """Page of saved machines, last changed first. `/api/v1/machines` lists them as JSON, newest first."""
    query, versions = request.query_params, versions_of(request.app.state)
    cursor = query.get("cursor") or None
    context: dict[str, Any] = {"lines": [], "counts": {}, "filter": MachineFilter(), "problems": ()}
    following = None
    try:
        texts = {name: query[name] for name in MachineFilter.model_fields if name in query}
        context["filter"] = wanted = MachineFilter.model_validate(texts)
        filters = _filters(request, wanted, versions)
        filter = filters.get(wanted.show, filters[""])
        listed = await request.app.state.store.machine_list(cursor, LINES_ON_PAGE, filter, filters)
        request.app.state.todays.note(listed.lines)
        following = listed.next_cursor
        context["lines"] = [MachineListed(line, listed.governing.get(line.id)) for line in listed.lines]
        context["counts"] = listed.counts
    except ValidationError as error:
        context["problems"] = tuple(Sentence("{text}", {"text": fault.text}) for fault in Problem.of(error).errors)
    except ValueError:
        context["problems"] = (Sentence(NO_SUCH_PART),)
    choose = partial(address, context["filter"])
    context |= {
        **WORDS,
        "versions": versions.key,
        "choose": choose,
        "orders": SORTINGS,
        "filters": FILTERS,
        "newest": cursor and choose(),
        "older": following and choose(cursor=following),
        "draft": Upload(problems=context["problems"]),
    }
    return await compute(
        request, "pages", page, request, "machines.html", 422 if context["problems"] else 200, **context
    )


def _filters(request: Request, chosen_filter: MachineFilter, versions: Versions) -> Mapping[str, LineFilter]:
    """Filters of a search by their names; without a key there is none for one's own machines."""
    every = LineFilter(search=chosen_filter.search or None, sort=chosen_filter.sort)
    filters = {"": every, "todo": replace(every, todo=True), "differs": replace(every, changed_by=versions.key)}
    key: str | None = request.state.api_key
    return filters if key is None else filters | {"mine": replace(every, owner=key)}


def address(chosen_filter: MachineFilter, **changes: str) -> str:
    """Address of the list with changed filters."""
    pairs = {"search": chosen_filter.search, "show": chosen_filter.show, "sort": chosen_filter.sort, **changes}
    return onward(ADDRESS, **{name: text for name, text in pairs.items() if (name, text) != ("sort", "-updated")})


router = APIRouter(include_in_schema=False, dependencies=[needs("fleet")])
router.add_api_route(ADDRESS, show_machines, dependencies=[admit("listing")])
