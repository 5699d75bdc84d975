"""The page of a saved selection, and a copy of it on the live page."""

import re
from collections.abc import Sequence
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
from hpn.engine.selection import Selection
from hpn.explain.changes import ReplyChange
from hpn.explain.comparison import Row, rows_of
from hpn.explain.differences import FigureDifference
from hpn.files.export import DIGITS
from hpn.files.report.content import qr_code
from hpn.store import ID, Machine, SavedSelection
from hpn.web.archive import Reopened, found, url_of
from hpn.web.door.access import MAXIMUM_QUERY_BYTES, admit
from hpn.web.door.visit import absolute, current
from hpn.web.form.given import visible
from hpn.web.pages import calculator
from hpn.web.pages.machine import may_change
from hpn.web.pages.rendering import or_reason, page
from hpn.web.pages.result import Result
from hpn.web.pages.revisions_view import next_label
from hpn.web.pages.saving import REASON
from hpn.words.wording import N_, Sentence

DIFFERENCES_ON_PAGE, MOST_ROWS = 100, 100
"""Differences, and rows of a table of inputs, that the page shows."""

EXPORTS = (
    ("/report.pdf", N_("PDF"), "", "report"),
    ("/report.xlsx", N_("Workbook"), "XLSX", "serve"),
    ("/submodel.aasx", N_("Asset administration shell"), "AASX", "aas"),
    ("", N_("Application and result"), "JSON", "serve"),
)
"""Files of a saved selection: end of its address, title, format, and the extra that makes it."""

MOST_REVISIONS = 20
"""Revisions that the page itself names; their own page has more."""


@or_reason(REASON)
async def show_selection(request: Request) -> Response:
    """The selection as it was saved, and beside it what today's engine and catalogue say differently."""
    id = request.path_params["id"]
    if (seen := visible(id)) != id and ID.fullmatch(seen):
        return RedirectResponse(f"/selections/{seen}?{request.url.query}".removesuffix("?"), 308)
    machine: Machine | None = await request.app.state.store.find_machine(id, "selection")
    label = request.query_params.get("revision")
    return await found(request, id, partial(_shown, request, machine), label)


class WorkingCopy(NamedTuple):
    """Working copy of a selection: its page, and whether it has changed since the latest revision."""

    place: str
    is_newer: bool

    @classmethod
    def of(cls, machine: Machine, saved: SavedSelection) -> "WorkingCopy":
        """That of a document with one axis."""
        (axis,) = machine.items
        return cls(f"/machines/{machine.id}/axes/{axis.number}", axis.updated > saved.revisions[0].created)


def _shown(request: Request, machine: Machine | None, reopened: Reopened) -> Response:
    values = _page(reopened, request.query_params.get("gear", ""), request.app.state.catalogue)
    values |= {
        "working": WorkingCopy.of(machine, reopened.saved) if machine else None,
        "may_change": machine is not None and may_change(request, machine),
        "next": next_label(reopened.saved.revisions),
    }
    address = absolute(request, url_of(reopened.saved.id))
    return page(request, "selection.html", address=address, qr_code=qr_code(address), **values)


async def copy_selection(request: Request) -> Response:
    """The live page with a copy of what was saved, for a duty cycle that is too long for a link."""
    label = request.query_params.get("revision")
    return await found(request, request.path_params["id"], partial(_copied, request), label)


def _copied(request: Request, reopened: Reopened) -> Response:
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
        "published": _published(reopened.then, catalogue, answer.chosen.designation),
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
    """Saved result as the templates read it, with the gear that is asked for or that its page shows first."""
    earlier = "" if saved.label == saved.revisions[0].label else f"revision={saved.label}&"
    chosen = selection.candidate(designation or saved.designation or "") or selection.foremost
    return Result(
        selection=selection,
        application=application,
        chosen=chosen,
        asked=chosen is not selection.foremost,
        catalogue=then,
        choosing=f"{url_of(saved.id)}?{earlier}gear=",
    )


def _published(then: Catalogue | None, today: Catalogue, designation: str) -> list[Row]:
    """Published figures of a gear then and today; none where the catalogue of then is lost."""
    gears = [one.by_designation.get(designation) if one else None for one in (then, today)]
    return rows_of(*(published.ranged(published.published(gear)) for gear in gears)) if gears[0] else []


def _changed_figures(reopened: Reopened, today: Catalogue, gear: str) -> list[tuple[str, Row]]:
    """Published figures of a gear and of the listed motor that differ, with the designation of either."""
    if reopened.then is None:
        return []
    catalogues, motor = (reopened.then, today), reopened.application and reopened.application.requirements.motor
    sides = [(gear, [published.whole(catalogue, gear) for catalogue in catalogues])]
    if motor and (name := motor.designation):
        sides.append((name, [published.of_motor(catalogue, name) for catalogue in catalogues]))
    return [(owner, row) for owner, lines in sides if all(lines) for row in rows_of(*lines) if row.differs]


def _gears(figures: Sequence[FigureDifference] | None, *, gone: bool) -> list[str]:
    """Candidates of which today's catalogue publishes other figures, or those that it lacks."""
    gears = {
        difference.candidate
        for difference in figures or ()
        if difference.candidate and (difference.field == "designation") == gone
    }
    return sorted(gears, key=_number)


def _ordering(saved: SavedSelection, catalogue: Catalogue) -> str:
    """The saved ordering code where today's catalogue has no such gear or output version, else empty."""
    code = saved.ordering_code or ""
    return code if code and isinstance(read_ordering_code(catalogue, code), Sentence) else ""


def _number(designation: str) -> list[int]:
    """Sort key of gears: size, then ratio."""
    return [int(digits) for digits in re.findall(r"\d+", designation)]


router = APIRouter(include_in_schema=False)
router.add_api_route("/selections/{id}", show_selection, dependencies=[admit("reading")])
router.add_api_route("/selections/{id}/copy", copy_selection, dependencies=[admit("reading")])
