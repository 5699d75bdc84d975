"""The page of a saved selection, and a copy of it on the live page."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from fastapi import APIRouter
from starlette.requests import Request
from starlette.responses import RedirectResponse, Response

from hpn import ENGINE_VERSION
from hpn.account.published import published, ranged
from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.catalogue.ordering import read_ordering_code
from hpn.engine.candidates import reason_of
from hpn.engine.selection import Selection
from hpn.explain.comparison import Row, is_number, rows_of
from hpn.explain.differences import Difference, FigureDifference
from hpn.files.export import DIGITS
from hpn.files.report.content import qr_code
from hpn.store import ID, SavedSelection
from hpn.web.archive import Reopened, found, url_of
from hpn.web.door.access import MAXIMUM_QUERY_BYTES, admit
from hpn.web.door.visit import absolute, current
from hpn.web.form.given import visible
from hpn.web.pages import calculator
from hpn.web.pages.rendering import or_reason, page
from hpn.web.pages.result import Result
from hpn.web.pages.saving import REASON
from hpn.words.quantities import CANDIDATE, CHECK, DUTY, GEAR, MOTOR, PHASE, RESERVE
from hpn.words.terms import VERDICTS
from hpn.words.units import symbol_of
from hpn.words.wording import N_, Sentence

DIFFERENCES_ON_PAGE, MOST_ROWS = 100, 100
"""Differences, and rows of a table of inputs, that the page shows."""

NAMES: Mapping[str, str] = {
    "selected": N_("Selected gear"),
    "text": N_("Notice"),
    **{field: named.name for table in (PHASE, DUTY, RESERVE, CHECK, CANDIDATE) for field, named in table.items()},
    "load_inertia_kgm2": N_("Inertia of the load"),
}
"""Fields of a reply in words; any other stands with its own name."""

SHARES = ("utilisation", "torque_factor", "speed_factor", "load_factor")
"""Fields that are read as percentages."""

FIGURES: Mapping[str, str] = {
    "clamp_bolts": N_("Bolt of the clamp on the motor shaft"),
    "housing_bolts": N_("Bolts of the housing flange"),
    "bearing_curve": N_("Points of the output bearing’s curve"),
    "efficiency_curve": N_("Points of the efficiency curve"),
}
"""Published figures of a gear that are more than a number."""

EXPORTS = (
    ("report.pdf", N_("PDF report"), "report"),
    ("report.xlsx", N_("Workbook"), "serve"),
    ("submodel.aasx", N_("Asset Administration Shell"), "aas"),
)
"""Files of a saved selection: name, title, and the extra that makes it."""


@or_reason(REASON)
async def show_selection(request: Request) -> Response:
    """The selection as it was saved, and beside it what today's engine and catalogue say differently."""
    id = request.path_params["id"]
    if (seen := visible(id)) != id and ID.fullmatch(seen):
        return RedirectResponse(f"/selections/{seen}?{request.url.query}".removesuffix("?"), 308)
    return await found(request, id, partial(_shown, request), request.query_params.get("revision"))


def _shown(request: Request, reopened: Reopened) -> Response:
    shown = _page(reopened, request.query_params.get("gear", ""), request.app.state.catalogue)
    address = absolute(request, url_of(reopened.saved.id))
    return page(request, "selection.html", address=address, qr_code=qr_code(address), **shown)


async def copy_selection(request: Request) -> Response:
    """The live page with a copy of what was saved, for a duty cycle that is too long for a link."""
    label = request.query_params.get("revision")
    return await found(request, request.path_params["id"], partial(_copied, request), label)


def _copied(request: Request, reopened: Reopened) -> Response:
    return calculator.respond(request, calculator.read_query(reopened.link.removeprefix("/?").encode()))


# --- What the page shows ----------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class ChangedField:
    """One difference, ready to read."""

    candidate: str | None
    check: str | None
    phase: int | None
    field: str
    unit: str
    verdict: bool
    saved: str
    today: str
    worded: bool = False
    """True for a sentence that only reads otherwise: about a check, a notice, why a gear does not fit."""


def _page(reopened: Reopened, designation: str, catalogue: Catalogue) -> dict[str, Any]:
    application = reopened.application
    answer = result_of(reopened.saved, reopened.selection, application, reopened.then, designation)
    changed = [_line(difference, reopened) for difference in reopened.differences[:DIFFERENCES_ON_PAGE]]
    return {
        "reopened": reopened,
        "answer": answer,
        "lines": [line for line in changed if not line.worded],
        "worded": [line for line in changed if line.worded],
        "catalogue_version": catalogue.version,
        "published": _published(reopened.then, catalogue, answer.chosen.designation),
        "changed_figures": [
            _figure_line(difference)
            for difference in reopened.figures or ()
            if difference.field != "designation" and difference.candidate in (None, answer.chosen.designation)
        ],
        "changed_gears": _gears(reopened.figures, gone=False),
        "gone_gears": _gears(reopened.figures, gone=True),
        "ordering": _ordering(reopened.saved, catalogue),
        "engine_version": ENGINE_VERSION,
        "document": reopened.saved.application.decode(),
        "filed": replace(current(), digits=DIGITS),
        "most_rows": MOST_ROWS,
        "exports": EXPORTS,
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
    chosen = selection.candidate(designation or saved.designation or "") or selection.foremost
    return Result(
        selection=selection,
        application=application,
        chosen=chosen,
        asked=chosen is not selection.foremost,
        catalogue=then,
        choosing=f"{url_of(saved.id)}?gear=",
    )


def _published(then: Catalogue | None, today: Catalogue, designation: str) -> list[Row]:
    """Published figures of a gear then and today; none where the catalogue of then is lost."""
    gears = [one.by_designation.get(designation) if one else None for one in (then, today)]
    return rows_of(*(ranged(published(gear)) for gear in gears)) if gears[0] else []


def _gears(figures: Sequence[FigureDifference] | None, *, gone: bool) -> list[str]:
    """Candidates of which today's catalogue publishes other figures, or those that it lacks."""
    found = {
        difference.candidate
        for difference in figures or ()
        if difference.candidate and (difference.field == "designation") == gone
    }
    return sorted(found, key=_number)


def _ordering(saved: SavedSelection, catalogue: Catalogue) -> str:
    """The saved ordering code where today's catalogue has no such gear or output version, else empty."""
    code = saved.ordering_code or ""
    return code if code and isinstance(read_ordering_code(catalogue, code), Sentence) else ""


def _figure_line(difference: FigureDifference) -> ChangedField:
    """A published figure of a gear or motor, ready to read."""
    table, unit = MOTOR if difference.motor else GEAR, symbol_of(difference.field)
    name = FIGURES.get(difference.field) or table[difference.field].name
    saved, today = _both(difference.saved, difference.today, unit) or (
        _figure_text(value, unit) for value in (difference.saved, difference.today)
    )
    return ChangedField(difference.motor or difference.candidate, "", None, name, unit, False, saved, today)


_BOLTS = {"number_of_bolts": "{} ×", "pitch_diameter_mm": "⌀ {}", "tightening_torque_Nm": "· {}"}
"""Formats of the figures of bolts, beside the thread and its torque."""


def _figure_text(value: Any, unit: str) -> str:
    """A published figure in the reader's language: a number, bolts such as 4 × M6, or the points of a curve."""
    reader = current()
    if isinstance(value, str):
        return value
    if isinstance(value, dict):
        given = {name: _figure_text(part, symbol_of(name)) for name, part in value.items() if part is not None}
        return " ".join(_BOLTS.get(name, "{}").format(text) for name, text in given.items())
    if isinstance(value, list):
        return (" / " if all(map(is_number, value)) else "; ").join(_figure_text(part, unit) for part in value)
    return reader.with_unit(reader.figure(value, unit), unit)


def _number(designation: str) -> list[int]:
    """Sort key of gears: size, then ratio."""
    return [int(digits) for digits in re.findall(r"\d+", designation)]


def _line(difference: Difference, reopened: Reopened) -> ChangedField:
    definitions = reopened.selection.check_definitions
    titles = {code: definition.title for code, definition in definitions.items()}
    own = difference.check in definitions and difference.field in ("demand", "limit")
    unit = definitions[difference.check or ""].unit if own else symbol_of(difference.field)
    given = difference.saved, difference.today
    if difference.field in SHARES:
        unit, given = "%", tuple(100 * value if is_number(value) else value for value in given)
    saved, today = _both(*given, unit) or (
        _text(value, difference, selection, reopened, unit)
        for value, selection in zip(given, (reopened.selection, reopened.today), strict=True)
    )
    worded = difference.change == "changed" and _is_wording(difference, reopened)
    if saved == today and all(isinstance(value, str) for value in given):  # told alike today, so as each was written
        worded, (saved, today) = True, given
    return ChangedField(
        candidate=difference.candidate,
        check=titles.get(difference.check or "", difference.check or ""),
        phase=phase_of(difference.pointer),
        field=NAMES.get(difference.field, difference.field),
        unit=unit,
        verdict=difference.kind == "verdict",
        saved=saved,
        today=today,
        worded=worded,
    )


def _is_wording(difference: Difference, reopened: Reopened) -> bool:
    """True for a sentence about a check, and for a notice with the same values."""
    notices = (*reopened.selection.notices, *(reopened.today.notices if reopened.today else ()))
    values = {notice.text: notice.values for notice in notices}
    before, after = (values.get(str(text)) for text in (difference.saved, difference.today))
    return difference.pointer.startswith("/check_definitions/") or (before is not None and before == after)


def phase_of(pointer: str) -> int | None:
    """Number of the load phase that a JSON pointer leads to; None for any other place."""
    parts = pointer.split("/")
    return int(parts[3]) + 1 if parts[1:3] == ["duty", "phases"] else None


def _text(value: Any, difference: Difference, selection: Selection | None, reopened: Reopened, unit: str) -> str:
    """A value of a difference in the reader's language; what its version kept no values of, as it was written."""
    reader = current()
    if value is None or selection is None:
        whole = difference.change != "changed" and difference.field == "status" and difference.check is None
        return reader.text(N_("no candidate")) if whole and selection is not None else "–"
    if is_number(value):
        return reader.figure(value, unit)
    candidate = selection.candidate(difference.candidate or "")
    if difference.field == "reason" and candidate is not None and reopened.application is not None:
        return reader.told(reason_of(candidate, reopened.application.requirements.utilisation))
    if notice := next((notice for notice in selection.notices if notice.text == value), None):
        return reader.told(notice.sentence)
    definition = selection.check_definitions.get(value)
    return reader.text(definition.title if definition else VERDICTS.get(value, str(value)))


def _both(saved: Any, today: Any, unit: str) -> tuple[str, str] | None:
    """Two numbers for reading; None where one is none."""
    return _told_apart(saved, today, unit) if is_number(saved) and is_number(today) else None


def _told_apart(saved: float, today: float, unit: str) -> tuple[str, str]:
    """Two numbers for reading, with as many digits as it takes to tell them apart."""
    reader = current()
    before, after = reader.figure(saved, unit), reader.figure(today, unit)
    if before == after:
        measure = reader.measure(unit)
        pairs = ((measure.written(saved, digits), measure.written(today, digits)) for digits in range(3, 18))
        first, second = next((pair for pair in pairs if len(set(pair)) == 2), ("", ""))
        return (reader.written(first), reader.written(second)) if first else (before, after)
    return before, after


router = APIRouter(include_in_schema=False)
router.add_api_route("/selections/{id}", show_selection, dependencies=[admit("reading")])
router.add_api_route("/selections/{id}/copy", copy_selection, dependencies=[admit("reading")])
