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

Since = Annotated[datetime | None, Field(description="Only those of this moment or later.")]


def _reference(reference: str | None) -> str:
    """A reference to search for. Of an empty variable of a script, every document would come."""
    if not reference:
        raise PydanticCustomError("empty", "must not be empty; leave it out to list every document")
    return reference


Reference = Annotated[Line, AfterValidator(_reference), Field(json_schema_extra={"minLength": 1})]


class ListQuery(BaseModel):
    """Filters, order and part of a list."""

    model_config = ConfigDict(frozen=True)

    search: Line | None = Field(
        None, description="Only those with each of these words in title, reference, author, gear or ordering code."
    )
    reference: Reference | None = Field(None, description="Only those with this reference.")
    author: Line | None = Field(None, description="Only those of this author.")
    selected: Line | None = Field(None, description="Only those with an axis with this gear.")
    updated_since: Since = None
    created_since: Since = None
    deleted_since: Annotated[datetime | None, Field(description="Ids that were deleted since then, in `deleted`.")] = (
        None
    )
    differs: Literal["verdict"] | None = Field(
        None, description="Only those that get another gear or verdict by today’s engine and catalogue."
    )
    sort: Sorting = Field(
        "-saved",
        description="Order, by default the newest first; with a minus the last or the largest comes first.",
    )
    cursor: Annotated[str, Field(max_length=2000)] | None = Field(None, description="Cursor from the page before.")
    limit: int = Field(50, ge=1, le=SELECTIONS_LISTED, description="Largest number on a page.")


class KindQuery(ListQuery):
    """The same of machines, selections or both."""

    kind: Literal["machine", "selection", "all"] = Field("machine", description="Machines, selections or both.")


class ListPart(NamedTuple):
    """Part of a list, the cursor to the next one, ids that are gone, and how many documents are still to be asked."""

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
    """The part of a list that is asked for; Problem 422 for a cursor that isn't one."""
    store: Store = request.app.state.store
    versions: Versions = versions_of(request.app.state)
    if pending := await store.pending(versions, kind):  # before the lines: of none that is not pending it is unknown
        request.app.state.todays.wake()
    try:
        lines, following = await page_of(_wanted(query, kind, versions), query.cursor, query.limit)
    except ValueError as error:
        raise Problem(422, f"cursor {error}", [(("cursor",), str(error))]) from None
    since = _moment(query.deleted_since, "deleted_since")
    gone = [] if since is None else [id for id, _ in await store.deleted(since, kind)]
    return ListPart(lines, following, gone, pending)


def _wanted(query: ListQuery, kind: DocumentKind | None, versions: Versions) -> LineFilter:
    same = {name: getattr(query, name) for name in ("search", "reference", "author", "selected", "sort")}
    return LineFilter(
        kind,
        updated_since=_moment(query.updated_since, "updated_since"),
        created_since=_moment(query.created_since, "created_since"),
        changed_by=versions.key if query.differs else None,
        **same,
    )


def _moment(time: datetime | None, name: str) -> datetime | None:
    """A moment of the query, in UTC where it says no zone; Problem 422 for one before the first year."""
    if time is None:
        return None
    try:
        return (time if time.tzinfo else time.replace(tzinfo=UTC)).astimezone(UTC)
    except OverflowError:
        detail = "must be a moment such as 2026-11-26T08:30:00Z"
        raise Problem(422, f"{name} {detail}", [((name,), detail)]) from None


def linked(response: Response, request: Request, address: str, part: ListPart) -> Response:
    """The response with the address of the next part."""
    if part.next_cursor:
        pairs = [(name, value) for name, value in request.query_params.multi_items() if name != "cursor"]
        following = urlencode([*pairs, ("cursor", part.next_cursor)])
        response.headers["Link"] = f'<{address}?{following}>; rel="next"'
    return response
