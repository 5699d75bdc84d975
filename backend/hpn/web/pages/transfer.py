"""The application as files: JSON as the API takes it, and the duty cycle as CSV for a spreadsheet."""

from typing import cast
from urllib.parse import urlencode

from fastapi import APIRouter
from starlette.requests import Request
from starlette.responses import Response

from hpn.application import Application
from hpn.web.door.access import admit
from hpn.web.door.bodies import pairs_of
from hpn.web.door.pools import compute
from hpn.web.door.problems import Problem
from hpn.web.door.uploads import read_fields
from hpn.web.form.pasted import Decimal, write_table
from hpn.web.pages.calculator import read_query


async def application_file(request: Request) -> Response:
    """The application of a link as JSON: the body of `POST /api/v1/select`."""
    return await compute(request, "pages", _json_of, await _query(request))


def _json_of(query: str) -> Response:
    application, _ = _read(query)
    return _file(application.model_dump_json(indent=2, exclude_unset=True), "application.json", "application/json")


async def cycle_file(request: Request) -> Response:
    """The duty cycle of a link as CSV; `decimal=,` writes it as spreadsheets in German expect it."""
    return await compute(request, "pages", _csv_of, await _query(request))


def _csv_of(query: str) -> Response:
    application, decimal = _read(query)
    return _file(write_table(application.duty_cycle, decimal), "duty-cycle.csv", "text/csv")


async def _query(request: Request) -> str:
    """Query of a link, which a form posts where it is too long for an address."""
    if request.method != "POST":
        return request.url.query
    fields = await read_fields(request)
    query = fields.get("link", "").removeprefix("/?")
    return f"{query}&{urlencode({'decimal': fields['decimal']})}" if "decimal" in fields else query


def _read(query: str) -> tuple[Application, Decimal]:
    pairs = pairs_of(query)
    decimal = dict(pairs).get("decimal", ".")
    if decimal not in (".", ","):
        raise Problem(422, "decimal is a point or a comma", [(("decimal",), "must be . or ,")])
    form = read_query(urlencode([pair for pair in pairs if pair[0] != "decimal"]).encode())
    if form.application is None:
        errors = [((problem.name,), problem.message.text) for problem in form.problems]
        raise Problem(422, "; ".join(f"{name}: {text}" for (name,), text in errors) or "no phase is given", errors)
    return form.application, cast(Decimal, decimal)


def _file(content: str, name: str, media_type: str) -> Response:
    headers = {"Content-Disposition": f'attachment; filename="{name}"', "Cache-Control": "no-cache"}
    return Response(content, media_type=media_type, headers=headers)


router = APIRouter(include_in_schema=False, dependencies=[admit("calculator")])
router.add_api_route("/application.json", application_file, methods=["GET", "POST"])
router.add_api_route("/cycle.csv", cycle_file, methods=["GET", "POST"])
