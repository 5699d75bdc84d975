"""Saving a selection and opening it again, for the API and the pages alike."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, TypeVar

from pydantic import AfterValidator, Field, StringConstraints, ValidationError
from pydantic_core import PydanticCustomError
from starlette.datastructures import State
from starlette.requests import Request
from starlette.responses import Response

from hpn import ENGINE_VERSION
from hpn.application import Application, InputError, Model
from hpn.catalogue import Catalogue
from hpn.differences import Difference, FigureDifference, differences, figure_differences
from hpn.selection import Selection, decode, encode, select
from hpn.store import Draft, KeyReusedError, KeySpentError, SavedSelection
from hpn.web.door.observation import note
from hpn.web.door.pools import compute
from hpn.web.door.problems import Problem
from hpn.web.form.write import to_link

T = TypeVar("T")

CONTROLS = re.compile(r"[\x00-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069\ufffe\uffff]")
"""Control characters, line separators, marks that turn the direction of the text around them, and no characters."""


def _plain(text: str) -> str | None:
    if CONTROLS.search(text):
        raise PydanticCustomError("control_characters", "must not contain control characters or line breaks")
    return text or None


Line = Annotated[
    str,
    StringConstraints(strip_whitespace=True, max_length=200),
    AfterValidator(_plain),
    Field(
        json_schema_extra={
            "pattern": "^[^\\u0000-\\u001f\\u007f-\\u009f\\u2028-\\u202e\\u2066-\\u2069\\ufffe\\uffff]*$"
        }
    ),
]
"""One line of text; an empty one counts as none."""

RETRY_SECONDS = 5
"""Time after which to try a store that is out of reach again."""


class Labels(Model):
    """What people call a saved selection."""

    title: Line | None = Field(None, description="Title for people.", examples=["Rotary table, axis 7"])
    reference: Line | None = Field(None, description="Your own number, such as a part number.", examples=["4711-07"])


class SaveRequest(Labels):
    """An application to be saved with its result."""

    application: Application = Field(description="The application.")


@dataclass(frozen=True, slots=True)
class Reopened:
    """A saved selection as it was, and what today's engine and catalogue say to its application.

    `application` is None where a version with other inputs saved it. `problem` is why there is no answer `today`.
    `link` leads to the live form with a copy of the application. `then` is the catalogue of that time, and `figures`
    what today's publishes differently; None where that of then is not kept.
    """

    saved: SavedSelection
    selection: Selection
    application: Application | None
    today: Selection | None
    differences: list[Difference]
    problem: Problem | None
    link: str
    then: Catalogue | None
    figures: list[FigureDifference] | None


def url_of(id: str) -> str:
    """Address of the page of a saved selection."""
    return f"/selections/{id}"


async def keep(request: Request, draft: Draft) -> str:
    """Save for whoever asks; the id under which it is durable. Problem 422 or 410 for a key that was used before."""
    state: State = request.app.state
    state.metrics.selections(["none" if draft.selected is None else "selected"])
    try:
        id: str = await state.store.save(draft)
    except KeyReusedError as error:
        raise Problem(422, str(error)) from None
    except KeySpentError as error:
        raise Problem(410, str(error)) from None
    note(request, selection=id)
    return id


def draft_of(
    catalogue: Catalogue, application: Application, labels: Labels, key: str | None, owner: str | None = None
) -> Draft:
    """What is saved of an application: its own JSON, and the reply that `select` gives it; InputError as that."""
    selection = select(application, catalogue, to_link(application))
    return Draft(
        application=application.model_dump_json(exclude_unset=True).encode(),
        result=encode(selection),
        engine_version=ENGINE_VERSION,
        catalogue_version=catalogue.version,
        selected=selection.selected,
        title=labels.title,
        reference=labels.reference,
        idempotency_key=key,
        owner=owner,
        catalogue=catalogue,
    )


async def found(request: Request, id: str, work: Callable[[Reopened], T]) -> T:
    """What comes of a saved selection and what differs today, on a worker; Problem 404 where there is none."""
    state: State = request.app.state
    saved, then = await with_catalogue(state, id)
    return await compute(request, "pages", lambda: work(reopen(saved, then, state.catalogue)))


async def with_catalogue(state: State, id: str) -> tuple[SavedSelection, Catalogue | None]:
    """A saved selection and the catalogue it was saved under, None where that is not kept; Problem 404."""
    saved = await state.store.find(id)
    if saved is None:
        raise not_found(id)
    if saved.catalogue_version == state.catalogue.version:
        return saved, state.catalogue
    return saved, await state.store.catalogue(saved.catalogue_version)


def not_found(id: str) -> Problem:
    """There is no such saved selection."""
    return Problem(404, f"there is no saved selection {id[:60]!r}; it may have been deleted")


def reopen(saved: SavedSelection, then: Catalogue | None, catalogue: Catalogue) -> Reopened:
    """Ask today's engine and catalogue again, and compare; what was saved stays as it is."""
    before = decode(saved.result)
    gears = [candidate.designation for candidate in before.candidates]
    figures = None if then is None else [] if then is catalogue else figure_differences(then, catalogue, gears)
    application = None
    try:
        application = Application.model_validate_json(saved.application)
        after = select(application, catalogue, to_link(application))
    except (ValidationError, InputError) as error:
        return Reopened(saved, before, application, None, [], Problem.of(error), before.link, then, figures)
    return Reopened(saved, before, application, after, differences(before, after), None, after.link, then, figures)


async def unavailable(request: Request, error: Exception) -> Response:
    """The store is out of reach for now."""
    return Problem(503, str(error), headers={"Retry-After": str(RETRY_SECONDS)}).response()
