"""Live page: one address takes the whole application, and answers with the whole page or with its changed parts."""

import secrets
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any
from zlib import crc32

from fastapi import APIRouter
from starlette.requests import Request
from starlette.responses import HTMLResponse, RedirectResponse, Response

from hpn.application import Application, InputError
from hpn.catalogue import Catalogue
from hpn.catalogue.ordering import OrderingCode, ordering_code
from hpn.engine.selection import judge
from hpn.explain.drawings import Pictures, default_condition
from hpn.links.labels import query_of
from hpn.links.writer import to_link
from hpn.tables.numbers import WRITTEN
from hpn.web.door.access import MAXIMUM_QUERY_BYTES, admit
from hpn.web.door.bodies import pairs_of, read_form
from hpn.web.door.pools import compute, worked
from hpn.web.door.visit import absolute, current
from hpn.web.form import link_reader
from hpn.web.form.condition import Condition, condition_of
from hpn.web.form.form import Form, address_of_empty, for_reader
from hpn.web.form.linked import LONGEST_LINK, WRITTEN_AT
from hpn.web.form.offers import beside_fields
from hpn.web.form.query import CYCLE_NAMES, FieldProblem
from hpn.web.pages.axis_view import AxisView
from hpn.web.pages.gear_map import GearMap, map_of
from hpn.web.pages.insight import Insight, checked_pins, tail_of
from hpn.web.pages.result import Result
from hpn.web.pages.templates import environment
from hpn.words.wording import N_, Sentence

SECTIONS = ("overview", "bearing", "drive", "candidates", "compare", "tolerance", "calculation", "notes")
"""Sections of the result in their order."""

FIGURES = frozenset(("bearing_figure", "sizes_figure"))
"""Plots, sent only when they are unfolded: their data are useless without script."""

PARTS = FIGURES.union(SECTIONS[1:])
"""Parts that an edit sends only if they are in sight, as the header HPN-Parts says; others are fetched later."""


@dataclass(frozen=True, kw_only=True)
class LiveResult(Result):
    """Result of the live page, with the gears beside the chosen one.

    `link` contains the application alone, `address` everything in the form. On the page of an axis, `axis`, both
    contain its own part only; `whole` is the whole application as a separate selection.
    `own_cycle` is the address of the cycle alone if everything beside it is still the worked example's, else empty.
    """

    application: Application
    catalogue: Catalogue
    link: str
    address: str
    whole: str
    order: OrderingCode
    insight: Insight
    own_cycle: str
    form: Form
    axis: AxisView | None = None
    live: bool = True

    @cached_property
    def condition(self) -> Condition:
        """Condition for the shaft's permitted load, typed beside the answer when no load is given."""
        assert self.pictures is not None
        typed = [(WRITTEN_AT, self.form.written or ""), *self.form.condition.items()]
        return condition_of(typed, current(), default_condition(self.pictures.subject))

    @cached_property
    def bearing_pictures(self) -> Pictures | None:
        """Pictures of the section on the output bearing; without a load under the typed condition."""
        if self.pictures is None or self.application.loads is not None:
            return self.pictures
        return replace(self.pictures, condition=self.condition.query)

    @cached_property
    def map(self) -> GearMap:
        """Map of all gears in the catalogue."""
        return map_of(self.selection, self.insight.everything, self.catalogue)

    @property
    def mark(self) -> str:
        """Short mark of the answer; it identifies parts of the answer that are sent later."""
        return f"{crc32(self.address.encode()):08x}"

    @property
    def carried(self) -> str:
        """Query that carries the selection to other pages; blank for a selection that is too long."""
        return self.whole[1:] if len(self.whole) <= LONGEST_LINK else ""

    @property
    def too_long(self) -> bool:
        """True if the address is longer than servers and proxies let through."""
        return len(self.address) > MAXIMUM_QUERY_BYTES


def once_key() -> str:
    """Unguessable key of a page's form: however often the form is sent, it is saved once."""
    return secrets.token_urlsafe(16)


def show(request: Request) -> Response:
    """Page of `/`, or for htmx only the part that changes with the input."""
    query = request.scope["query_string"]
    return respond(request, read_query(query), first=not query)


async def show_posted(request: Request) -> Response:
    """Page of a posted form, which may be too long for an address; saves nothing."""
    body = await read_form(request)
    return await compute(request, "pages", lambda: respond(request, link_reader.parse(pairs_of(body))))


def respond(request: Request, form: Form, *, first: bool = False, axis: AxisView | None = None) -> Response:
    """Page of a form, or only the part that changes; a first visit also gets the page's purpose above the answer.

    The form may belong to an axis of a machine.
    """
    catalogue: Catalogue = request.app.state.catalogue
    form, answer = form_and_answer(form, catalogue, axis)
    changes = "hx-request" in request.headers
    # True if the address contains everything that the page does.
    alone = not (form.focus or form.asides or form.bodies.is_filled or (form.has_tolerances and form.is_exact))
    if answer and WRITTEN in request.query_params and not changes and alone:
        own = answer.condition.tail if form.condition else ""
        return RedirectResponse(
            f"{answer.address}{own}", 303
        )  # input in a reader's units gets an address for everybody
    parts = _parts(request, form)
    if answer and "result" in parts:
        request.app.state.metrics.selections(["none" if answer.selection.selected is None else "selected"])
    if answer is None and parts <= PARTS:
        return Response(status_code=204)  # a form with faults has no parts to fetch: the previous answer's stay
    template = "_changes.html" if changes else "axis.html" if axis else "page.html"
    status = 422 if form.problems and not (axis and not axis.is_changed) else 200
    once = "" if axis else once_key()  # saving an axis names the state that it changes
    values: dict[str, Any] = {"form": form, "answer": answer, "parts": parts, "catalogue": catalogue, "once": once}
    values |= {"first": first, "axis": axis, "bench": axis.place if axis else "/"}
    printed = absolute(request, answer.address) if answer else ""
    return _render(request, template, status, printed=printed, **values)


def read_query(query: bytes) -> Form:
    """Form of a query; the handbook's worked example without a query."""
    text = query.decode("latin-1") or to_link(Application.worked_example()).removeprefix("/?")
    return link_reader.parse(pairs_of(text))


def form_and_answer(form: Form, catalogue: Catalogue, axis: AxisView | None = None) -> tuple[Form, LiveResult | None]:
    """Form and its answer; without an answer the form has problems, or is blank."""
    if form.gear and catalogue.find(form.gear) is None:
        unknown = Sentence(N_("{gear} is not a gear of the catalogue"), {"gear": form.gear[:40]})
        form = replace(form, problems=(*form.problems, FieldProblem("gear", None, unknown)))
    form = checked_pins(form, catalogue)
    if form.application is None or form.problems:
        return form, None
    try:
        return form, _answer(form.application, form, catalogue, axis)
    except InputError as refusal:
        refused = [FieldProblem(*link_reader.place_of(location), sentence) for location, sentence in refusal.sentences]
        return replace(form, application=None, problems=tuple(refused)), None


def _answer(application: Application, form: Form, catalogue: Catalogue, axis: AxisView | None) -> LiveResult:
    link_of = axis.link if axis else to_link
    link = link_of(application)
    judged = judge(application, catalogue)
    selection = judged.selection(link_of, with_room=False)
    everything = {candidate.designation: candidate for candidate in (*selection.candidates, *judged.left_out())}
    gear = catalogue.find(form.gear or selection.foremost.designation)
    assert gear is not None  # `answered` refuses what the catalogue lacks
    order = ordering_code(catalogue, gear, form.labels["order_output"], form.labels["order_motor"])
    labels = query_of({**form.labels, **order.labels})
    tail = tail_of(form.pins) + labels
    chosen = f"&gear={gear.designation}" if form.gear else ""
    return LiveResult(
        selection=selection,
        application=application,
        chosen=everything[gear.designation],
        is_chosen_gear=bool(form.gear),
        catalogue=catalogue,
        link=link,
        example=axis is None and application == Application.worked_example(),
        own_cycle=own + chosen + tail if axis is None and (own := _own_cycle(link)) else "",
        tail=tail,
        address=axis.address(link, chosen + tail) if axis else link + chosen + tail,
        whole=to_link(application) + chosen + tail,
        axis=axis,
        links=link_of,
        order=order,
        form=form,
        insight=Insight(
            application, selection, everything, everything[gear.designation], form.pins, catalogue, links=link_of
        ),
    )


def _own_cycle(link: str) -> str:
    """Link of a cycle alone if everything beside it is still the worked example's, else empty."""
    (own, beside), (example, left) = (_parted(each) for each in (link, to_link(Application.worked_example())))
    return f"/?{'&'.join(own)}" if beside == left and own != example else ""


def _parted(link: str) -> tuple[list[str], list[str]]:
    """Parameters of a link that belong to its cycle, and the others."""
    own, beside = list[str](), list[str]()
    for pair in link.removeprefix("/?").split("&"):
        (own if pair.partition("=")[0] in CYCLE_NAMES else beside).append(pair)
    return own, beside


def _parts(request: Request, form: Form) -> frozenset[str]:
    """Parts to send: all of them for a page, the changed ones and those in sight for an edit.

    Typing changes only the result. Buttons that edit rows, and replacements of all inputs, change the form.
    """
    if "hx-request" not in request.headers:
        return PARTS - FIGURES | {"form", "result"}
    _, _, target = request.headers.get("hx-target", "").partition("#")
    if target in PARTS:
        return frozenset((target,))
    parts = PARTS.intersection(request.headers.get("hpn-parts", "").split())
    return parts | ({"result"} if target == "result" and not form.focus else {"form", "result"})


def _render(request: Request, template: str, status: int, **context: Any) -> Response:
    form: Form = context["form"]
    address = _address(context["answer"], form, context["axis"])
    form = replace(form, problems=beside_fields(form.problems, form.written, current()))
    if "form" in context["parts"]:  # typing gets only the result, and leaves the fields unchanged
        form = for_reader(form, current())
    context["form"] = form
    content = environment(request.app.state).get_template(template).render(**context)
    response = HTMLResponse(content, status)
    response.headers["Vary"] = "HX-Request, HX-Target, HPN-Parts"
    if "hx-request" in request.headers:
        if address and "result" in context["parts"]:
            response.headers["HX-Push-Url"] = address
        if "form" in context["parts"]:
            response.headers.update({"HX-Retarget": "#application", "HX-Reswap": "outerHTML"})
    return response


def _address(answer: LiveResult | None, form: Form, axis: AxisView | None) -> str | None:
    """Address for the address bar; None for a form with problems."""
    if answer is None and axis and form.empty:
        return axis.address(axis.open_link, tail_of(form.pins))
    if answer is None:
        return address_of_empty(form) if form.empty else None
    # A page too long for an address must not appear under another page's: reloading returns to its source.
    return (axis.place if axis else "/paste") if answer.too_long else answer.address


router = APIRouter(include_in_schema=False, dependencies=[admit("calculator")])
router.add_api_route("/", worked(show))
router.add_api_route("/", show_posted, methods=["POST"])
