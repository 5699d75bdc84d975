"""Lists of motors: a table is pasted, opened or typed into a sheet, corrected, stored, edited and deleted.

An edited list takes the same way as a new one: its sheet, or its text if it is long, is a table that is read again.
"""

from collections.abc import Mapping, Sequence
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
from hpn.tables.columns import ANY
from hpn.tables.motor_inputs import MOTORS
from hpn.tables.reading import Reading
from hpn.web import motor_cells, motor_lists
from hpn.web.door.access import admit
from hpn.web.door.bodies import pairs_of, read_form
from hpn.web.door.hosts import require_same_origin
from hpn.web.door.pools import compute
from hpn.web.door.problems import Problem
from hpn.web.door.uploads import decoded, read_all_parts
from hpn.web.door.visit import current
from hpn.web.form.linked import query_part
from hpn.web.motor_cells import CellRow
from hpn.web.motor_lists import SERVER, MotorList, draft_of
from hpn.web.motor_tables import BOUNDS, as_text, left_out, motors_in
from hpn.web.pages.reading import read
from hpn.web.pages.rendering import or_reason, page
from hpn.web.pages.saved_list import changed_since, version_of
from hpn.web.pages.table_upload import NOTHING, TableUpload, content_of, show_form
from hpn.words.reader import Reader
from hpn.words.wording import N_, Sentence, first_of

ADDRESS = "/motor-lists"
REASON = "motor_list_refused.html"
"""Page with the reason why a list can't be shown or changed."""

UNAVAILABLE = N_("Motor lists are temporarily unavailable: try again in a few seconds.")
NO_NAME = N_("Name the list.")
NO_MOTORS = N_("The table has no motor that can be taken.")
NO_ROWS = N_("Type a motor into the sheet.")
OVERTAKEN = N_("Somebody else has saved this list since you opened it. Different from yours: {names}.")
MOST_SHOWN = motor_cells.MOST_ROWS - 1
"""Maximum motors that a list's page shows as a sheet; a longer list is edited as text."""
MOST_NAMED = 8


@dataclass(frozen=True, slots=True, kw_only=True)
class MotorUpload(TableUpload):
    """Table of motors as read, and its motors.

    `list` is the id of the list to replace, blank for a new one, and `version` its version when it was opened; `link`
    is the application whose pairs are wanted. `cells` are the rows of a sheet, None for a table, and `wrong` are the
    numbers of those that can't be read; `at` is the row that the focus goes to. `theirs` is the version that somebody
    else has saved since.
    """

    name: str = ""
    link: str = ""
    list: str = ""
    version: str = ""
    theirs: str = ""
    cells: tuple[CellRow, ...] | None = field(default=None, repr=False)
    wrong: tuple[int, ...] = ()
    at: int = 0
    is_complete: bool = False
    notes: tuple[Sentence, ...] = ()
    motors: tuple[MotorEntry, ...] = field(default=(), repr=False)

    @property
    def shown_cells(self) -> tuple[CellRow, ...]:
        """Rows of the sheet with an empty one at the end, as long as there is room for it."""
        cells = self.cells or ()
        return (*cells, motor_cells.BLANK) if len(cells) < motor_cells.MOST_ROWS else cells


# --- Lists ------------------------------------------------------------------------------------------------------------


@or_reason(REASON)
async def show_lists(request: Request) -> Response:
    """Page of all lists by their names, with the form for another. `/api/v1/motor-lists` is the same as JSON."""
    context: dict[str, Any] = {
        "lines": await motor_lists.lines_of(request),
        "server": len(request.app.state.catalogue.motors),
        "draft": MotorUpload(),
        **of_sheet(),
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
        draft = MotorUpload(name=saved.name, list=saved.id, version=str(saved.version))
        if len(motors) > MOST_SHOWN:
            draft = replace(draft, text=as_text(motors), of=ANY)
        else:
            draft = replace(draft, cells=motor_cells.rows_of(motors, current().decimal))
    context: dict[str, Any] = {
        "title": name,
        "saved": saved,
        "motors": motors[:MOST_SHOWN],
        "count": len(motors),
        "may_change": may_change,
        "draft": draft,
        **of_sheet(),
    }
    return await compute(request, "pages", page, request, "motor_list.html", **context)


def of_sheet() -> dict[str, Any]:
    """Values of every page with a form for motors: the figures of a table, and the columns of a sheet."""
    reader = Reader(current().language)
    columns = [(role, column, motor_cells.unit_of(role, reader)) for role, column in motor_cells.COLUMNS.items()]
    return {"roles": MOTORS.by_role, "sheet_columns": columns}


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
        parts = await read_all_parts(request)
        texts = [(name, decoded(part)) for name, part in parts if name not in ("file", "table")]
        fields = dict(texts)
        draft = _typed(id, fields, motor_cells.rows_in(texts))
        if "do" not in fields:
            draft = await _read(request, draft, dict(parts), fields)
            saved = await motor_lists.changeable(request, id) if id else None
            if draft.is_complete and ("keep" in fields or "over" in fields):
                if saved and version_of({"version": draft.version}) not in (None, saved.version):
                    draft = replace(draft, theirs=str(saved.version))
                    raise Problem(412, _overtaken(draft, saved))
                return await _store(request, draft, saved)
    except (Problem, StoreUnavailableError) as error:
        refusal = error
        if isinstance(error, Problem) and error.status_code == 404:
            draft = replace(draft, list="", version="")  # deleted meanwhile: it can be stored as a new list
    return await show_form(request, "motor_list_read.html", draft, refusal, UNAVAILABLE, **of_sheet())


def _typed(id: str, fields: Mapping[str, str], cells: tuple[CellRow, ...] | None) -> MotorUpload:
    """Content of a form as typed; `do` is the button for a further row, or for one row less."""
    does, _, number = fields.get("do", "").partition(":")
    is_begun = cells is not None or does == "add"
    cells = motor_cells.without(cells or (), number) if does == "remove" else cells
    return MotorUpload(
        name=" ".join(fields.get("name", "").split()),
        link=query_part(fields.get("link", "")),
        text=fields.get("text", ""),
        list=id,
        version=fields.get("over") or fields.get("version", ""),
        of=ANY if fields.get("of") == ANY else "",
        cells=(cells or ()) if is_begun else None,
        at=len(cells or ()) + 1 if does == "add" else 0,
    )


async def _read(
    request: Request, draft: MotorUpload, parts: Mapping[str, bytes], fields: Mapping[str, str]
) -> MotorUpload:
    """Table of a form read beside the service."""
    if draft.cells is not None:
        return await _read_cells(request, draft, draft.cells, fields)
    content = await content_of(request, parts, draft.text)
    if not content.strip():
        return draft.refused(Sentence(NOTHING))
    reading = await read(request, content, BOUNDS, fields)
    is_seen = fields.get("of") == reading.of  # its preview, with all that is left out
    return await compute(request, "pages", _draft_of, draft, content, reading, is_seen)


def _draft_of(draft: MotorUpload, content: bytes | str, reading: Reading, is_seen: bool) -> MotorUpload:
    table = reading.table
    if table is None:
        return draft.refused(Sentence(NO_MOTORS))
    motors, notes = motors_in(table)
    problems: tuple[Sentence, ...] = (table.problem,) if table.problem else ()
    if table.whole and not motors:
        problems = (*notes, Sentence(NO_MOTORS))
    is_complete = table.whole and bool(motors) and (is_seen or not left_out(table, notes))
    whole = draft.as_read(content, reading)
    return replace(whole, problems=problems, notes=tuple(notes), motors=tuple(motors), is_complete=is_complete)


async def _read_cells(
    request: Request, draft: MotorUpload, cells: Sequence[CellRow], fields: Mapping[str, str]
) -> MotorUpload:
    """Cells of a sheet read as the table that they are."""
    faults = motor_cells.faults_of(cells) if cells else [Sentence(NO_ROWS)]
    if faults:
        return draft.refused(*faults)
    sheet = motor_cells.table_of(cells, Reader(current().language))
    reading = await read(request, sheet.text, sheet.bounds, {**fields, **motor_cells.answers()})
    return await compute(request, "pages", _cells_read, draft, cells, reading)


def _cells_read(draft: MotorUpload, cells: Sequence[CellRow], reading: Reading) -> MotorUpload:
    table = reading.table
    if table is None or table.problem:
        return draft.refused(table.problem if table and table.problem else Sentence(NO_MOTORS))
    draft = replace(draft, table=table)
    if not table.whole:
        return draft.refused(*table.questions)
    motors, notes = motors_in(table)
    wrong, lost = motor_cells.unread(cells, table, motors), left_out(table, notes)
    if wrong or lost or not motors:
        rows = Sentence(motor_cells.UNREAD, {"rows": first_of(wrong, motor_cells.MOST_NAMED)})
        problems = [*([rows] if wrong else []), *lost] or [Sentence(NO_MOTORS)]
        return replace(draft.refused(*problems), wrong=wrong, at=wrong[0] if wrong else 0)
    return replace(draft, motors=tuple(motors), is_complete=True)


def _overtaken(draft: MotorUpload, saved: SavedMotorList) -> Sentence:
    """Sentence on a list that somebody else has saved since, with the motors that differ from the typed ones."""
    own, theirs = (
        {motor.designation: motor.model_dump() for motor in motors}
        for motors in (draft.motors, motor_lists.entries_in(saved))
    )
    names = [name for name in {**own, **theirs} if own.get(name) != theirs.get(name)]
    return Sentence(OVERTAKEN, {"names": first_of(names, MOST_NAMED) or "–"})


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
