"""Lists of motors: a table is pasted or opened, its columns are corrected, and the list is stored, edited or deleted.

An edited list takes the same way as a new one: the page writes it as a table, which is read again.
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
from hpn.tables.motor_inputs import MOTORS
from hpn.tables.reading import Reading
from hpn.web import motor_lists
from hpn.web.door.access import admit
from hpn.web.door.bodies import pairs_of, read_form
from hpn.web.door.hosts import require_same_origin
from hpn.web.door.pools import compute
from hpn.web.door.problems import Problem
from hpn.web.door.uploads import decoded, read_parts
from hpn.web.form.linked import query_part
from hpn.web.motor_lists import SERVER, MotorList, draft_of
from hpn.web.motor_tables import BOUNDS, as_text, motors_in
from hpn.web.pages.reading import read
from hpn.web.pages.rendering import or_reason, page
from hpn.web.pages.saved_list import changed_since, version_of
from hpn.web.pages.table_upload import NOTHING, TableUpload, content_of, show_form
from hpn.words.wording import N_, Sentence

ADDRESS = "/motor-lists"
REASON = "motor_list_refused.html"
"""Page with the reason why a list can't be shown or changed."""

UNAVAILABLE = N_("Motor lists are temporarily unavailable: try again in a few seconds.")
NO_NAME = N_("Name the list.")
NO_MOTORS = N_("The table has no motor that can be taken.")
MOST_SHOWN = 300
"""Maximum motors that a list's page shows as a table; its text has all of them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MotorUpload(TableUpload):
    """Table of motors as read, and its motors.

    `list` is the id of the list to replace, blank for a new one, and `version` its version when it was opened; `link`
    is the application whose pairs are wanted.
    """

    name: str = ""
    link: str = ""
    list: str = ""
    version: str = ""
    notes: tuple[Sentence, ...] = ()
    motors: tuple[MotorEntry, ...] = field(default=(), repr=False)


# --- Lists ------------------------------------------------------------------------------------------------------------


@or_reason(REASON)
async def show_lists(request: Request) -> Response:
    """Page of all lists by their names, with the form for another. `/api/v1/motor-lists` is the same as JSON."""
    context: dict[str, Any] = {
        "lines": await motor_lists.lines_of(request),
        "server": len(request.app.state.catalogue.motors),
        "draft": MotorUpload(),
        "roles": MOTORS.by_role,
    }
    return await compute(request, "pages", page, request, "motor_lists.html", **context)


@or_reason(REASON)
async def show_list(request: Request) -> Response:
    """Page of a list with its motors and the form that edits it; `edit` is the step that asks for the key."""
    id, state = request.path_params["id"], request.app.state
    if id == SERVER:
        return await _list_page(request, SERVER, entries_of(state.catalogue.motors), None)
    saved = await motor_lists.list_of(request, id)
    state.gate.require_key_to_edit(request, saved.owner)
    return await _list_page(request, saved.name, motor_lists.entries_in(saved), saved)


async def _list_page(request: Request, name: str, motors: list[MotorEntry], saved: SavedMotorList | None) -> Response:
    may_change = saved is not None and request.app.state.gate.may_change(request, saved.owner)
    draft = MotorUpload()
    if saved is not None and may_change:
        draft = MotorUpload(name=saved.name, text=as_text(motors), list=saved.id, version=str(saved.version))
    context: dict[str, Any] = {
        "title": name,
        "saved": saved,
        "motors": motors[:MOST_SHOWN],
        "count": len(motors),
        "may_change": may_change,
        "draft": draft,
        "roles": MOTORS.by_role,
    }
    return await compute(request, "pages", page, request, "motor_list.html", **context)


# --- Reading and keeping ----------------------------------------------------------------------------------------------


async def read_list(request: Request) -> Response:
    """Show how each column of a table is read, or store it as a list and redirect to its pairs, or to its page."""
    return await _uploaded(request, "")


async def save_list(request: Request) -> Response:
    """Show how each column of a table is read, or replace an existing list by it."""
    return await _uploaded(request, request.path_params["id"])


async def _uploaded(request: Request, id: str) -> Response:
    draft, refusal = MotorUpload(list=id), None
    try:
        require_same_origin(request)
        draft, keeps = await _read(request, id)
        saved = await motor_lists.changeable(request, id) if id else None
        if keeps and not draft.problems and draft.table and draft.table.whole:
            return await _store(request, draft, saved)
    except (Problem, StoreUnavailableError) as error:
        refusal = error
    return await show_form(request, "motor_list_read.html", draft, refusal, UNAVAILABLE, roles=MOTORS.by_role)


async def _read(request: Request, id: str) -> tuple[MotorUpload, bool]:
    """Table read beside the service, and True if it is to be stored as read."""
    parts = await read_parts(request)
    fields = {name: decoded(part) for name, part in parts.items() if name not in ("file", "table")}
    content = await content_of(request, parts, fields.get("text", ""))
    draft = MotorUpload(
        name=" ".join(fields.get("name", "").split()),
        link=query_part(fields.get("link", "")),
        text=fields.get("text", ""),
        list=id,
        version=fields.get("version", ""),
    )
    if not content.strip():
        return draft.refused(Sentence(NOTHING)), False
    reading = await read(request, content, BOUNDS, fields)
    return await compute(request, "pages", _draft_of, draft, content, reading), "keep" in fields


def _draft_of(draft: MotorUpload, content: bytes | str, reading: Reading) -> MotorUpload:
    table = reading.table
    if table is None:
        return draft.refused(Sentence(NO_MOTORS))
    motors, notes = motors_in(table)
    problems: tuple[Sentence, ...] = (table.problem,) if table.problem else ()
    if table.whole and not motors:
        problems = (*notes, Sentence(NO_MOTORS))
    whole = draft.as_read(content, reading)
    return replace(whole, problems=problems, notes=tuple(notes), motors=tuple(motors))


async def _store(request: Request, draft: MotorUpload, saved: SavedMotorList | None) -> Response:
    """Store a list; redirect to the pairs of its application, else to the list. Raises Problem for an invalid list."""
    if not draft.name:
        raise Problem(422, Sentence(NO_NAME))
    try:
        motors = MotorList.model_validate({"name": draft.name, "motors": draft.motors})
    except ValidationError as error:
        raise Problem(422, [sentence for _, sentence, _ in sentences_of(error)][:5]) from None
    if saved is None:
        id = (await motor_lists.keep(request, draft_of(motors))).id
    else:
        version = version_of({"version": draft.version})
        id = (await motor_lists.replace(request, saved.id, draft_of(motors), version, changed_since())).id
    place = f"/pairs?{draft.link}&{urlencode({'list': id})}" if draft.link else f"{ADDRESS}/{id}"
    return RedirectResponse(place, 303)


@or_reason(REASON)
async def delete_list(request: Request) -> Response:
    """Delete a list permanently, and redirect to the lists. Applications keep the figures that they took from it."""
    require_same_origin(request)
    fields: Mapping[str, str] = dict(pairs_of(await read_form(request)))
    saved = await motor_lists.changeable(request, request.path_params["id"])
    await motor_lists.remove(request, saved.id, version_of(fields), changed_since())
    return RedirectResponse(ADDRESS, 303)


router = APIRouter(include_in_schema=False)
router.add_api_route(ADDRESS, show_lists, dependencies=[admit("listing")])
router.add_api_route(ADDRESS, read_list, methods=["POST"], dependencies=[admit("writing")])
router.add_api_route(f"{ADDRESS}/{{id}}", show_list, dependencies=[admit("reading")])
router.add_api_route(f"{ADDRESS}/{{id}}/save", save_list, methods=["POST"], dependencies=[admit("deleting")])
router.add_api_route(f"{ADDRESS}/{{id}}/delete", delete_list, methods=["POST"], dependencies=[admit("deleting")])
