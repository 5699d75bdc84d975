"""The page: one address that takes the whole application, and answers with the whole page or with what has changed."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any
from urllib.parse import parse_qsl

from fastapi import APIRouter
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from starlette.datastructures import State
from starlette.requests import Request
from starlette.responses import HTMLResponse, RedirectResponse, Response

from hpn.application import Application, InputError
from hpn.candidates import Candidate, foremost, is_judged, is_unlimited
from hpn.catalogue import Catalogue
from hpn.checks import allowed
from hpn.drawings.picture import beyond_limit
from hpn.gear import Gear
from hpn.notices import AREAS
from hpn.remedy import DRIVERS
from hpn.selection import Selection, select
from hpn.web import display, reader
from hpn.web.api.embeds import preview
from hpn.web.door.access import admit
from hpn.web.form import read as links
from hpn.web.form.entries import WRITTEN
from hpn.web.form.messages import N_, Message
from hpn.web.form.read import Form, Problem
from hpn.web.form.write import to_link
from hpn.web.pages import assets, mathml, pictures
from hpn.web.pages.as_read import as_read, as_typed
from hpn.web.pages.insight import Insight, checked_pins, insight_of, tail_of
from hpn.web.pages.ordering import MOTOR_CODE, ordering_code

TEMPLATES = Path(__file__).parents[4] / "frontend/templates"

PARTS = frozenset(("form", "result", "calculation", "stops_figure"))
"""What an answer is made of.

A script names in the header HPN-Parts those that it is after, so that an edit brings neither the form that it came from
nor what is folded away. Where there is something to correct, the form comes in any case.
"""

LONGEST_REPEATED = 3000
"""Length of a link up to which a page may carry it hundreds of times."""


@dataclass(frozen=True)
class Cell:
    """One gear in the map of sizes and ratios; `asked` tells whether the ratio and size wishes include it."""

    gear: Gear
    candidate: Candidate
    asked: bool

    @property
    def level(self) -> str:
        """Step of the colour scale: five for gears that pass, one each for those that fail and those not rated."""
        if self.candidate["status"] == "suitable":
            return f"l{min(int(self.candidate['utilisation'] * 5), 4)}"
        return "over" if self.candidate["status"] == "unsuitable" else "unknown"


@dataclass(frozen=True)
class Answer:
    """Reply to an application, and the candidate that the page looks at."""

    link: str
    address: str
    reply: Mapping[str, Any]
    selection: Selection
    everything: Selection
    """The same for every gear of the catalogue, whatever ratios and sizes were asked for."""
    chosen: Candidate
    gear: Gear
    lighter: Candidate | None
    map: tuple[tuple[int, tuple[Cell | None, ...]], ...]
    insight: Insight

    @property
    def linked(self) -> bool:
        """Whether the link is short enough to stand once for each gear."""
        return len(self.link) <= LONGEST_REPEATED

    @property
    def too_long(self) -> bool:
        """Whether the address is more than servers and proxies let through."""
        return len(self.address) > links.MAXIMUM_QUERY_BYTES


def show(request: Request) -> Response:
    """The page of `/`, or only the part that changes with the input where htmx asks for it."""
    query = request.scope["query_string"]
    if len(query) > links.MAXIMUM_QUERY_BYTES:
        return _render(request, "too_long.html", 414, limit=links.MAXIMUM_QUERY_BYTES)
    return respond(request, read_query(query))


def respond(request: Request, form: Form) -> Response:
    """The page of a form, or only the part that changes."""
    catalogue: Catalogue = request.app.state.catalogue
    form, answer = answered(form, catalogue)
    parts = _parts(request)
    if answer and WRITTEN in request.query_params and not _wants_changes(request) and not form.focus:
        return RedirectResponse(answer.address, 303)  # what was written in a reader's units gets an address for all
    if answer and "result" in parts:
        request.app.state.metrics.selection(answer.reply["selected"])
    status = 422 if form.problems else 200
    template = "_changes.html" if _wants_changes(request) else "page.html"
    return _render(request, template, status, form=form, answer=answer, parts=parts, catalogue=catalogue)


def read_query(query: bytes) -> Form:
    """Form of a query; without one, the handbook's worked example."""
    text = query.decode("latin-1") or to_link(Application.worked_example()).removeprefix("/?")
    return links.parse(parse_qsl(text, keep_blank_values=True))


def answered(form: Form, catalogue: Catalogue) -> tuple[Form, Answer | None]:
    """Answer to a form; a form that can't be answered comes back with its problems."""
    if form.gear and catalogue.find(form.gear) is None:
        unknown = Message(N_("%(gear)s is not a gear of the catalogue"), {"gear": form.gear[:40]})
        form = replace(form, problems=(*form.problems, Problem("gear", None, unknown)))
    form = checked_pins(form, catalogue)
    if form.application is None or form.problems:
        return form, None
    try:
        return form, _answer(form.application, form, catalogue)
    except InputError as refusal:
        refused = [Problem(*links.place_of(location), sentence) for location, sentence in refusal.sentences]
        return replace(form, application=None, problems=tuple(refused)), None


def _answer(application: Application, form: Form, catalogue: Catalogue) -> Answer:
    link = to_link(application)
    selection = select(application, catalogue)
    reply = selection.reply(link)
    everything = _unrestricted(selection)
    landscape = _by_designation(reply if everything is selection else everything.reply(""))
    gear = catalogue.find(form.gear or foremost(reply["candidates"])["designation"])
    assert gear is not None  # `answered` refuses what the catalogue lacks
    chosen, lighter = landscape[gear.designation], _lighter_miss(reply, catalogue)
    return Answer(
        link=link,
        address=link + (f"&gear={gear.designation}" if form.gear else "") + tail_of(form.pins),
        reply=reply,
        selection=selection,
        everything=everything,
        chosen=chosen,
        gear=gear,
        lighter=lighter,
        map=_map(reply, landscape, catalogue),
        insight=insight_of(selection, reply, landscape, chosen, lighter, form.pins),
    )


def _unrestricted(selection: Selection) -> Selection:
    """The same application without its wishes for ratios and sizes."""
    application = selection.application
    wishes = application.requirements
    if not wishes.ratios and not wishes.sizes:
        return selection
    free = wishes.model_copy(update={"ratios": None, "sizes": None})
    return select(application.model_copy(update={"requirements": free}), selection.catalogue)


def _by_designation(reply: Mapping[str, Any]) -> dict[str, Candidate]:
    return {candidate["designation"]: candidate for candidate in reply["candidates"]}


def _map(
    reply: Mapping[str, Any], landscape: Mapping[str, Candidate], catalogue: Catalogue
) -> tuple[tuple[int, tuple[Cell | None, ...]], ...]:
    asked = {candidate["designation"] for candidate in reply["candidates"]}
    gears = {(gear.ratio, gear.size): gear for gear in catalogue.gears}

    def cell(ratio: int, size: str) -> Cell | None:
        gear = gears.get((ratio, size))
        return Cell(gear, landscape[gear.designation], gear.designation in asked) if gear else None

    return tuple((ratio, tuple(cell(ratio, size) for size in catalogue.sizes)) for ratio in catalogue.ratios)


def _lighter_miss(reply: Mapping[str, Any], catalogue: Catalogue) -> Candidate | None:
    """The rejected gear closest to passing among those that are judged and lighter than the selected one."""
    selected = catalogue.find(reply["selected"] or "")
    if selected is None or selected.weight_kg is None:
        return None
    for candidate in reply["candidates"]:
        weight = catalogue.by_designation[candidate["designation"]].weight_kg
        lighter = weight is not None and weight < selected.weight_kg
        if candidate["status"] == "unsuitable" and lighter and is_judged(candidate):
            found: Candidate = candidate
            return found
    return None


def _wants_changes(request: Request) -> bool:
    """Whether htmx asks for a part; when it goes back in history it needs the whole page."""
    return "hx-request" in request.headers and "hx-history-restore-request" not in request.headers


def _parts(request: Request) -> frozenset[str]:
    """Parts that the answer is to bring: all of them, unless a script asks for some."""
    asked = request.headers.get("hpn-parts")
    return PARTS if asked is None or not _wants_changes(request) else PARTS.intersection(asked.split())


def _render(request: Request, template: str, status: int, **context: Any) -> Response:
    address = _address(context.get("answer"), context.get("form"))
    if "form" in context:
        context["form"] = links.for_reader(context["form"], reader.current())
    content = environment(request.app.state).get_template(template).render(**context)
    response = HTMLResponse(content, status)
    response.headers["Vary"] = "HX-Request, HX-History-Restore-Request, HPN-Parts"
    if address and _wants_changes(request) and "result" in context["parts"]:
        response.headers["HX-Push-Url"] = address
    return response


def _address(answer: Answer | None, form: Form | None) -> str | None:
    """What is to stand in the address bar; None where there is something to correct."""
    if answer is None:
        return links.address_of_empty(form) if form and form.empty else None
    # What is too long for an address must not stand under somebody else's: reloading leads to where it came from.
    return "/paste" if answer.too_long else answer.address


# --- Templates --------------------------------------------------------------------------------------------------------


def environment(state: State) -> Environment:
    """Templates of an application, with what they all use; made once per application."""
    if not hasattr(state, "assets"):
        state.assets = assets.Assets.load()
    if not hasattr(state, "templates"):
        state.templates = _templates(state.assets)
    templates: Environment = state.templates
    return templates


def prepare(state: State) -> None:
    """Compile all templates, so that the first page need not wait for it."""
    templates = environment(state)
    for name in templates.list_templates():
        templates.get_template(name)


class _Environment(Environment):
    """Looks into a reply first: Jinja's own way round, attribute before item, costs an exception per field."""

    def getattr(self, obj: Any, attribute: str) -> Any:
        """Field of a dictionary or attribute of an object."""
        if isinstance(obj, dict) and attribute in obj:
            return obj[attribute]
        return super().getattr(obj, attribute)


def _templates(static: assets.Assets) -> Environment:
    """Templates for any reader. `_()` takes a format, the filter `t` a text of the domain that may hold a `%`."""
    templates = _Environment(
        loader=FileSystemLoader(TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        auto_reload=False,
        extensions=["jinja2.ext.i18n"],
    )
    templates.install_gettext_callables(*reader.GETTEXT, newstyle=True)  # type: ignore[attr-defined]
    templates.filters |= (
        reader.FILTERS
        | pictures.FILTERS
        | mathml.FILTERS
        | {
            "as_read": as_read,
            "as_typed": as_typed,
            "symbols": display.symbols,
        }
    )
    templates.tests |= {"beyond_limit": beyond_limit, "unlimited": is_unlimited}
    templates.globals |= pictures.GLOBALS | {
        "asset": static.url,
        "motor_pattern": MOTOR_CODE,
        "ordering_code": ordering_code,
        **reader.GLOBALS,
        "AREAS": AREAS,
        "allowed": allowed,
        "DRIVERS": DRIVERS,
        "BEST": display.BEST,
        "CHECK_NAMES": display.CHECK_NAMES,
        "FIELD_NAMES": display.FIELD_NAMES,
        "LIMIT_FIGURES": display.LIMIT_FIGURES,
        "preview_of": preview,
    }
    return templates


router = APIRouter(include_in_schema=False, dependencies=[admit("calculator")])
router.add_api_route("/", show, methods=["GET", "HEAD"])
