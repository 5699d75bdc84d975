"""The page of a saved selection, and the form of the live page that saves one."""

import hashlib
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any
from urllib.parse import parse_qsl

import orjson
from fastapi import APIRouter
from pydantic import ValidationError
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import HTMLResponse, RedirectResponse, Response

from hpn import ENGINE_VERSION
from hpn.application import Application, InputError
from hpn.candidates import foremost
from hpn.catalogue import Catalogue
from hpn.differences import Difference
from hpn.report.inputs import LOADS, REQUIREMENTS, WORDS
from hpn.store import SavedSelection, StoreUnavailableError
from hpn.units import symbol_of
from hpn.web.api.selection_schemas import Labels
from hpn.web.api.selections import RETRY_SECONDS, Today, found, save, url_of
from hpn.web.door.access import admit
from hpn.web.door.bodies import read_form
from hpn.web.door.problems import Problem
from hpn.web.door.requests import require_same_origin
from hpn.web.form import read as links
from hpn.web.form.messages import N_
from hpn.web.pages.calculator import environment
from hpn.web.pages.gear_figures import Figure, figures_of
from hpn.web.pages.long_cycles import expanded
from hpn.web.reader import current

DIFFERENCES_ON_PAGE = 100
ONCE = re.compile(r"[A-Za-z0-9_-]{22}")

FIELDS = {
    "selected": N_("selected gear"),
    "status": N_("verdict"),
    "governing_check": N_("deciding check"),
    "rank": N_("rank"),
    "reason": N_("reason"),
    "utilisation": N_("utilisation"),
    "demand": N_("demand"),
    "limit": N_("limit"),
    "text": N_("notice"),
    "life_L10_h": N_("gear life L10"),
    "momentary_peak_count": N_("allowed emergency stops"),
    "average_torque_Nm": N_("average torque"),
    "maximum_torque_Nm": N_("maximum torque"),
    "average_output_speed_rpm": N_("average output speed"),
    "maximum_output_speed_rpm": N_("maximum output speed"),
    "average_input_speed_rpm": N_("average input speed"),
    "maximum_input_speed_rpm": N_("maximum input speed"),
}
"""Fields of a reply in words; any other stands with its own name."""

VERDICTS = {
    "suitable": N_("suitable"),
    "unsuitable": N_("not suitable"),
    "unrated": N_("not rated"),
    "pass": N_("passes"),
    "fail": N_("fails"),
    "not_rated": N_("not rated"),
}

EXPORTS = (
    ("report.pdf", N_("PDF report")),
    ("report.xlsx", N_("Workbook")),
    ("submodel.aasx", N_("Asset Administration Shell")),
)


async def show_selection(request: Request) -> Response:
    """The selection as it was saved, and beside it what today's engine and catalogue say differently."""
    id = request.path_params["id"]
    try:
        saved, today = await found(request.app.state, id)
    except (Problem, StoreUnavailableError) as error:
        return _refused(request, error)
    return await run_in_threadpool(_shown, request, saved, today)


def _shown(request: Request, saved: SavedSelection, today: Today) -> Response:
    page = _page(saved, today, request.query_params.get("gear", ""), request.app.state.catalogue)
    return _render(request, "selection.html", 200, **page)


async def save_from_page(request: Request) -> Response:
    """Saves what the live page shows, and leads to the page of the saved selection."""
    require_same_origin(request)
    body = await read_form(request)
    fields = dict(parse_qsl(body.decode(errors="replace"), keep_blank_values=True))
    query = fields.get("link", "").removeprefix("/").removeprefix("?")
    try:
        labels = Labels.model_validate({name: fields.get(name, "") for name in Labels.model_fields})
        id = await save(request.app.state, _application(query), labels, _key(fields))
    except (ValidationError, InputError) as error:
        return _refused(request, Problem.of(error), fields, query)
    except (Problem, StoreUnavailableError) as error:
        return _refused(request, error, fields, query)
    return RedirectResponse(url_of(id), 303)


def _key(fields: Mapping[str, str]) -> str | None:
    """Idempotency key of a form and what is in it: sent twice it saves once, edited it saves another.

    The blank keeps it apart from the keys of API callers.
    """
    once = fields.get("once", "")
    if ONCE.fullmatch(once) is None:
        return None
    content = orjson.dumps([fields.get(name, "") for name in ("link", *Labels.model_fields)])
    return f"form {once} {hashlib.sha256(content).hexdigest()[:32]}"


def _application(query: str) -> Application:
    form = links.parse(expanded(parse_qsl(query, keep_blank_values=True))) if query else None
    if form is None or form.application is None or form.problems:
        raise Problem(422, "the inputs have errors: correct them on the page, then save")
    return form.application


def _refused(
    request: Request, error: Problem | StoreUnavailableError, fields: Mapping[str, str] | None = None, query: str = ""
) -> Response:
    """Page that says why, and still has what was typed."""
    if isinstance(error, StoreUnavailableError):
        error = Problem(503, str(error), headers={"Retry-After": str(RETRY_SECONDS)})
    if error.status_code == 410 and fields:
        fields = {**fields, "once": ""}  # whoever saves it again means to
    shown = {
        "detail": error.detail,
        "errors": {location[0]: text for location, text in error.errors if location},
        "fields": fields,
        "answer": {"link": f"/?{query}"},
    }
    response = _render(request, "selection_refused.html", error.status_code, **shown)
    response.headers.update(error.headers or {})
    return response


def _render(request: Request, template: str, status: int, **context: Any) -> HTMLResponse:
    content = environment(request.app.state).get_template(template).render(status=status, **context)
    return HTMLResponse(content, status, {"Cache-Control": "no-cache"})


# --- What the page shows ----------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Line:
    """One difference, ready to read."""

    candidate: str | None
    check: str | None
    field: str
    unit: str
    verdict: bool
    saved: str
    today: str


def _page(saved: SavedSelection, today: Today, designation: str, catalogue: Catalogue) -> dict[str, Any]:
    reply = orjson.loads(saved.result)
    candidates = reply["candidates"]
    chosen = next((entry for entry in candidates if entry["designation"] == designation), foremost(candidates))
    try:
        application = Application.model_validate_json(saved.application)
    except ValidationError:  # saved by a version with other inputs; they are shown as they were written
        application = None
    return {
        "saved": saved,
        "reply": reply,
        "chosen": chosen,
        "today": today,
        "lines": [_line(difference, reply) for difference in today.differences[:DIFFERENCES_ON_PAGE]],
        "catalogue_version": catalogue.version,
        "published": _published(today.then, catalogue, chosen["designation"]),
        "changed_gears": sorted({difference.candidate for difference in today.figures or ()}, key=_number),
        "engine_version": ENGINE_VERSION,
        "application": application,
        "document": saved.application.decode(),
        "inputs": [] if application is None else list(_inputs(application)),
        "exports": EXPORTS,
    }


def _published(then: Catalogue | None, today: Catalogue, designation: str) -> list[tuple[Figure, Figure | None]]:
    """Published figures of a gear, each with today's where that differs; none where the catalogue of then is lost."""
    before, after = _figures(then, designation), _figures(today, designation)
    pairs = zip(before, after or before, strict=bool(before))
    return [(old, None if old.values == new.values else new) for old, new in pairs]


def _figures(catalogue: Catalogue | None, designation: str) -> list[Figure]:
    gear = catalogue.by_designation.get(designation) if catalogue else None
    return [figure for _, figures in figures_of(gear) for figure in figures] if gear else []


def _number(designation: str) -> list[int]:
    """What gears are sorted by: size, then ratio."""
    return [int(digits) for digits in re.findall(r"\d+", designation)]


def _inputs(application: Application) -> Iterable[tuple[str, str, bool]]:
    """Label, value with unit, and whether the value is a text to translate, of every input that is given."""
    for entry in (*LOADS, *REQUIREMENTS):
        value = entry.value(application)
        if isinstance(value, tuple):
            yield entry.label, ", ".join(str(item) for item in value), False
        elif isinstance(value, str):
            yield entry.label, WORDS[value], True
        elif value is not None:
            yield entry.label, f"{current().exact(value, entry.unit)} {current().unit(entry.unit)}".rstrip(), False


def _line(difference: Difference, reply: Mapping[str, Any]) -> Line:
    definitions = reply["check_definitions"]
    definition = definitions.get(difference.check, {})
    own = difference.field in ("demand", "limit")
    titles = {code: entry["title"] for code, entry in definitions.items()}
    unit = definition.get("unit", "") if own else symbol_of(difference.field)
    saved, today = _texts(difference.saved, difference.today, unit)
    return Line(
        candidate=difference.candidate,
        check=titles.get(difference.check, difference.check),
        field=FIELDS.get(difference.field, difference.field),
        unit=unit,
        verdict=difference.kind == "verdict",
        saved=(VERDICTS | titles).get(saved, saved),
        today=(VERDICTS | titles).get(today, today),
    )


def _texts(saved: Any, today: Any, unit: str) -> tuple[str, str]:
    """Two values for reading, with as many digits as it takes to tell numbers apart."""
    reader = current()
    before, after = (reader.figure(value, unit) if _is_number(value) else str(value or "–") for value in (saved, today))
    if before == after and _is_number(saved) and _is_number(today):
        measure = reader.measure(unit)
        pairs = ((measure.written(saved, digits), measure.written(today, digits)) for digits in range(3, 18))
        first, second = next((pair for pair in pairs if len(set(pair)) == 2), (before, after))
        return reader.localised(first), reader.localised(second)
    return before, after


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


router = APIRouter(include_in_schema=False)
router.add_api_route("/selections", save_from_page, methods=["POST"], dependencies=[admit("writing")])
router.add_api_route("/selections/{id}", show_selection, methods=["GET", "HEAD"], dependencies=[admit("reading")])
