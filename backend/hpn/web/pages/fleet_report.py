"""Report of a fleet as one HTML file with styles and a script inside."""

from collections.abc import Iterable
from contextvars import copy_context
from typing import Any

from jinja2 import Environment
from markupsafe import Markup
from starlette.datastructures import State

from hpn import ENGINE_VERSION
from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.fleet.listing import Listing, applications_of, rows_of
from hpn.links.labels import query_of
from hpn.links.writer import to_link
from hpn.web.door.access import MAXIMUM_QUERY_BYTES
from hpn.web.door.visit import VISIT, Visit
from hpn.web.pages.assets import DIST, Assets
from hpn.web.pages.fleet_view import COLUMNS, FleetView, by_need, foremost, weights_of
from hpn.web.pages.templates import environment
from hpn.words.reader import Reader
from hpn.words.titles import faults_of

STYLE, SCRIPT = "report.css", "fleet-report.js"


def report_of(listing: Listing, name: str, catalogue: Catalogue, base: str = "", language: str = "en") -> str:
    """HTML file in a language.

    `base` is the address of the service for its links, blank if unknown.
    """
    rows, summary = rows_of(listing.answers), listing.summary
    top = foremost(rows) if len(rows) == summary.axes else None
    places = {row.axis: row.place for row in rows}
    applications = [(places[axis], axis, application) for axis, application in applications_of(listing.axes)]
    view = FleetView(
        summary, by_need(rows), links_of(applications, base), allowed_of(applications), top, weights_of(catalogue)
    )
    return copy_context().run(
        _sentence, Reader(language), view=view, name=name, base=base, catalogue_version=catalogue.version
    )


def _sentence(reader: Reader, **values: Any) -> str:
    VISIT.set(Visit(reader, values["base"]))
    return (
        _environment()
        .get_template("fleet_report.html")
        .render(values, columns=COLUMNS, style=_inlined(STYLE), script=_inlined(SCRIPT), engine_version=ENGINE_VERSION)
    )


Placed = tuple[int, str, Application]
"""Place of an axis in its list, its name, and its application."""


def links_of(axes: Iterable[Placed], base: str = "") -> dict[int, str]:
    """Links of axes by their places, with the name as title if valid; without links too long for an address."""
    links = ((place, to_link(application) + _titled(name)) for place, name, application in axes)
    return {place: base + link for place, link in links if len(link) <= MAXIMUM_QUERY_BYTES}


def allowed_of(axes: Iterable[Placed]) -> dict[int, float]:
    """Permitted utilisation by place, for axes that require less than 1."""
    bounds = ((place, application.requirements.utilisation) for place, _, application in axes)
    return {place: allowed for place, allowed in bounds if allowed < 1}


def _titled(axis: str) -> str:
    return "" if any(faults_of(axis)) else query_of({"title": axis})


def _environment() -> Environment:
    state = State()
    state.assets = Assets(DIST, {})  # the file itself contains all assets
    return environment(state)


def _inlined(name: str) -> Markup:
    assets = Assets.load()
    return Markup(assets.text(assets.folder / assets.manifest[name]).decode())
