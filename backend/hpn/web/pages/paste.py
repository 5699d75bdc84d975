"""Pasting a table or opening a file: first what would be taken, in words and numbers, then taking it.

`GET /paste?<form>` is the page of that; `POST /paste` answers with it, or for htmx with the preview alone. The form
comes along as the field `link`, so that nothing typed is lost on the way.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite
from urllib.parse import urlencode

from fastapi import APIRouter
from pydantic import ValidationError
from starlette.requests import Request
from starlette.responses import HTMLResponse, RedirectResponse, Response

from hpn.application import Application
from hpn.web.door.access import admit
from hpn.web.door.bodies import pairs_of, parsed
from hpn.web.door.pools import compute, worked
from hpn.web.door.problems import Problem, plain_message, pointer
from hpn.web.door.uploads import read_fields
from hpn.web.form import read as links
from hpn.web.form.pasted import COLUMNS, SEPARATORS, Pasted, Reading, read_table
from hpn.web.form.read import Pairs
from hpn.web.form.symbols import PHASE_SYMBOLS
from hpn.web.form.write import to_link
from hpn.web.pages import long_cycles
from hpn.web.pages.templates import environment
from hpn.wording import N_, Sentence

FIRST_ROWS, LAST_ROWS = 6, 2
"""Rows of a long table that the preview shows."""

DECIMALS = {".": N_("a point"), ",": N_("a comma")}
COLUMN_UNITS = dict(zip(COLUMNS, ("Nm", "rpm", "s", "N", "N"), strict=True))
"""Units that a table is read in, whatever the page shows."""

NOTHING = Pasted(())
_PHASE_NAMES = {symbol.name for symbol in PHASE_SYMBOLS}


@dataclass(frozen=True, slots=True)
class TableRow:
    """A row of a preview: its number, its cells, and for each whether another reading says otherwise."""

    number: int
    cells: tuple[tuple[str, bool], ...]


@dataclass(frozen=True, slots=True)
class TablePreview:
    """One reading of a table as the page shows it."""

    index: int
    separator: str
    decimal: str
    columns: tuple[str, ...]
    count: int
    first: tuple[TableRow, ...]
    last: tuple[TableRow, ...]
    total_s: float | None


@dataclass(frozen=True, slots=True)
class PasteDraft:
    """State of the page: the form that it came from, the text, and what can be made of it."""

    link: str
    text: str = ""
    previews: tuple[TablePreview, ...] = ()
    application: Application | None = None
    problems: tuple[Sentence, ...] = ()
    has_phases: bool = False


def start(request: Request) -> Response:
    """The page with an empty field."""
    return _render(request, _draft(request.url.query), 200)


async def paste(request: Request) -> Response:
    """Previews what was pasted or uploaded, or takes it."""
    try:
        fields = await read_fields(request)
    except Problem as problem:
        problems = problem.sentences or (_plain(problem.detail),)
        return _render(request, PasteDraft("", problems=problems), problem.status_code)
    return await compute(request, "pages", _answer, request, fields)


def _answer(request: Request, fields: dict[str, str]) -> Response:
    text = (fields.get("file", "") or fields.get("text", "")).removeprefix("\ufeff")
    take, link = fields.get("take", ""), fields.get("link", "").removeprefix("/").removeprefix("?")
    if text.lstrip().startswith("{"):
        draft = _opened(link, text)
        if draft.application and (take or "hx-request" not in request.headers):
            query = to_link(draft.application).removeprefix("/?")
            return _proceed(request, pairs_of(query))
        return _render(request, draft, 422 if draft.problems else 200)
    pasted = read_table(text) if text.strip() else NOTHING
    mode, _, index = take.partition(":")
    if index.isascii() and index.isdigit() and int(index[:3]) < len(pasted.readings):
        return _proceed(request, taken(link, pasted.readings[int(index[:3])], append=mode == "append"))
    draft = _draft(link, text, pasted)
    return _render(request, draft, 422 if draft.problems else 200)


def _opened(link: str, text: str) -> PasteDraft:
    """Draft of a text that begins like an object of JSON."""
    try:
        return PasteDraft(link, text, application=parsed(Application, text))
    except Problem as problem:
        return PasteDraft(link, text, problems=(_plain(problem.detail),))
    except ValidationError as error:
        found = error.errors(include_url=False, include_context=False, include_input=False)
        problems = [
            Sentence(
                N_("{field}: {message}"),
                {"field": pointer(entry["loc"]) or "JSON", "message": plain_message(entry["type"], entry["msg"])},
            )
            for entry in found[:20]
        ]
        return PasteDraft(link, text, problems=tuple(problems))


def _draft(link: str, text: str = "", pasted: Pasted = NOTHING) -> PasteDraft:
    """Draft of a table, or of nothing yet."""
    return PasteDraft(
        link,
        text,
        previews=tuple(_preview(pasted, index) for index in range(len(pasted.readings))),
        problems=(pasted.problem,) if pasted.problem else (),
        has_phases=any(name in {*_PHASE_NAMES, "phases"} and value for name, value in pairs_of(link)),
    )


def _preview(pasted: Pasted, index: int) -> TablePreview:
    reading = pasted.readings[index]
    others = [other for other in pasted.readings if other.columns == reading.columns and other is not reading]
    count = len(reading.rows)
    shown = count <= FIRST_ROWS + LAST_ROWS + 1
    total_s = sum(float(row[reading.columns.index("t")] or 0) for row in reading.rows)

    def rows(numbers: Sequence[int]) -> tuple[TableRow, ...]:
        return tuple(TableRow(k + 1, _marked(reading.rows[k], [other.rows[k] for other in others])) for k in numbers)

    return TablePreview(
        index=index,
        separator=SEPARATORS[reading.separator],
        decimal=DECIMALS[reading.decimal],
        columns=reading.columns,
        count=count,
        first=rows(range(count if shown else FIRST_ROWS)),
        last=() if shown else rows(range(count - LAST_ROWS, count)),
        total_s=total_s if isfinite(total_s) else None,
    )


def _marked(row: Sequence[str], others: Sequence[Sequence[str]]) -> tuple[tuple[str, bool], ...]:
    return tuple((cell, any(other[k] != cell for other in others)) for k, cell in enumerate(row))


def taken(link: str, reading: Reading, *, append: bool) -> list[tuple[str, str]]:
    """Pairs of the form with the phases of a reading, instead of its own or after them."""
    pairs, _ = links.in_wire_units(long_cycles.expanded(pairs_of(link)))
    rest = [(name, value) for name, value in pairs if value.strip() and name not in {*_PHASE_NAMES, "do", "phases"}]
    rows = [dict(zip(reading.columns, row, strict=True)) for row in reading.rows]
    if append:
        given = links.parse(pairs).rows
        rows = [dict(row) for row in given if any(text.strip() for text in row.values())] + rows
    names = COLUMNS if any(row.get("FRi") or row.get("FAi") for row in rows) else COLUMNS[:3]
    return [(name, row.get(name, "")) for row in rows for name in names] + rest


def _proceed(request: Request, pairs: Pairs) -> Response:
    """On to the page: by its address, and where that would be too long, right here."""
    query = urlencode(pairs)
    if len(query) > links.MAXIMUM_QUERY_BYTES:
        return long_cycles.respond(request, pairs)
    return RedirectResponse(f"/?{query}", 303)


def _plain(text: str) -> Sentence:
    return Sentence("{text}", {"text": text})


def _render(request: Request, draft: PasteDraft, status: int) -> Response:
    name = "_paste_preview.html" if "hx-request" in request.headers else "paste.html"
    template = environment(request.app.state).get_template(name)
    content = template.render(draft=draft, column_units=COLUMN_UNITS)
    return HTMLResponse(content, status, {"Vary": "HX-Request", "Cache-Control": "no-store"})


router = APIRouter(include_in_schema=False, dependencies=[admit("calculator")])
router.add_api_route("/paste", worked(start))
router.add_api_route("/paste", paste, methods=["POST"])
