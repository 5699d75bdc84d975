"""Saving and reopening of selections, for both API and pages."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated, TypeVar

from pydantic import AfterValidator, Field, StringConstraints, ValidationError
from pydantic_core import PydanticCustomError
from starlette.datastructures import State
from starlette.requests import Request

from hpn import ENGINE_VERSION
from hpn.application import Application, InputError
from hpn.catalogue import Catalogue
from hpn.catalogue.ordering import OrderingCode, read_ordering_code
from hpn.documents import answers
from hpn.documents.revision import SAVED, is_label
from hpn.engine.kept import UnreadableReplyError, decode, fields_of
from hpn.engine.selection import Selection, encode, select
from hpn.explain.differences import Difference, FigureDifference, differences, figure_differences
from hpn.links.labels import FIELDS, query_of
from hpn.links.writer import to_link
from hpn.store import Draft, KeyReusedError, KeySpentError, RevisionLine, SavedSelection
from hpn.web.columns import columns_of
from hpn.web.door.observation import note
from hpn.web.door.pools import compute
from hpn.web.door.problems import Problem
from hpn.words.fields import Model
from hpn.words.titles import CONTROLS, LONGEST_TITLE, NO_CONTROLS, SCHEMA_CONTROLS, Title
from hpn.words.wording import N_, Sentence

T = TypeVar("T")


def _line(text: str) -> str | None:
    if CONTROLS.search(text):
        raise PydanticCustomError("control_characters", NO_CONTROLS)
    return text or None


Line = Annotated[
    str,
    StringConstraints(strip_whitespace=True, max_length=LONGEST_TITLE),
    AfterValidator(_line),
    Field(json_schema_extra={"pattern": f"^[^{SCHEMA_CONTROLS}]*$"}),
]
"""One line of text that is used for searching; an empty line becomes None."""


class Names(Model):
    """Title and reference of a saved selection, which may be changed later."""

    title: Title | None = Field(None, description="Title for people.", examples=["Rotary table, axis 7"])
    reference: Title | None = Field(None, description="Your own number, such as a part number.", examples=["4711-07"])


class Labels(Names):
    """Labels that people give a saved selection."""

    author: Title | None = Field(None, description="Author.", examples=["M. Muster"])
    revision: Title | None = Field(None, description="Its revision in your own documents.", examples=["B"])
    ordering_code: Line | None = Field(
        None,
        description="Gear, output version and motor adapter as ordered, as far as they are known. The gear must be a "
        "candidate; page and files then show it first.",
        examples=["HPN-20A-5-J6-BH-AF1"],
    )


class SaveRequest(Labels):
    """An application to be saved with its result."""

    application: Application = Field(description="The application.")


@dataclass(frozen=True, slots=True)
class Reopened:
    """Saved selection as it was, and the answer of today's engine and catalogue to its application.

    `application` is None if a version with other inputs saved it. `problem` is the reason if there is no `today`.
    `link` leads to the live form with a copy of the application and its labels. `then` is the catalogue of that time,
    and `figures` are its differences from today's; both are None if that catalogue is not kept.
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
    """Save a draft; its id once it is durable. Problem 422 or 410 for an idempotency key that was used before."""
    state: State = request.app.state
    state.metrics.selections(["none" if draft.selected is None else "selected"])
    try:
        id: str = await state.store.save(draft)
    except KeyReusedError as error:
        raise Problem(422, str(error), kind="idempotency-key-reused") from None
    except KeySpentError as error:
        raise Problem(410, str(error), kind="idempotency-key-spent") from None
    note(request, selection=id)
    return id


def draft_of(
    catalogue: Catalogue, application: Application, labels: Labels, key: str | None, owner: str | None = None
) -> Draft:
    """Record of an application to be saved: its JSON and the reply of `select`; raises InputError as `select` does."""
    selection = select(application, catalogue, to_link)
    code = _ordered(catalogue, selection, labels.ordering_code)
    candidate = selection.foremost if code is None else selection.candidate(code.gear.designation)
    assert candidate is not None  # `_ordered` refuses a gear that is no candidate
    revision, cycle = labels.revision or "", application.duty_cycle
    return Draft(
        application=application.model_dump_json(exclude_unset=True).encode(),
        result=encode(selection),
        engine_version=ENGINE_VERSION,
        catalogue_version=catalogue.version,
        selected=selection.selected,
        title=labels.title,
        reference=labels.reference,
        author=labels.author,
        revision=labels.revision,
        ordering_code=None if code is None else code.text,
        designation=candidate.designation,
        status=candidate.status,
        utilisation=candidate.utilisation,
        idempotency_key=key,
        owner=owner,
        catalogue=catalogue,
        answer=columns_of(answers.answer_of(selection, candidate, catalogue)),
        phases=len(cycle.motion.moves if cycle.motion else cycle.phases or ()),
        label=revision if is_label(revision) else SAVED,
    )


def _ordered(catalogue: Catalogue, selection: Selection, text: str | None) -> OrderingCode | None:
    """Ordering code read from a text; InputError for an invalid code and for a gear that is no candidate."""
    if text is None:
        return None
    code = read_ordering_code(catalogue, text)
    if isinstance(code, OrderingCode) and selection.candidate(code.gear.designation) is None:
        values = {"gear": code.gear.designation}
        code = Sentence(answers.NO_CANDIDATE, values)
    if isinstance(code, Sentence):
        raise InputError((("ordering_code",), code))
    return code


def _link(saved: SavedSelection, selection: Selection, catalogue: Catalogue) -> str:
    """Address of the live page with the saved application, the gear of its ordering code, and its labels."""
    labels = {name: getattr(saved, field) or "" for name, field in FIELDS.items()}
    gear, code = "", read_ordering_code(catalogue, saved.ordering_code or "")
    if isinstance(code, OrderingCode):
        labels |= code.labels
        designation = code.gear.designation
        gear = "" if designation == selection.foremost.designation else f"&gear={designation}"
    return selection.link + gear + query_of(labels)


async def on_saved(request: Request, id: str, work: Callable[[Reopened], T], label: str | None = None) -> T:
    """Result of `work` on a reopened selection or revision, computed on a worker; Problem 404 for an unknown one."""
    state: State = request.app.state
    saved, then = await with_catalogue(state, id, label)
    return await compute(request, "pages", lambda: work(reopen(saved, then, state.catalogue)))


async def with_catalogue(state: State, id: str, label: str | None = None) -> tuple[SavedSelection, Catalogue | None]:
    """Saved selection in its latest revision or that of a label, and its catalogue of that time, None if that is not
    kept; Problem 404 for an unknown id or label.
    """
    saved = await state.store.find(id, label)
    if saved is None and label is not None and (latest := await state.store.find(id)) is not None:
        raise no_revision(url_of(id), label, latest.revisions)
    if saved is None:
        raise not_found(id)
    if saved.catalogue_version == state.catalogue.version:
        return saved, state.catalogue
    return saved, await state.store.catalogue(saved.catalogue_version)


async def changeable(request: Request, id: str) -> SavedSelection:
    """Saved selection that the caller may rename and delete; Problem 404, 403, or on a page 401 without a key."""
    state: State = request.app.state
    saved = await latest_of(state, id)
    state.gate.require_owner(request, saved.owner)
    return saved


async def latest_of(state: State, id: str) -> SavedSelection:
    """Saved selection in its latest revision; Problem 404 for an unknown id."""
    saved: SavedSelection | None = await state.store.find(id)
    if saved is None:
        raise not_found(id)
    return saved


def not_found(id: str) -> Problem:
    """Problem 404 for an unknown saved selection."""
    return Problem(404, f"there is no saved selection {id[:60]!r}; it may have been deleted")


NO_REVISION = N_("There is no revision “{label}”; there are {labels}.")
NO_REVISION_OF_MANY = N_("There is no revision “{label}”; there are {labels} and {count} older ones.")
NO_REVISION_YET = N_("There is no revision “{label}”: none is saved yet.")
MOST_NAMED = 20
"""Maximum revisions that a Problem for an unknown label names."""


def no_revision(place: str, label: str, lines: Sequence[RevisionLine]) -> Problem:
    """Problem 404 for an unknown revision of the document at `place`; it names the existing ones, the latest first."""
    named = [line.label for line in lines[:MOST_NAMED]]
    more = len(lines) - len(named)
    text = NO_REVISION_YET if not lines else NO_REVISION_OF_MANY if more else NO_REVISION
    values = {"label": repr(label[:20])[1:-1], "labels": ", ".join(named), "count": str(more)}
    return Problem(404, Sentence(text, values), ways=[(f"{place}?revision={each}", each) for each in named])


def answer_of(saved: SavedSelection) -> Selection:
    """Answer as saved; Problem 409 for an unreadable one."""
    try:
        return decode(saved.result)
    except UnreadableReplyError as error:
        raise Problem(409, Sentence(UNREADABLE), [(("result",), str(error))]) from None


UNREADABLE = N_("This saved answer can’t be read: parts are missing that the answers of every version have.")


def reopen(saved: SavedSelection, then: Catalogue | None, catalogue: Catalogue) -> Reopened:
    """Saved selection with the answer of today's engine and catalogue, and the differences; changes nothing saved."""
    before = answer_of(saved)
    application, after, changes, problem = None, None, list[Difference](), None
    try:
        application = Application.model_validate_json(saved.application)
        after = select(application, catalogue, to_link)
        changes = differences(fields_of(saved.result), after)
    except (ValidationError, InputError) as error:
        problem = Problem.of(error)
    link = _link(saved, after or before, catalogue)
    figures = _figures(before, application, then, catalogue)
    return Reopened(saved, before, application, after, changes, problem, link, then, figures)


def _figures(
    before: Selection, application: Application | None, then: Catalogue | None, today: Catalogue
) -> list[FigureDifference] | None:
    """Differences between two catalogues for the candidates and the listed motor; None if `then` is not kept."""
    if then is None or then is today:
        return None if then is None else []
    motor = application.requirements.motor if application else None
    gears = [candidate.designation for candidate in before.candidates]
    return figure_differences(then, today, gears, motor.designation if motor else None)
