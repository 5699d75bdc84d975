"""Duty cycles too long for an address: the form is posted, and its phases are one text."""

import re
from dataclasses import replace

from fastapi import APIRouter
from starlette.requests import Request
from starlette.responses import Response

from hpn.web.door.access import admit
from hpn.web.door.bodies import pairs_of, read_form
from hpn.web.door.pools import compute
from hpn.web.form import link_reader
from hpn.web.form.link_reader import Pairs
from hpn.web.form.symbols import PHASE_SYMBOLS
from hpn.web.pages import calculator as pages
from hpn.words.fields import MAXIMUM_PHASES

TEXT = "phases"
"""Field of the form that holds the phases as text, a phase on each line."""


async def calculate(request: Request) -> Response:
    """The page of a posted form, or only the part that changes; nothing is kept."""
    body = await read_form(request)
    return await compute(request, "pages", _answer, request, body)


def _answer(request: Request, body: bytes) -> Response:
    return respond(request, pairs_of(body))


def respond(request: Request, pairs: Pairs) -> Response:
    """The page of posted pairs."""
    typed = dict(pairs).get(TEXT)
    form = link_reader.parse(expanded(pairs))
    if typed is not None:
        form = replace(form, typed=typed.replace("\r\n", "\n"))
    return pages.respond(request, form)


def expanded(pairs: Pairs) -> list[tuple[str, str]]:
    """Pairs of a link: the text of the phases becomes repeated T, n, t, and where used, the others."""
    plain = [pair for pair in pairs if pair[0] != TEXT]
    for name, text in pairs:
        if name == TEXT:
            rows = [_cells(line) for line in text.rstrip().splitlines()]
            plain += phase_pairs(rows[: MAXIMUM_PHASES + 1])
    return plain


def _cells(line: str) -> list[str]:
    """Cells of a line, apart by tabs, semicolons or blanks; the last takes what is too much, and is refused."""
    cells = re.split(r" *[;\t] *| +", line.strip(" "))
    return cells[:7] + ([" ".join(cells[7:])] if len(cells) > 7 else [])


def phase_pairs(rows: list[list[str]]) -> list[tuple[str, str]]:
    """Pairs of rows in the order T, n, t, FRi, FAi, Tpk, npk, Trms; what a short row lacks is blank."""
    width = max([3, *map(len, rows)])
    names = [symbol.name for symbol in PHASE_SYMBOLS[: 3 if width <= 3 else 5 if width <= 5 else 8]]
    return [(name, row[k].strip() if k < len(row) else "") for row in rows for k, name in enumerate(names)]


router = APIRouter(include_in_schema=False, dependencies=[admit("calculator")])
router.add_api_route("/", calculate, methods=["POST"])
