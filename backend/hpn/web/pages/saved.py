"""Page of a saved selection, and a copy of it on the live page."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

from fastapi import APIRouter
from starlette.requests import Request
from starlette.responses import RedirectResponse, Response

from hpn import ENGINE_VERSION
from hpn.account import published
from hpn.account.account import Account
from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.catalogue.ordering import read_ordering_code
from hpn.documents.revision import decode
from hpn.engine.selection import Selection
from hpn.explain.changes import ReplyChange
from hpn.explain.comparison import Row, rows_of
from hpn.explain.differences import FigureDifference
from hpn.files.export import DIGITS
from hpn.files.report.content import qr_code
from hpn.links.labels import query_of
from hpn.store import ID, Machine, SavedSelection
from hpn.web.archive import Reopened, on_saved, url_of
from hpn.web.door.access import MAXIMUM_QUERY_BYTES, admit
from hpn.web.door.visit import absolute, current
from hpn.web.form.query import visible
from hpn.web.pages import calculator
from hpn.web.pages.rendering import or_reason, page
from hpn.web.pages.result import Result
from hpn.web.pages.revisions_view import MOST_REVISIONS, gears_shown, next_label
from hpn.web.pages.saving import REASON
from hpn.words.wording import N_, Sentence

DIFFERENCES_ON_PAGE, MOST_ROWS = 100, 100
"""Maximum differences, and rows of a table of inputs, on the page."""

EXPORTS = (
    ("/report.pdf", N_("PDF"), "", "report"),
    ("/report.xlsx", N_("Workbook"), "XLSX", "serve"),
    ("/submodel.aasx", N_("Asset administration shell"), "AASX", "aas"),
    ("", N_("Application and result"), "JSON", "serve"),
)
"""Files of a saved selection: end of its address, title, format, and the extra that makes it."""


@or_reason(REASON)
async def show_selection(request: Request) -> Response:
    """Page of a selection as saved, with the differences of today's engine and catalogue."""
    id = request.path_params["id"]
    if (seen := visible(id)) != id and ID.fullmatch(seen):
        return RedirectResponse(f"/selections/{seen}?{request.url.query}".removesuffix("?"), 308)
    machine: Machine | None = await request.app.state.store.find_machine(id, "selection")
    label = request.query_params.get("revision")
    frozen = await request.app.state.store.revision_contents(id, MOST_REVISIONS) if machine else {}
    return await on_saved(request, id, partial(_selection_page, request, machine, frozen), label)


class WorkingCopy(NamedTuple):
    """Working copy of a selection: its page, and True if it has changed since the latest revision."""

    place: str
    is_newer: bool

    @classmethod
    def of(cls, machine: Machine, saved: SavedSelection) -> "WorkingCopy":
        """Working copy of a document with one axis."""
        (axis,) = machine.items
        return cls(f"/machines/{machine.id}/axes/{axis.number}", axis.updated > saved.revisions[0].created)


def _selection_page(
    request: Request, machine: Machine | None, frozen: Mapping[int, bytes], reopened: Reopened
) -> Response:
    values = _page(reopened, request.query_params.get("gear", ""), request.app.state.catalogue)
    values |= {
        "working": WorkingCopy.of(machine, reopened.saved) if machine else None,
        "may_change": machine is not None and request.app.state.gate.may_change(request, machine.owner),
        "next": next_label(reopened.saved.revisions),
        "gears": gears_shown({number: decode(content) for number, content in frozen.items()}, current()),
    }
    address = absolute(request, url_of(reopened.saved.id))
    return page(request, "selection.html", address=address, qr_code=qr_code(address), **values)


async def copy_selection(request: Request) -> Response:
    """Live page with a copy of a saved selection whose duty cycle is too long for a link."""
    label = request.query_params.get("revision")
    return await on_saved(request, request.path_params["id"], partial(_edit_copy, request), label)


def _edit_copy(request: Request, reopened: Reopened) -> Response:
    return calculator.respond(request, calculator.read_query(reopened.link.removeprefix("/?").encode()))


# --- What the page shows ----------------------------------------------------------------------------------------------


def _page(reopened: Reopened, designation: str, catalogue: Catalogue) -> dict[str, Any]:
    application, reader = reopened.application, current()
    answer = result_of(reopened.saved, reopened.selection, application, reopened.then, designation)
    today = Account(reopened.today, reopened.today.foremost, application, catalogue) if reopened.today else None
    accounts = answer.account, today
    changes = [ReplyChange(one, accounts, reader) for one in reopened.differences[:DIFFERENCES_ON_PAGE]]
    return {
        "reopened": reopened,
        "answer": answer,
        "lines": [change for change in changes if not change.is_wording],
        "worded": [change for change in changes if change.is_wording],
        "catalogue_version": catalogue.version,
        "published": _figure_rows(reopened.then, catalogue, answer.chosen.designation),
        "changed_figures": _changed_figures(reopened, catalogue, answer.chosen.designation),
        "changed_gears": _gears(reopened.figures, gone=False),
        "gone_gears": _gears(reopened.figures, gone=True),
        "ordering": _ordering(reopened.saved, catalogue),
        "engine_version": ENGINE_VERSION,
        "document": reopened.saved.application.decode(),
        "filed": replace(reader, digits=DIGITS),
        "most_rows": MOST_ROWS,
        "exports": EXPORTS,
        "most_revisions": MOST_REVISIONS,
        "longest_link": MAXIMUM_QUERY_BYTES,
    }


def result_of(
    saved: SavedSelection,
    selection: Selection,
    application: Application | None,
    then: Catalogue | None,
    designation: str = "",
) -> Result:
    """Saved result for the templates, with the requested gear, else the one that its page shows first."""
    earlier = "" if saved.label == saved.revisions[0].label else f"revision={saved.label}&"
    chosen = selection.candidate(designation or saved.designation or "") or selection.foremost
    return Result(
        selection=selection,
        application=application,
        chosen=chosen,
        is_chosen_gear=chosen is not selection.foremost,
        catalogue=then,
        choosing=f"{url_of(saved.id)}?{earlier}gear=",
        tail=query_of({"title": saved.title or "", "ref": saved.reference or ""}),
    )


def _figure_rows(then: Catalogue | None, today: Catalogue, designation: str) -> list[Row]:
    """Published figures of a gear then and today; empty if the former catalogue lacks the gear or is not kept."""
    gears = [one.by_designation.get(designation) if one else None for one in (then, today)]
    return rows_of(*(published.ranged(published.published(gear)) for gear in gears)) if gears[0] else []


def _changed_figures(reopened: Reopened, today: Catalogue, gear: str) -> list[tuple[str, Row]]:
    """Differing published figures of a gear and of the listed motor, each with its designation."""
    if reopened.then is None:
        return []
    catalogues, motor = (reopened.then, today), reopened.application and reopened.application.requirements.motor
    sides = [(gear, [published.whole(catalogue, gear) for catalogue in catalogues])]
    if motor and (name := motor.designation):
        sides.append((name, [published.of_motor(catalogue, name) for catalogue in catalogues]))
    return [(owner, row) for owner, lines in sides if all(lines) for row in rows_of(*lines) if row.differs]


def _gears(figures: Sequence[FigureDifference] | None, *, gone: bool) -> list[str]:
    """Candidates with other figures in today's catalogue, or with `gone` those that it lacks."""
    gears = {
        difference.candidate
        for difference in figures or ()
        if difference.candidate and (difference.field == "designation") == gone
    }
    return sorted(gears, key=lambda gear: [int(digits) for digits in re.findall(r"\d+", gear)])  # size, then ratio


def _ordering(saved: SavedSelection, catalogue: Catalogue) -> str:
    """Saved ordering code if today's catalogue lacks its gear or output version, else empty."""
    code = saved.ordering_code or ""
    return code if code and isinstance(read_ordering_code(catalogue, code), Sentence) else ""


router = APIRouter(include_in_schema=False)
router.add_api_route("/selections/{id}", show_selection, dependencies=[admit("reading")])
router.add_api_route("/selections/{id}/copy", copy_selection, dependencies=[admit("reading")])
