"""Pasting of a table or opening of a file: first a preview, in which each column can be corrected, then taking it.

`GET /paste?<form>` is the page; `POST /paste` answers with it, or for htmx with the preview alone. The form is carried
in the field `link`, so that no typed input is lost.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from urllib.parse import urlencode

from fastapi import APIRouter
from pydantic import ValidationError
from starlette.requests import Request
from starlette.responses import HTMLResponse, RedirectResponse, Response

from hpn.application import Application
from hpn.application.faults import pointer, sentence_of
from hpn.explain.drawings.cycle import CyclePicture, cycle_picture
from hpn.files.aas.opened import OpenedSizing, is_shell, sizing_in
from hpn.links.row_symbols import PHASE_BY_NAME
from hpn.links.rows import TEXT, TOLERANCE, filled, used_columns
from hpn.links.symbols import BY_NAME
from hpn.links.writer import to_link
from hpn.tables.files import TableBounds, packed, tidied, unpacked
from hpn.tables.inputs import CYCLE, NAME, PHASE_ROLES
from hpn.tables.outcomes import MOST_ROWS_TRIED
from hpn.tables.reading import Reading
from hpn.tables.sheets import MAXIMUM_CHARACTERS, SEPARATORS
from hpn.tables.table import Table
from hpn.web.door.access import MAXIMUM_QUERY_BYTES, admit
from hpn.web.door.bodies import pairs_of, parsed
from hpn.web.door.pools import compute, compute_beside, worked
from hpn.web.door.problems import Problem
from hpn.web.door.uploads import decoded, read_parts
from hpn.web.door.visit import current
from hpn.web.form import link_reader
from hpn.web.form.linked import query_part
from hpn.web.form.query import CYCLE_NAMES, Pairs, SortedQuery
from hpn.web.form.tolerance_fields import OF_ROW
from hpn.web.pages import calculator
from hpn.web.pages.axis_view import OF_AXIS, PLACE, place_of
from hpn.web.pages.reading import read
from hpn.web.pages.templates import environment
from hpn.words.fields import MAXIMUM_PHASES
from hpn.words.wording import N_, Sentence

NOTHING = N_("the workbook is empty")
_AXIS = re.compile(r"([A-Za-z0-9_-]{1,60})/([0-9]{1,10})")
BOUNDS = TableBounds(CYCLE, MAXIMUM_PHASES, MAXIMUM_CHARACTERS)


@dataclass(frozen=True, slots=True)
class PasteDraft:
    """State of the page: the form that it was opened from, the given text, and its reading.

    `of` identifies the text or file that the choices belong to: another one discards them. `book` carries a file that
    is not text if no script can send it again. `unused` are elements of a sizing that are not taken, and `note` names
    those of them that act on the load.
    """

    link: str
    text: str = ""
    table: Table | None = None
    application: Application | None = None
    problems: tuple[Sentence, ...] = ()
    has_phases: bool = False
    example: bool = False
    of: str = ""
    sheets: tuple[str, ...] = ()
    sheet: str = ""
    book: str = ""
    unused: tuple[str, ...] = ()
    note: Sentence | None = None


def start(request: Request) -> Response:
    """Page with an empty field."""
    return _render(request, _draft(request.url.query, "", Reading()), 200)


async def paste(request: Request) -> Response:
    """Show a preview of a pasted or uploaded table, or take it."""
    post = PastePost()
    try:
        post = await compute(request, "pages", _post_of, await read_parts(request))
        reading, content = Reading(), post.file or post.text.encode(errors="replace")
        if is_shell(content):
            sizing = await compute_beside(request, "files", partial(sizing_in, content))
            return await compute(request, "pages", _of_sizing, request, post, sizing)
        if post.file or post.text.strip():
            reading = await read(request, post.file or post.text, BOUNDS, post.fields)
        return await compute(request, "pages", _answer, request, post, reading)
    except Problem as problem:
        problems = problem.sentences or (_plain(problem.detail),)
        draft = PasteDraft(post.link, post.text, problems=problems)
        response = await compute(request, "pages", _render, request, draft, problem.status_code)
        response.headers.update(problem.headers or {})
        return response


@dataclass(frozen=True, slots=True)
class PastePost:
    """Posted content: the form that the page was opened from, a text or a file, and the choices."""

    link: str = ""
    text: str = ""
    file: bytes = b""
    fields: Mapping[str, str] = field(default_factory=dict)


def _post_of(parts: Mapping[str, bytes]) -> PastePost:
    fields = {name: decoded(content) for name, content in parts.items() if name != "file"}
    link, text = query_part(fields.get("link", "")), tidied(fields.get("text", ""))
    file = parts.get("file", b"")
    if not file and not text.strip() and (book := fields.get("book")):
        file = unpacked(book.encode(errors="replace"))
        if not file:
            raise Problem(422, Sentence(NOTHING))
    return PastePost(link, text, file, fields)


def _answer(request: Request, post: PastePost, reading: Reading) -> Response:
    text = reading.text if post.file else post.text
    if reading.is_application:
        return _of_application(request, post.link, text, post.fields.get("take", ""))
    draft = _draft(post.link, text, reading)
    if post.file and not text and reading.sheets and "hx-request" not in request.headers:
        draft = replace(draft, book=packed(post.file))
    return _taken_or_shown(request, post.fields, draft)


def _taken_or_shown(request: Request, fields: Mapping[str, str], draft: PasteDraft) -> Response:
    mode = fields.get("take", "").partition(":")[0]
    if mode in ("replace", "append") and draft.table and draft.table.whole:
        return _proceed(request, pairs_with(draft, append=mode == "append"))
    return _render(request, draft, 422 if draft.problems else 200)


# --- Applications in JSON ---------------------------------------------------------------------------------------------


def _of_application(request: Request, link: str, text: str, take: str) -> Response:
    draft = _of_json(link, text)
    if draft.application and (take or "hx-request" not in request.headers):
        query = to_link(draft.application).removeprefix("/?")
        of_axis = (pair for pair in pairs_of(link) if pair[0] in OF_AXIS)
        return _proceed(request, [*pairs_of(query), *of_axis])
    return _render(request, draft, 422 if draft.problems else 200)


def _of_sizing(request: Request, post: PastePost, sizing: OpenedSizing) -> Response:
    """Preview of another tool's sizing, which shows the unused elements, or page after taking it."""
    if sizing.problem:
        return _render(request, PasteDraft(post.link, problems=(sizing.problem,)), 422)
    if post.fields.get("take"):
        return _of_application(request, post.link, sizing.text, "all")
    draft = replace(_of_json(post.link, sizing.text), unused=sizing.unused, note=sizing.note)
    return _render(request, draft, 200)


def _of_json(link: str, text: str) -> PasteDraft:
    """Draft of a text that begins like a JSON object."""
    try:
        return PasteDraft(link, text, application=parsed(Application, text))
    except Problem as problem:
        return PasteDraft(link, text, problems=(_plain(problem.detail),))
    except ValidationError as error:
        errors = error.errors(include_url=False, include_input=False)
        problems = [
            Sentence(
                N_("{field}: {message}"), {"field": pointer(entry["loc"]) or "JSON", "message": sentence_of(entry)}
            )
            for entry in errors[:20]
        ]
        return PasteDraft(link, text, problems=tuple(problems))


# --- Drafts -----------------------------------------------------------------------------------------------------------


def _draft(link: str, text: str, reading: Reading) -> PasteDraft:
    """Draft of a table, or an empty draft."""
    table = reading.table
    return PasteDraft(
        link,
        text,
        table=table if table and not table.problem else None,
        problems=(table.problem,) if table and table.problem else (),
        has_phases=any(name in {*CYCLE_NAMES, TEXT} and value for name, value in pairs_of(link)),
        example=table is not None and is_example(link),
        of=reading.of,
        sheets=reading.sheets,
        sheet=reading.sheet,
    )


def is_example(link: str) -> bool:
    """True for a form with exactly the inputs of the handbook's worked example."""
    application = link_reader.parse(pairs_of(link)).application if link else None
    return application is not None and to_link(application) == to_link(Application.worked_example())


def pairs_with(draft: PasteDraft, *, append: bool) -> list[tuple[str, str]]:
    """Pairs of the form with the phases of a table, in place of its own or after them.

    If they replace the worked example, its pause, emergency stop and ratio are dropped, too.
    """
    assert draft.table is not None
    query = SortedQuery(pairs_of(draft.link))
    dropped = set(CYCLE_NAMES)
    if draft.example and not append:
        dropped |= {name for name, _ in pairs_of(to_link(Application.worked_example()).removeprefix("/?"))}
    if stop := draft.table.stop_Nm:
        dropped |= {name for name, symbol in BY_NAME.items() if symbol.path[0] == "emergency_stop" and name != "Nk"}
    rest = [(name, value) for name, value in query.beside() if name not in dropped]
    if not append:  # tolerances of single phases go with the phases
        rest = [(name, value) for name, value in rest if name != TOLERANCE]
    rest += [("Tk", stop)] if stop else []
    names = draft.table.names or ("",) * len(draft.table.phases)
    named = zip(names, draft.table.phases, strict=True)
    rows = [{NAME.role: name, **dict(zip(PHASE_ROLES, phase, strict=True))} for name, phase in named]
    if append:
        rows = [*filter(filled, query.phases.rows), *rows]
    used = {name for row in rows for name, text in row.items() if text}
    columns = [*used_columns(PHASE_BY_NAME, used), *(name for name in OF_ROW if name in used)]
    return [(name, row.get(name, "")) for row in rows for name in columns] + rest


def _proceed(request: Request, pairs: Pairs) -> Response:
    """Redirect to the live page or the axis's page; a form too long for an address gets the live page at once."""
    query = urlencode(pairs)
    if axis := _AXIS.fullmatch(dict(pairs).get(PLACE, "")):
        if len(query) > MAXIMUM_QUERY_BYTES:
            raise Problem(413, Sentence(N_("too long for the page of an axis: give it over REST")))
        return RedirectResponse(f"{place_of(axis[1], int(axis[2]))}?{query}", 303)
    if len(query) > MAXIMUM_QUERY_BYTES:
        return calculator.respond(request, link_reader.parse(pairs))
    return RedirectResponse(f"/?{query}", 303)


def _plain(text: str) -> Sentence:
    return Sentence("{text}", {"text": text})


def _render(request: Request, draft: PasteDraft, status: int) -> Response:
    name = "_paste_preview.html" if "hx-request" in request.headers else "paste.html"
    template = environment(request.app.state).get_template(name)
    content = template.render(draft=draft, paste=_WORDS, picture=_picture(draft))
    return HTMLResponse(content, status, {"Vary": "HX-Request", "Cache-Control": "no-store"})


def _picture(draft: PasteDraft) -> CyclePicture | None:
    """Torque and speed over time of a short table; None for a long or incomplete one."""
    if not draft.table or not draft.table.whole or len(draft.table.phases) > MOST_ROWS_TRIED:
        return None
    application = link_reader.parse(pairs_with(replace(draft, link="", example=False), append=False)).application
    return cycle_picture(application, None, current()) if application else None


_WORDS = {
    "roles": CYCLE.by_role,
    "text_roles": {NAME.role: NAME},
    "separators": SEPARATORS,
}

router = APIRouter(include_in_schema=False, dependencies=[admit("calculator")])
router.add_api_route("/paste", worked(start))
router.add_api_route("/paste", paste, methods=["POST"])
