"""Page of pairs: an application, or an axis of a machine, with every gear and every motor of a list."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any
from urllib.parse import urlencode

from fastapi import APIRouter
from starlette.requests import Request
from starlette.responses import Response

from hpn.application import Application, InputError, Motor, MotorEntry, PairRank
from hpn.links.writer import to_link
from hpn.store import MotorListLine
from hpn.tables.motor_inputs import MOTORS
from hpn.tables.numbers import read_value
from hpn.web import motor_lists
from hpn.web.door.access import admit
from hpn.web.door.bodies import pairs_of
from hpn.web.door.pools import compute
from hpn.web.form import link_reader
from hpn.web.form.form import Form
from hpn.web.form.linked import LONGEST_LINK
from hpn.web.machines import axis_of
from hpn.web.motor_lists import SERVER
from hpn.web.pages.axis import neighbours, number_of
from hpn.web.pages.axis_view import AxisView, view_of
from hpn.web.pages.motor_lists import REASON, MotorUpload
from hpn.web.pages.pairs_view import MOST_ROWS, ROWS_AT_FIRST, PairsView, facts_of
from hpn.web.pages.rendering import or_reason, page
from hpn.words.wording import N_, Sentence

ADDRESS = "/pairs"
OWN = ("list", "by", "fd", "all", "at", "more")
"""Parameters of the page itself; all others belong to the application."""

OF_MOTOR = ("nm", "Tm", "Tmn", "nmr", "Jm", "md", "Jr", "Tst", "mmo", "mcv", "mnm")
TYPED = ("Jr", "eta")
"""Inputs of the application in the page's own form."""

RANKS: Mapping[PairRank, str] = {
    "weight": N_("mass of the pair"),
    "utilisation": N_("utilisation"),
    "inertia_ratio": N_("inertia ratio"),
    "resonance": N_("resonance, highest first"),
}
NO_RESONANCE = N_("The lowest resonance must be a number above 0.")
NO_RATIO = N_("The largest inertia ratio must be a number above 0.")
NO_INERTIA = N_("Inertia ratio and resonance need a motion, or the inertia of the load in the application.")


@dataclass(frozen=True)
class PairsQuery:
    """Content of the address: the application's parameters, the page's own, and the application's axis, if any."""

    place: str
    back: str
    form: Form
    carried: list[tuple[str, str]]
    own: Mapping[str, str]
    axis: AxisView | None = None

    @cached_property
    def ratio(self) -> float | Sentence | None:
        """Typed largest inertia ratio; a sentence for an invalid text, None for a blank one."""
        text = dict(self.carried).get("Jr", "").strip()
        return positive(text, NO_RATIO) if text else None

    @cached_property
    def application(self) -> Application | None:
        """Application with the largest inertia ratio in place of a motor; None if it can't be read."""
        application = self.form.application if not self.form.problems else None
        if application is None or self.ratio is None or isinstance(self.ratio, Sentence):
            return application
        return application.requiring(motor=Motor(inertia_ratio=self.ratio))

    def link(self, **more: str) -> str:
        """Address of the page with some of its own parameters changed."""
        own = {name: text for name, text in {**self.own, **more}.items() if text}
        return f"{self.place}?{urlencode([*self.carried, *own.items()])}"


@or_reason(REASON)
async def show_pairs(request: Request) -> Response:
    """Page of pairs for the application of the address."""
    return await _pairs_page(request, await compute(request, "pages", _query_of, request.url.query))


def _query_of(query: str) -> PairsQuery:
    pairs = pairs_of(query)
    carried = [pair for pair in pairs if pair[0] not in OWN]
    form = link_reader.parse(_read_alone(carried))
    return PairsQuery(ADDRESS, f"/?{urlencode(carried)}", form, carried, dict(p for p in pairs if p[0] in OWN))


@or_reason(REASON)
async def show_axis_pairs(request: Request) -> Response:
    """Page of pairs for an axis of a machine, as stored or with the inputs of the address."""
    machine, axis = await axis_of(request, request.path_params["id"], number_of(request))
    around = await neighbours(request, machine, axis)

    def read() -> PairsQuery:
        pairs = pairs_of(request.url.query)
        carried = [pair for pair in pairs if pair[0] not in OWN]
        form, view = view_of(machine, axis, around, _read_alone(carried), request.app.state.catalogue)
        own = dict(pair for pair in pairs if pair[0] in OWN)
        own_pairs = carried or list(view.typed)
        return PairsQuery(f"{view.place}/pairs", view.place, form, own_pairs, own, view)

    return await _pairs_page(request, await compute(request, "pages", read))


def _read_alone(pairs: Sequence[tuple[str, str]]) -> list[tuple[str, str]]:
    """Parameters of an application without its own motor, which the list's motors replace."""
    return [(name, _plain(text) if name in TYPED else text) for name, text in pairs if name not in OF_MOTOR]


def _plain(text: str) -> str:
    """Typed number in plain notation."""
    return text.strip().replace(",", ".")


async def _pairs_page(request: Request, query: PairsQuery) -> Response:
    state = request.app.state
    lines = await motor_lists.lines_of(request)
    first = SERVER if state.catalogue.motors else lines[0].id if lines else ""
    id = query.own.get("list") or first
    motors: list[MotorEntry] = []
    problems = list[Sentence]()
    if id:
        try:
            motors = await motor_lists.motors_of(request, id)
        except InputError as error:
            problems += [sentence for _, sentence in error.sentences]
    return await compute(request, "pages", _page, request, query, lines, id, motors, problems)


def _page(
    request: Request,
    query: PairsQuery,
    lines: list[MotorListLine],
    id: str,
    motors: list[MotorEntry],
    problems: list[Sentence],
) -> Response:
    catalogue, view, application = request.app.state.catalogue, None, query.application
    text = query.own.get("fd", "").strip()
    least = positive(text, NO_RESONANCE) if text else None
    wrong = query.form.problems if query.carried else ()
    problems += _problems_of(query, least)
    if application is not None and motors and not problems:
        by = query.own.get("by", "weight")
        gear, _, motor = query.own.get("at", "").partition(" ")
        view = PairsView(
            application,
            motors,
            catalogue,
            _links(query),
            next((rank for rank in RANKS if rank == by), "weight"),
            least if isinstance(least, float) else None,
            bool(query.own.get("all")),
            MOST_ROWS if query.own.get("more") else ROWS_AT_FIRST,
            (gear, motor),
        )
        try:
            _ = view.table
        except InputError as error:
            view, problems = None, [*problems, *(sentence for _, sentence in error.sentences)]
    context: dict[str, Any] = {
        "query": query,
        "lines": lines,
        "server": len(catalogue.motors),
        "id": id,
        "view": view,
        "ranks": RANKS,
        "problems": problems,
        "typed": TYPED,
        "motors": motors,
        "facts": facts_of(query.form.application) if query.form.application else None,
        "draft": MotorUpload(link=urlencode(query.carried) if query.axis is None else ""),
        "roles": MOTORS.by_role,
    }
    return page(request, "pairs.html", 422 if wrong else 200, **context)


def _problems_of(query: PairsQuery, least: float | Sentence | None) -> list[Sentence]:
    """Problems of an application and of the limits of its pairs."""
    problems = [one for one in (least, query.ratio) if isinstance(one, Sentence)]
    problems += [problem.message for problem in query.form.problems if query.carried]
    application = query.application
    needs = (least is not None or query.ratio is not None) and not problems
    if needs and application and not application.duty_cycle.motion and not application.requirements.load_inertia_kgm2:
        problems.append(Sentence(NO_INERTIA))
    return problems


def positive(text: str, template: str) -> float | Sentence:
    """Number above 0, or the sentence of a template for any other text."""
    value = read_value(_plain(text), "number")
    return Sentence(template) if isinstance(value, Sentence) or not 0 < float(value) < 1e9 else float(value)


def _links(query: PairsQuery) -> Callable[[Application, str], str | None]:
    """Function that makes links of pairs, to the selection or back to the axis; None for a link that is too long."""
    write = query.axis.link if query.axis else to_link

    def link(application: Application, gear: str) -> str | None:
        address = f"{write(application)}&gear={gear}"
        return address if len(address) <= 2 * LONGEST_LINK else None

    return link


router = APIRouter(include_in_schema=False)
router.add_api_route(ADDRESS, show_pairs, dependencies=[admit("calculator")])
router.add_api_route("/machines/{id}/axes/{number}/pairs", show_axis_pairs, dependencies=[admit("reading")])
