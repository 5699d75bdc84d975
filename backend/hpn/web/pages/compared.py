"""Two saved selections side by side: what was asked, what came of it, and where they differ."""

from collections.abc import Iterable, Iterator
from dataclasses import astuple, dataclass
from itertools import islice, zip_longest
from typing import Any

from fastapi import APIRouter
from msgspec import structs
from pydantic import ValidationError
from starlette.requests import Request
from starlette.responses import RedirectResponse, Response

from hpn.account.inputs import LOADS, REQUIREMENTS, InputLine, given
from hpn.account.motion import lines, move_line
from hpn.account.readings import Reading, figure_symbol
from hpn.application import Application
from hpn.application.phase import Phase
from hpn.catalogue import Catalogue
from hpn.engine.candidates import FIGURES, Candidate, CheckResult
from hpn.engine.check import Check
from hpn.engine.checks import BY_CODE
from hpn.explain.differences import is_same
from hpn.store import SavedSelection
from hpn.web.archive import answer_of, with_catalogue
from hpn.web.door.access import admit
from hpn.web.door.pools import compute
from hpn.web.door.problems import Problem
from hpn.web.door.visit import current
from hpn.web.form.linked import onward
from hpn.web.form.symbols import PHASE_SYMBOLS
from hpn.web.pages.gear_figures import Figure, all_figures
from hpn.web.pages.rendering import or_reason, page
from hpn.web.pages.result import Result
from hpn.web.pages.saved import result_of
from hpn.web.pages.saving import REASON
from hpn.words.quantities import CANDIDATE, DUTY, INPUTS
from hpn.words.units import symbol_of
from hpn.words.wording import N_, Named

PHASES_SHOWN = 50
"""Phases that differ of which so many are shown."""


@dataclass(frozen=True, slots=True)
class Side:
    """One of the two as saved, and the gear that its page shows first."""

    saved: SavedSelection
    result: Result

    @property
    def chosen(self) -> Candidate:
        """That gear, as it was judged."""
        return self.result.chosen


@dataclass(frozen=True, slots=True)
class Row:
    """One quantity of both; texts are in the reader's language, figures in the units of the wire."""

    named: Named
    values: tuple[Any, Any]
    unit: str = ""

    @property
    def differs(self) -> bool:
        """True for two different values; numbers are equal to rounding."""
        return not is_same(*self.values)


@dataclass(frozen=True, slots=True)
class CheckRow:
    """One check of both: its outcome and how that is read, None where it was not asked for."""

    check: Check
    sides: tuple[tuple[CheckResult, Reading] | None, tuple[CheckResult, Reading] | None]

    @property
    def differs(self) -> bool:
        """True for two different results; their figures are equal to rounding."""
        figures = [(*structs.astuple(side[0]), *astuple(side[1])) if side else () for side in self.sides]
        return len(figures[0]) != len(figures[1]) or not all(map(is_same, *figures))


Cells = list[tuple[float | str, str]]
"""Figures of a phase, each with the suffix of its unit, and its name."""


@dataclass(frozen=True, slots=True)
class PhaseRow:
    """One phase that differs: its number, and its figures on both sides, none where there is no such phase."""

    number: int
    sides: tuple[Cells, Cells]


@or_reason(REASON)
async def compare_selections(request: Request) -> Response:
    """Two saved selections side by side; `id` twice, as a form with boxes sends it, leads to `a` and `b`."""
    query = request.query_params
    marked = query.getlist("id")
    if len(marked) == 2:
        return RedirectResponse(onward("/selections/compare", a=marked[0], b=marked[1]), 303)
    ids = [query.get("a", ""), query.get("b", "")]
    if marked or not all(ids):
        return await _rendered(request, 422, {"missing": [], "sides": [], "marked": len(marked)})
    found: list[tuple[SavedSelection, Catalogue | None]] = []
    missing = []
    for place, id in zip("AB", ids, strict=True):
        try:
            found.append(await with_catalogue(request.app.state, id))
        except Problem:
            missing.append(place)
    if missing:
        left = [saved for saved, _ in found]
        return await _rendered(request, 404, {"missing": missing, "sides": [], "left": left, "marked": 2})
    return await _rendered(request, 200, {"missing": [], "found": found})


def _side(saved: SavedSelection, catalogue: Catalogue | None) -> Side:
    try:
        application: Application | None = Application.model_validate_json(saved.application)
    except ValidationError:
        application = None
    return Side(saved, result_of(saved, answer_of(saved), application, catalogue))


def _compared(a: Side, b: Side) -> dict[str, Any]:
    return {
        "sides": (a, b),
        "known": bool(a.result.application and b.result.application),
        "used_alike": is_same(a.chosen.utilisation, b.chosen.utilisation),
        "inputs": list(_inputs(a, b)),
        "phases": list(islice(_phases(a, b), PHASES_SHOWN + 1)),
        "most_phases": PHASES_SHOWN,
        "checks": list(_checks(a, b)),
        "figures": list(_figures(a, b)),
        "published": list(_published(a, b)),
    }


def _inputs(a: Side, b: Side) -> Iterator[Row]:
    """Inputs beside the phases that differ."""
    for path in (*LOADS, *REQUIREMENTS):
        found = [_line(side.result.application, path) for side in (a, b)]
        line = found[0] or found[1]
        if line is not None and found[0] != found[1]:
            yield Row(Named(line.label, line.symbol), _pair(line and line.text for line in found))
    yield from _motions(a, b)


def _motions(a: Side, b: Side) -> Iterator[Row]:
    """Differences of mechanism and moves."""
    given = [side.result.application.duty_cycle.motion if side.result.application else None for side in (a, b)]
    said = [{(line.label, line.symbol): line.text for line in lines(one, current())} if one else {} for one in given]
    for label, symbol in said[0] | said[1]:
        texts = _pair(one.get((label, symbol)) for one in said)
        if texts[0] != texts[1]:
            yield Row(Named(label, symbol), texts)
    moves = ([move_line(one, k, current()) for k in range(len(one.moves))] if one else [] for one in given)
    different = ((number, pair) for number, pair in enumerate(zip_longest(*moves), 1) if pair[0] != pair[1])
    for number, pair in islice(different, PHASES_SHOWN):
        yield Row(Named(f"{current().text(N_('Move'))} {number}"), _pair(pair))


def _line(application: Application | None, path: str) -> InputLine | None:
    return next(iter(given(application, (path,), current())), None) if application else None


def _phases(a: Side, b: Side) -> Iterator[PhaseRow]:
    """Phases that differ."""
    cycles = [side.result.application.duty_cycle.load_phases if side.result.application else () for side in (a, b)]
    for number, phases in enumerate(zip_longest(*cycles), 1):
        if phases[0] != phases[1]:
            yield PhaseRow(number, _pair(list(_cells(phase)) for phase in phases))


def _cells(phase: Phase | None) -> Iterator[tuple[float | str, str]]:
    for symbol in PHASE_SYMBOLS if phase else ():
        value: float | str | None = getattr(phase, symbol.path[0])
        if value is not None:
            yield value, symbol.unit


def _checks(a: Side, b: Side) -> Iterator[CheckRow]:
    """Checks that one or the other has, in the order of all checks."""
    readings = a.result.readings, b.result.readings
    for code, check in BY_CODE.items():
        found = [side.chosen.check(code) for side in (a, b)]
        if any(found):
            sides = (result and (result, own[code]) for result, own in zip(found, readings, strict=True))
            yield CheckRow(check, _pair(sides))


def _figures(a: Side, b: Side) -> Iterator[Row]:
    """Figures of the cycle and of the gear under it."""
    for name, named in DUTY.items():
        yield Row(named, _pair(getattr(side.result.selection.duty, name) for side in (a, b)), symbol_of(name))
    inertias = _pair(side.result.selection.duty.load_inertia_kgm2 for side in (a, b))
    if inertias != (None, None):
        yield Row(INPUTS["requirements.load_inertia_kgm2"], inertias, symbol_of("load_inertia_kgm2"))
    turns = any(side.result.selection.turns_motor for side in (a, b))
    for name in FIGURES:
        named = Named(CANDIDATE[name].name, figure_symbol(name, turns_motor=turns))
        row = Row(named, _pair(_figure(side.chosen, name) for side in (a, b)), symbol_of(name))
        if row.values != (None, None):
            yield row


def _figure(candidate: Candidate, name: str) -> float | str | None:
    if candidate.is_unlimited(name):
        return current().text(N_("unlimited"))
    value: float | None = getattr(candidate, name)
    return value


def _published(a: Side, b: Side) -> Iterator[tuple[Figure | None, Figure | None]]:
    """Published figures of the two gears that differ, each by the catalogue of its time."""
    for pair in zip_longest(all_figures(a.result.gear), all_figures(b.result.gear)):
        before, after = (figure and figure.values for figure in pair)
        if before != after:
            yield pair


def _pair(values: Iterable[Any]) -> tuple[Any, Any]:
    first, second = values
    return first, second


async def _rendered(request: Request, status: int, shown: dict[str, Any]) -> Response:
    def work() -> Response:
        compared = _compared(*(_side(*one) for one in shown["found"])) if "found" in shown else {}
        return page(request, "compared.html", status, **shown | compared)

    return await compute(request, "pages", work)


router = APIRouter(include_in_schema=False, dependencies=[admit("reading")])
router.add_api_route("/selections/compare", compare_selections)
