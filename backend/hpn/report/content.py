"""The report as data: every text in the reader's language, every number as it is printed. The template only sets it."""

import re
from io import BytesIO
from typing import Any

import segno

from hpn.reader import Reader
from hpn.report import plots, tables
from hpn.report.export import Export
from hpn.report.inputs import LOADS, REQUIREMENTS
from hpn.report.listing import listing
from hpn.report.symbols import sentence
from hpn.report.verdict import alternatives, checks, verdict
from hpn.report.words import catalogue_version
from hpn.wording import N_

LONGEST_TITLE = 160
LONGEST_QR_LINK = 600
LONGEST_PRINTED_LINK = 240
LONGEST_LINK = 2000
"""Readers open no longer address from a document."""

_TURNING = re.compile("[\u202a-\u202e\u2066-\u2069]")
"""Characters that turn the direction of whatever follows them."""

LABELS = {
    "product": N_("HPN Select"),
    "heading": N_("Gear selection report"),
    "untitled": N_("Untitled selection"),
    "reference": N_("Reference"),
    "created": N_("Saved"),
    "loads": N_("Pause, emergency stop and loads"),
    "requirements": N_("Requirements"),
    "phases": N_("Duty cycle"),
    "derived": N_("What the cycle and the gear come to"),
    "cycle": N_("Torque and speed over one cycle"),
    "bearing": N_("Load on the output bearing"),
    "checks": N_("Checks of {gear}"),
    "ratings": N_("Published figures of {gear}"),
    "alternatives": N_("Alternatives"),
    "notices": N_("Assumptions and notes"),
    "basis": N_("Basis"),
    "versions": N_("Versions"),
    "check": N_("Check"),
    "relation": N_("Relation"),
    "demand": N_("Value"),
    "limit": N_("Limit"),
    "utilisation": N_("Utilisation"),
    "verdict": N_("Verdict"),
    "source": N_("Source"),
    "open": N_("Open"),
    "page": N_("Page {page} of {pages}"),
    "bars": N_("A bar's full width is 125 %; the stroke marks what is acceptable."),
    "disclaimer": N_(
        "Made by an independent tool from the maker's engineering data. Check the selection with the maker before you "
        "order."
    ),
    "unsaved": N_("Not saved: made from the link alone, therefore undated."),
    "too_long_link": N_("The link is too long to print; it carries every phase."),
    "unprintable": N_("□ stands for characters that the report's fonts lack: {codes}."),
    "each_phase": N_("Each phase of the duty cycle"),
}


def content(export: Export, reader: Reader) -> dict[str, Any]:
    """Everything that the template sets, as JSON-ready data."""
    text, selection = reader.text, export.selection
    labels = {key: text(label) for key, label in LABELS.items()}
    labels |= {key: labels[key].format(gear=export.candidate.designation) for key in ("checks", "ratings")}
    return {
        "lang": reader.language,
        "labels": labels,
        "title": _shortened(export.title.strip() or labels["untitled"], LONGEST_TITLE),
        "reference": _shortened(export.reference.strip(), LONGEST_TITLE),
        "created": reader.date(export.created) if export.created else "",
        **_link(export.link),
        "verdict": verdict(export, reader),
        "loads": tables.given(export, LOADS, reader),
        "requirements": tables.given(export, REQUIREMENTS, reader),
        "phases": tables.phases(export, reader),
        "listing": listing(export, reader),
        "derived": tables.derived(export, reader),
        "cycle": {"panels": plots.cycle(export, reader), "alt": text(N_("Torque and speed of the cycle over time"))},
        "bearing": plots.envelope(export, reader),
        "bearing_alt": text(N_("Loads of the phases within the envelopes of the output bearing")),
        "checks": checks(export, reader),
        "ratings": tables.ratings(export, reader),
        "alternatives": alternatives(export, reader),
        "notices": [sentence(reader.told(notice.sentence)) for notice in selection.notices],
        "versions": [
            [text(N_("Engine")), selection.engine_version],
            [text(N_("Catalogue")), catalogue_version(export, reader)],
        ],
    }


def _shortened(text: str, most: int) -> str:
    plain = " ".join(_TURNING.sub("\N{REPLACEMENT CHARACTER}", text).split())
    return plain if len(plain) <= most else plain[: most - 1] + "…"


def _link(link: str) -> dict[str, Any]:
    shown = link if len(link) <= LONGEST_PRINTED_LINK else link[: LONGEST_PRINTED_LINK - 1] + "…"
    target = link if len(link) <= LONGEST_LINK else ""
    return {
        "link": target,
        "link_text": shown if target else "",
        "qr": _qr(link) if len(link) <= LONGEST_QR_LINK else "",
    }


def _qr(link: str) -> str:
    """QR code as an SVG drawing."""
    drawing = BytesIO()
    segno.make(link, error="m", micro=False).save(drawing, kind="svg", border=0, xmldecl=False, svgclass=None)
    return drawing.getvalue().decode()
