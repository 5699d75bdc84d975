"""Lists of motors: a table is pasted or opened, its columns are put right, and it is kept, edited or deleted.

A list that is edited goes the same way as a new one: the page writes it as a table, which is read again.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any
from urllib.parse import urlencode

from fastapi import APIRouter
from pydantic import ValidationError
from starlette.requests import Request
from starlette.responses import RedirectResponse, Response

from hpn.application import MotorEntry
from hpn.application.faults import sentences_of
from hpn.engine.motors import entries_of
from hpn.store import SavedMotorList, StoreUnavailableError
from hpn.tables.files import packed, unpacked
from hpn.tables.motors import MOTORS
from hpn.tables.reading import Reading
from hpn.tables.table import Table
from hpn.web import motor_lists
from hpn.web.door.access import ADMIN, admit
from hpn.web.door.bodies import pairs_of, read_form
from hpn.web.door.hosts import require_same_origin
from hpn.web.door.pools import compute
from hpn.web.door.problems import Problem
from hpn.web.door.uploads import decoded, read_parts
from hpn.web.form.linked import query_part
from hpn.web.motor_lists import SERVER, MotorList, draft_of
from hpn.web.motor_tables import WANTED, as_text, motors_in
from hpn.web.pages.reading import read
from hpn.web.pages.rendering import or_reason, page
from hpn.web.pages.saved_list import changed_since, version_of
from hpn.words.wording import N_, Sentence

ADDRESS = "/motor-lists"
REASON = "motor_list_refused.html"
"""Page that says why a list can't be shown or changed."""

NOTHING = N_("choose a file or paste cells into the field")
NO_NAME = N_("Name the list.")
NO_MOTORS = N_("The table has no motor that can be taken.")
MOST_SHOWN = 300
"""Motors of a list that its page shows as a table; its text has all of them."""


@dataclass(frozen=True, slots=True)
class MotorUpload:
    """A table of motors as it is read: what was given, what it leaves open, and the motors that come of it.

    `list` is the list that it replaces, blank for a new one, `version` the state of it that was opened; `link` the
    application whose pairs are wanted; `carried` the table itself, for a form that can't send its file again.
    """

    name: str = ""
    link: str = ""
    text: str = ""
    list: str = ""
    version: str = ""
    problems: tuple[Sentence, ...] = ()
    table: Table | None = None
    of: str = ""
    carried: str = ""
    sheets: tuple[str, ...] = ()
    sheet: str = ""
    said: tuple[Sentence, ...] = ()
    motors: tuple[MotorEntry, ...] = field(default=(), repr=False)


# --- Lists ------------------------------------------------------------------------------------------------------------


@or_reason(REASON)
async def show_lists(request: Request) -> Response:
    """All lists by their names, and the form for another. `/api/v1/motor-lists` says the same as JSON."""
    shown: dict[str, Any] = {
        "lines": await motor_lists.lines_of(request),
        "server": len(request.app.state.catalogue.motors),
        "draft": MotorUpload(),
        "roles": MOTORS.by_role,
    }
    return await compute(request, "pages", page, request, "motor_lists.html", **shown)


@or_reason(REASON)
async def show_list(request: Request) -> Response:
    """A list with its motors, to be edited by whoever may."""
    id, state = request.path_params["id"], request.app.state
    if id == SERVER:
        return await _shown(request, SERVER, entries_of(state.catalogue.motors), None)
    saved = await motor_lists.found(request, id)
    return await _shown(request, saved.name, motor_lists.entries_in(saved), saved)


async def _shown(request: Request, name: str, motors: list[MotorEntry], saved: SavedMotorList | None) -> Response:
    free = not request.app.state.gate.has_keys
    may_change = saved is not None and (free or request.state.api_key in (ADMIN, saved.owner or ADMIN))
    draft = MotorUpload()
    if saved is not None and may_change:
        draft = MotorUpload(saved.name, text=as_text(motors), list=saved.id, version=str(saved.version))
    shown: dict[str, Any] = {
        "title": name,
        "saved": saved,
        "motors": motors[:MOST_SHOWN],
        "count": len(motors),
        "may_change": may_change,
        "draft": draft,
        "roles": MOTORS.by_role,
    }
    return await compute(request, "pages", page, request, "motor_list.html", **shown)


# --- Reading and keeping ----------------------------------------------------------------------------------------------


async def read_list(request: Request) -> Response:
    """Shows how each column of a table is read, or keeps it as a list and leads to its pairs, or to its page."""
    return await _taken(request, "")


async def save_list(request: Request) -> Response:
    """The same in place of a list that there is."""
    return await _taken(request, request.path_params["id"])


async def _taken(request: Request, id: str) -> Response:
    draft, headers, status = MotorUpload(list=id), dict[str, str](), 200
    try:
        require_same_origin(request)
        draft, keeps = await _read(request, id)
        saved = await motor_lists.changeable(request, id) if id else None
        if keeps and not draft.problems and draft.table and draft.table.whole:
            return await _kept(request, draft, saved)
        status = 422 if draft.problems else 200
    except (Problem, StoreUnavailableError) as error:
        problem = Problem.of(error) if isinstance(error, StoreUnavailableError) else error
        told = tuple(problem.sentences) or (Sentence("{text}", {"text": problem.detail}),)
        draft = replace(draft, problems=told)
        status, headers = problem.status_code, dict(problem.headers or {})
    shown = {"draft": draft, "roles": MOTORS.by_role}
    response = await compute(request, "pages", page, request, "motor_list_read.html", status, **shown)
    response.headers.update(headers)
    return response


async def _read(request: Request, id: str) -> tuple[MotorUpload, bool]:
    """A table as it is read beside the service, and whether it is to be kept as it is."""
    parts = await read_parts(request)
    fields = {name: decoded(part) for name, part in parts.items() if name not in ("file", "table")}
    text = fields.get("text", "").strip()
    content: bytes | str = parts.get("file") or text
    content = content or await compute(request, "pages", unpacked, parts.get("table", b""))
    draft = MotorUpload(
        " ".join(fields.get("name", "").split()),
        query_part(fields.get("link", "")),
        fields.get("text", ""),
        id,
        fields.get("version", ""),
    )
    if not content.strip():
        return replace(draft, problems=(Sentence(NOTHING),)), False
    reading = await read(request, content, WANTED, fields)
    return await compute(request, "pages", _draft_of, draft, content, reading), "keep" in fields


def _draft_of(draft: MotorUpload, content: bytes | str, reading: Reading) -> MotorUpload:
    table = reading.table
    if table is None:
        return replace(draft, problems=(Sentence(NO_MOTORS),))
    motors, said = motors_in(table)
    problems: tuple[Sentence, ...] = (table.problem,) if table.problem else ()
    if table.whole and not motors:
        problems = (*said, Sentence(NO_MOTORS))
    carried = packed(content.encode() if isinstance(content, str) else content)
    return replace(
        draft,
        problems=problems,
        table=table,
        of=reading.of,
        carried=carried,
        sheets=reading.sheets,
        sheet=reading.sheet,
        said=tuple(said),
        motors=tuple(motors),
    )


async def _kept(request: Request, draft: MotorUpload, saved: SavedMotorList | None) -> Response:
    """Redirect to the pairs of the application that the list is for, else to the list; Problem where it isn't kept."""
    if not draft.name:
        raise Problem(422, Sentence(NO_NAME))
    try:
        sent = MotorList.model_validate({"name": draft.name, "motors": draft.motors})
    except ValidationError as error:
        raise Problem(422, [sentence for _, sentence, _ in sentences_of(error)][:5]) from None
    if saved is None:
        id = (await motor_lists.kept(request, draft_of(sent))).id
    else:
        version = version_of({"version": draft.version})
        if version not in (None, saved.version):
            raise changed_since()
        id = (await motor_lists.replaced(request, saved.id, draft_of(sent), version)).id
    return RedirectResponse(_onward(draft.link, id), 303)


def _onward(link: str, id: str) -> str:
    return f"/pairs?{link}&{urlencode({'list': id})}" if link else f"{ADDRESS}/{id}"


@or_reason(REASON)
async def delete_list(request: Request) -> Response:
    """Deletes a list for good, and leads back to the lists. What was taken from it keeps its figures."""
    require_same_origin(request)
    fields: Mapping[str, str] = dict(pairs_of(await read_form(request)))
    saved = await motor_lists.changeable(request, request.path_params["id"])
    version = version_of(fields)
    if version not in (None, saved.version):
        raise changed_since()
    await motor_lists.removed(request, saved.id, version)
    return RedirectResponse(ADDRESS, 303)


router = APIRouter(include_in_schema=False)
router.add_api_route(ADDRESS, show_lists, dependencies=[admit("listing")])
router.add_api_route(ADDRESS, read_list, methods=["POST"], dependencies=[admit("writing")])
router.add_api_route(f"{ADDRESS}/{{id}}", show_list, dependencies=[admit("reading")])
router.add_api_route(f"{ADDRESS}/{{id}}/save", save_list, methods=["POST"], dependencies=[admit("deleting")])
router.add_api_route(f"{ADDRESS}/{{id}}/delete", delete_list, methods=["POST"], dependencies=[admit("deleting")])
