"""Files of the application: JSON for the API, and the duty cycle as CSV for a spreadsheet."""

import csv
import io
from typing import cast

from fastapi import APIRouter
from starlette.requests import Request
from starlette.responses import Response

from hpn.application import Application, DutyCycle
from hpn.links.row_symbols import columns_used
from hpn.tables.cells import Decimal, harmless, written
from hpn.web.door.access import admit
from hpn.web.door.pools import compute
from hpn.web.door.problems import Problem
from hpn.web.form.linked import linked, query_of


async def application_file(request: Request) -> Response:
    """Application of a link as JSON: the body of `POST /api/v1/select`."""
    return await compute(request, "pages", _json_of, await query_of(request, "decimal"))


def _json_of(query: str) -> Response:
    application, _ = _application_of(query)
    return _file(application.model_dump_json(indent=2, exclude_unset=True), "application.json", "application/json")


async def cycle_file(request: Request) -> Response:
    """Duty cycle of a link as CSV; `decimal=,` writes it for German spreadsheets."""
    return await compute(request, "pages", _csv_of, await query_of(request, "decimal"))


def _csv_of(query: str) -> Response:
    application, decimal = _application_of(query)
    return _file(write_table(application.duty_cycle, decimal), "duty-cycle.csv", "text/csv")


def write_table(cycle: DutyCycle, decimal: Decimal = ".") -> str:
    """Phases, also those of a motion, as CSV that the page and a spreadsheet of that language read back exactly.

    A name that a spreadsheet would read as a formula gets an apostrophe before it.
    """
    fields = [symbol.path[0] for symbol in columns_used(cycle.load_phases)]
    content = io.StringIO()
    lines = csv.writer(content, delimiter=";" if decimal == "," else ",", lineterminator="\n")
    lines.writerow(fields)
    for phase in cycle.load_phases:
        lines.writerow(_cell(getattr(phase, name), decimal) for name in fields)
    return content.getvalue()


def _cell(value: float | str | None, decimal: Decimal) -> str | None:
    return harmless(value) if value is None or isinstance(value, str) else written(value).replace(".", decimal)


def _application_of(query: str) -> tuple[Application, Decimal]:
    link = linked(query, "decimal")
    decimal = link.options.get("decimal", ".")
    if decimal not in (".", ","):
        raise Problem(422, "decimal is a point or a comma", [(("decimal",), "must be . or ,")])
    return link.application, cast(Decimal, decimal)


def _file(content: str, name: str, media_type: str) -> Response:
    headers = {"Content-Disposition": f'attachment; filename="{name}"', "Cache-Control": "no-cache"}
    return Response(content, media_type=media_type, headers=headers)


router = APIRouter(include_in_schema=False, dependencies=[admit("calculator")])
router.add_api_route("/application.json", application_file, methods=["GET", "POST"])
router.add_api_route("/cycle.csv", cycle_file, methods=["GET", "POST"])
