"""Lists of saved documents over REST: their filters, orders and parts, the same for machines and selections."""

from collections.abc import Awaitable, Callable
from datetime import UTC, datetime
from typing import Annotated, Any, Literal, NamedTuple
from urllib.parse import urlencode

from pydantic import AfterValidator, BaseModel, ConfigDict, Field
from pydantic_core import PydanticCustomError
from starlette.requests import Request
from starlette.responses import Response

from hpn.store import LineFilter, Sorting, Store, Versions
from hpn.store.records import DocumentKind
from hpn.web.api.replies import SELECTIONS_LISTED
from hpn.web.archive import Line
from hpn.web.door.problems import Problem
from hpn.web.todays import versions_of


def _reference(reference: str | None) -> str:
    """Reference to search for; must not be empty: an empty variable in a script would list every document."""
    if not reference:
        raise PydanticCustomError("empty", "must not be empty; leave it out to list every document")
    return reference


Reference = Annotated[Line, AfterValidator(_reference), Field(json_schema_extra={"minLength": 1})]


class ListQuery(BaseModel):
    """Filters, order and part of a list."""

    model_config = ConfigDict(frozen=True)

    search: Line | None = Field(
        None,
        description="Only documents with each of these words in title, reference, author, or in name, gear or "
        "ordering code of an axis.",
    )
    reference: Reference | None = Field(None, description="Only documents with this reference.")
    author: Line | None = Field(None, description="Only documents of this author.")
    selected: Line | None = Field(None, description="Only documents that have an axis with this gear.")
    updated_since: datetime | None = Field(None, description="Only documents changed at this moment or later.")
    created_since: datetime | None = Field(None, description="Only documents created at this moment or later.")
    deleted_since: datetime | None = Field(
        None, description="Adds `deleted`, the ids of documents deleted since this moment, at most a year ago."
    )
    differs: Literal["verdict"] | None = Field(
        None, description="Only documents with another gear or verdict by today’s engine and catalogue."
    )
    sort: Sorting = Field(
        "-saved",
        description="Order, by default the newest first; a leading minus puts the last or the largest first.",
    )
    cursor: Annotated[str, Field(max_length=2000)] | None = Field(None, description="Cursor from the previous page.")
    limit: int = Field(50, ge=1, le=SELECTIONS_LISTED, description="Largest number of documents on a page.")


class KindQuery(ListQuery):
    """The same of machines, selections or both."""

    kind: Literal["machine", "selection", "all"] = Field("machine", description="Machines, selections or both.")


class ListPart(NamedTuple):
    """Part of a list, cursor of the next part, deleted ids, and number of documents without today's verdict."""

    lines: list[Any]
    next_cursor: str | None
    deleted: list[str]
    pending: int


async def part_of(
    request: Request,
    query: ListQuery,
    kind: DocumentKind | None,
    page_of: Callable[[LineFilter, str | None, int], Awaitable[tuple[list[Any], str | None]]],
) -> ListPart:
    """Requested part of a list; Problem 422 for an invalid cursor."""
    store: Store = request.app.state.store
    versions: Versions = versions_of(request.app.state)
    if pending := await store.pending(versions, kind):  # before the lines: lines that are not pending have `today`
        request.app.state.todays.wake()
    try:
        lines, following = await page_of(_filter_of(query, kind, versions), query.cursor, query.limit)
    except ValueError as error:
        raise Problem(422, f"cursor {error}", [(("cursor",), str(error))]) from None
    since = _moment(query.deleted_since, "deleted_since")
    deleted = [] if since is None else [id for id, _ in await store.deleted(since, kind)]
    return ListPart(lines, following, deleted, pending)


def _filter_of(query: ListQuery, kind: DocumentKind | None, versions: Versions) -> LineFilter:
    same = {name: getattr(query, name) for name in ("search", "reference", "author", "selected", "sort")}
    return LineFilter(
        kind,
        updated_since=_moment(query.updated_since, "updated_since"),
        created_since=_moment(query.created_since, "created_since"),
        changed_by=versions.key if query.differs else None,
        **same,
    )


def _moment(time: datetime | None, name: str) -> datetime | None:
    """Moment of the query in UTC, which is also the default zone; Problem 422 for a moment out of range."""
    if time is None:
        return None
    try:
        return (time if time.tzinfo else time.replace(tzinfo=UTC)).astimezone(UTC)
    except OverflowError:
        detail = "must be a moment such as 2026-11-26T08:30:00Z"
        raise Problem(422, f"{name} {detail}", [((name,), detail)]) from None


def linked(response: Response, request: Request, address: str, part: ListPart) -> Response:
    """Response with the address of the next part, if any, as Link."""
    if part.next_cursor:
        pairs = [(name, value) for name, value in request.query_params.multi_items() if name != "cursor"]
        following = urlencode([*pairs, ("cursor", part.next_cursor)])
        response.headers["Link"] = f'<{address}?{following}>; rel="next"'
    return response
