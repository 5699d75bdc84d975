"""The page of pairs: an application, or an axis of a machine, with every gear and every motor of a list."""

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
from hpn.tables.motors import MOTORS
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
from hpn.web.pages.pairs_view import MOST_SHOWN, SHOWN, PairsView
from hpn.web.pages.rendering import or_reason, page
from hpn.words.wording import N_, Sentence

ADDRESS = "/pairs"
OWN = ("list", "by", "fd", "all", "at", "more")
"""Parameters of the page itself; the others are those of the application."""

OF_MOTOR = ("nm", "Tm", "Tmn", "nmr", "Jm", "md", "Jr")
TYPED = ("Jr", "eta")
"""Inputs of the application that the page's own form has."""

RANKS: Mapping[PairRank, str] = {
    "weight": N_("mass of the pair"),
    "utilisation": N_("utilisation"),
    "inertia_ratio": N_("inertia ratio"),
    "resonance": N_("resonance, highest first"),
}
NO_CYCLE = N_("Pairs need an application: enter a duty cycle first.")
NO_RESONANCE = N_("The lowest resonance must be a number above 0.")
NO_RATIO = N_("The largest inertia ratio must be a number above 0.")
NO_INERTIA = N_("Inertia ratio and resonance need a motion, or the inertia of the load in the application.")


@dataclass(frozen=True)
class Asked:
    """Contents of the address: the application's parameters, the page's own, and who the application belongs to."""

    place: str
    back: str
    form: Form
    carried: list[tuple[str, str]]
    own: Mapping[str, str]
    axis: AxisView | None = None

    @cached_property
    def ratio(self) -> float | Sentence | None:
        """Largest inertia ratio that is typed, a sentence for what is none; None where nothing is."""
        text = dict(self.carried).get("Jr", "").strip()
        return positive(text, NO_RATIO) if text else None

    @cached_property
    def application(self) -> Application | None:
        """The application with that bound in place of a motor; None where it can't be read."""
        application = self.form.application if not self.form.problems else None
        if application is None or self.ratio is None or isinstance(self.ratio, Sentence):
            return application
        motor = Motor(inertia_ratio=self.ratio)
        requirements = application.requirements.model_copy(update={"motor": motor})
        return application.model_copy(update={"requirements": requirements})

    def link(self, **more: str) -> str:
        """Address of the page with other parameters of its own."""
        own = {name: text for name, text in {**self.own, **more}.items() if text}
        return f"{self.place}?{urlencode([*self.carried, *own.items()])}"


@or_reason(REASON)
async def show_pairs(request: Request) -> Response:
    """Pairs for the application of the address."""
    return await _shown(request, await compute(request, "pages", _asked, request.url.query))


def _asked(query: str) -> Asked:
    pairs = pairs_of(query)
    carried = [pair for pair in pairs if pair[0] not in OWN]
    form = link_reader.parse(_read_alone(carried))
    return Asked(ADDRESS, f"/?{urlencode(carried)}", form, carried, dict(p for p in pairs if p[0] in OWN))


@or_reason(REASON)
async def show_axis_pairs(request: Request) -> Response:
    """Pairs for an axis of a machine, as it is stored or as the address says."""
    machine, axis = await axis_of(request, request.path_params["id"], number_of(request))
    around = await neighbours(request, machine, axis)

    def read() -> Asked:
        pairs = pairs_of(request.url.query)
        carried = [pair for pair in pairs if pair[0] not in OWN]
        form, view = view_of(machine, axis, around, _read_alone(carried), request.app.state.catalogue)
        own = dict(pair for pair in pairs if pair[0] in OWN)
        kept = carried or list(view.typed)
        return Asked(f"{view.place}/pairs", view.place, form, kept, own, view)

    return await _shown(request, await compute(request, "pages", read))


def _read_alone(pairs: Sequence[tuple[str, str]]) -> list[tuple[str, str]]:
    """Parameters of an application without a motor of its own, whose place those of the list take."""
    return [(name, _plain(text) if name in TYPED else text) for name, text in pairs if name not in OF_MOTOR]


def _plain(text: str) -> str:
    """A number as people type it, in plain notation."""
    return text.strip().replace(",", ".")


async def _shown(request: Request, asked: Asked) -> Response:
    state = request.app.state
    lines = await motor_lists.lines_of(request)
    first = SERVER if state.catalogue.motors else lines[0].id if lines else ""
    id = asked.own.get("list") or first
    motors: list[MotorEntry] = []
    problems = list[Sentence]()
    if id:
        try:
            motors = await motor_lists.motors_of(request, id)
        except InputError as error:
            problems += [sentence for _, sentence in error.sentences]
    return await compute(request, "pages", _page, request, asked, lines, id, motors, problems)


def _page(
    request: Request,
    asked: Asked,
    lines: list[MotorListLine],
    id: str,
    motors: list[MotorEntry],
    problems: list[Sentence],
) -> Response:
    catalogue, view, application = request.app.state.catalogue, None, asked.application
    text = asked.own.get("fd", "").strip()
    least = positive(text, NO_RESONANCE) if text else None
    wrong = asked.form.problems if asked.carried else ()
    problems += _problems_of(asked, least)
    if application is not None and motors and not problems:
        by = asked.own.get("by", "weight")
        view = PairsView(
            application,
            motors,
            catalogue,
            _links(asked),
            next((rank for rank in RANKS if rank == by), "weight"),
            least if isinstance(least, float) else None,
            bool(asked.own.get("all")),
            MOST_SHOWN if asked.own.get("more") else SHOWN,
            _marked(asked.own.get("at", "")),
        )
        try:
            _ = view.table
        except InputError as error:
            view, problems = None, [*problems, *(sentence for _, sentence in error.sentences)]
    shown: dict[str, Any] = {
        "asked": asked,
        "lines": lines,
        "server": len(catalogue.motors),
        "id": id,
        "view": view,
        "ranks": RANKS,
        "problems": problems,
        "typed": TYPED,
        "draft": MotorUpload(link=urlencode(asked.carried) if asked.axis is None else ""),
        "roles": MOTORS.by_role,
    }
    return page(request, "pairs.html", 422 if wrong else 200, **shown)


def _problems_of(asked: Asked, least: float | Sentence | None) -> list[Sentence]:
    """Problems of an application and the bounds of its pairs; none on a page that is opened without one."""
    problems = [one for one in (least, asked.ratio) if isinstance(one, Sentence)]
    problems += [problem.message for problem in asked.form.problems if asked.carried]
    application = asked.application
    if application is None and not problems:
        return [Sentence(NO_CYCLE)]
    needs = (least is not None or asked.ratio is not None) and not problems
    if needs and application and not application.duty_cycle.motion and not application.requirements.load_inertia_kgm2:
        problems.append(Sentence(NO_INERTIA))
    return problems


def positive(text: str, template: str) -> float | Sentence:
    """A number above 0, or the sentence of a template for any other text."""
    value = read_value(_plain(text), "number")
    return Sentence(template) if isinstance(value, Sentence) or not 0 < float(value) < 1e9 else float(value)


def _marked(text: str) -> tuple[str, str]:
    gear, _, motor = text.partition(" ")
    return gear, motor


def _links(asked: Asked) -> Callable[[Application, str], str | None]:
    """Links of pairs, to the selection or back to the axis; none where one is too long."""
    write = asked.axis.link if asked.axis else to_link

    def link(application: Application, gear: str) -> str | None:
        address = f"{write(application)}&gear={gear}"
        return address if len(address) <= 2 * LONGEST_LINK else None

    return link


router = APIRouter(include_in_schema=False)
router.add_api_route(ADDRESS, show_pairs, dependencies=[admit("calculator")])
router.add_api_route("/machines/{id}/axes/{number}/pairs", show_axis_pairs, dependencies=[admit("reading")])
