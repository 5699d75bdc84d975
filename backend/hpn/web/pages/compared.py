"""Two saved selections side by side: inputs, results, and differences."""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import islice
from typing import Any

from fastapi import APIRouter
from pydantic import ValidationError
from starlette.requests import Request
from starlette.responses import RedirectResponse, Response

from hpn.account.account import Account
from hpn.account.published import ranged
from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.candidates import Candidate
from hpn.explain.comparison import NumberedRow, Row, checks_of, is_same, numbered_rows, rows_of
from hpn.store import SavedSelection
from hpn.web.archive import answer_of, with_catalogue
from hpn.web.door.access import admit
from hpn.web.door.pools import compute
from hpn.web.door.problems import Problem
from hpn.web.form.linked import onward
from hpn.web.pages.rendering import or_reason, page
from hpn.web.pages.result import Result
from hpn.web.pages.saved import result_of
from hpn.web.pages.saving import REASON

MOST_ROWS = 50
"""Maximum of differing phases or moves that are shown."""


@dataclass(frozen=True, slots=True)
class SavedSide:
    """Saved selection, and its result for the gear that its page shows first."""

    saved: SavedSelection
    result: Result

    @property
    def chosen(self) -> Candidate:
        """Candidate that the selection's page shows first."""
        return self.result.chosen


@or_reason(REASON)
async def compare_selections(request: Request) -> Response:
    """Page of two saved selections side by side; `id` twice, from a form with boxes, redirects to `a` and `b`."""
    query = request.query_params
    marked = query.getlist("id")
    if len(marked) == 2:
        return RedirectResponse(onward("/selections/compare", a=marked[0], b=marked[1]), 303)
    ids = [query.get("a", ""), query.get("b", "")]
    if marked or not all(ids):
        return await _page(request, 422, {"missing": [], "sides": [], "marked": len(marked)})
    sides: list[tuple[SavedSelection, Catalogue | None]] = []
    missing = []
    for place, id in zip("AB", ids, strict=True):
        try:
            sides.append(await with_catalogue(request.app.state, id))
        except Problem:
            missing.append(place)
    if missing:
        sides_saved = [saved for saved, _ in sides]
        return await _page(request, 404, {"missing": missing, "sides": [], "left": sides_saved, "marked": 2})
    return await _page(request, 200, {"missing": [], "pair": sides})


def _side(saved: SavedSelection, catalogue: Catalogue | None) -> SavedSide:
    try:
        application: Application | None = Application.model_validate_json(saved.application)
    except ValidationError:
        application = None
    return SavedSide(saved, result_of(saved, answer_of(saved), application, catalogue))


def _compared(a: SavedSide, b: SavedSide) -> dict[str, Any]:
    one, other = a.result.account, b.result.account
    return {
        "sides": (a, b),
        "known": bool(a.result.application and b.result.application),
        "used_alike": is_same(a.chosen.utilisation, b.chosen.utilisation),
        "inputs": _inputs(one, other),
        "moves": _first(numbered_rows(one.moves, other.moves)),
        "phases": _first(numbered_rows(one.phases, other.phases)),
        "most_rows": MOST_ROWS,
        "checks": checks_of(one, other),
        "figures": [row for row in rows_of(*([*each.cycle, *each.figures] for each in (one, other))) if row.is_known],
        "published": [row for row in rows_of(*(ranged(each.published) for each in (one, other))) if row.differs],
    }


def _inputs(one: Account, other: Account) -> list[Row]:
    """Differing inputs other than moves and phases."""
    if one.application is None or other.application is None:
        return []
    sides = ([*each.loads, *each.requirements, *each.mechanism] for each in (one, other))
    return [row for row in rows_of(*sides) if row.differs]


def _first(rows: Iterable[NumberedRow]) -> list[NumberedRow]:
    """Rows to show, plus one if there are more."""
    return list(islice(rows, MOST_ROWS + 1))


async def _page(request: Request, status: int, values: dict[str, Any]) -> Response:
    def work() -> Response:
        compared = _compared(*(_side(*one) for one in values["pair"])) if "pair" in values else {}
        return page(request, "compared.html", status, **values | compared)

    return await compute(request, "pages", work)


router = APIRouter(include_in_schema=False, dependencies=[admit("reading")])
router.add_api_route("/selections/compare", compare_selections)
