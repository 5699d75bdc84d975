"""The report as data: every text in the reader's language, every number as it is printed. The template only sets it."""

import re
from io import BytesIO
from typing import Any

import segno

from hpn.engine.notices import on_motor_torques
from hpn.files.export import Export
from hpn.files.inputs import LOADS, REQUIREMENTS
from hpn.files.motion import MOTION_TITLE, MOVES_TITLE, PHASES_TITLE
from hpn.files.report import plots, tables
from hpn.files.report.listing import listing, moves
from hpn.files.report.steps import steps
from hpn.files.report.verdict import alternatives, checks, verdict
from hpn.files.words import catalogue_version, paper
from hpn.words.reader import NOTHING, Reader
from hpn.words.symbols import sentence
from hpn.words.wording import N_

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
    "loads": N_("Pause, emergency stop and loads"),
    "requirements": N_("Requirements"),
    "phases": N_("Duty cycle"),
    "phases_of_motion": PHASES_TITLE,
    "motion": MOTION_TITLE,
    "moves": MOVES_TITLE,
    "derived": N_("Figures of the cycle and the gear"),
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
    "demand": N_("Demand"),
    "limit": N_("Limit"),
    "utilisation": N_("Utilisation"),
    "verdict": N_("Verdict"),
    "source": N_("Source"),
    "open": N_("Open"),
    "page": N_("Page {page} of {pages}"),
    "bars": N_("A bar’s full width is 150 %; the stroke marks what is acceptable."),
    "disclaimer": N_(
        "Made by an independent tool from the maker’s engineering data. Check the selection with the maker before you "
        "order."
    ),
    "too_long_link": N_("The link is too long to print; it carries every phase."),
    "unprintable": N_("□ stands for characters that the report’s fonts lack: {codes}."),
    "calculation": N_("Calculation of {gear}"),
    "digits": N_(
        "Numbers to nine digits, so that each line can be checked from the one before; this tool rounds nothing in "
        "between."
    ),
    "each_phase": N_("Each phase of the duty cycle"),
    "each_move": N_("Each move of the motion"),
}

UNSAVED = {
    "whole": N_("Not saved: the link carries every input."),
    "code": N_("Not saved: the link is shortened in print; the code carries every input."),
    "shortened": N_("Not saved: the link is shortened in print, only a click opens it. Saving gives a short address."),
    "none": N_("Not saved. Saving gives a short address."),
}
"""Notes on where the inputs of an unsaved selection stand, by the part of its link that is on paper."""

CAVEATS = (
    N_("Lives are hours of operation of the whole cycle, its pause included."),
    N_(
        "L10: 90 % survive; L50: 50 % survive. Equation 17.10 calls its result L10, while the "
        "glossary describes the rated torque on a basis of 50 % failures; the handbook does not settle which holds."
    ),
)
"""Notes on the figures of cycle and gear, by the place of the figure."""


def content(export: Export, reader: Reader) -> dict[str, Any]:
    """Everything that the template sets, as JSON-ready data."""
    text, selection = reader.text, export.selection
    labels = {key: text(label) for key, label in LABELS.items()}
    named, on_motor = ("checks", "ratings", "calculation"), reader.told(on_motor_torques(selection.notices))
    labels |= {key: labels[key].format(gear=export.candidate.designation) for key in named}
    labels["unsaved"] = text(UNSAVED[_carrier(export.link)])
    return {
        "lang": reader.language,
        "paper": paper(reader),
        "labels": labels,
        "title": _shortened(export.heading.title.strip() or labels["untitled"], LONGEST_TITLE),
        "author": export.heading.author.strip(),
        "block": _block(export, reader),
        "saved": export.created is not None,
        **_link(export.link),
        "verdict": verdict(export, reader),
        "loads": tables.given(export, LOADS, reader),
        "requirements": tables.given(export, REQUIREMENTS, reader),
        "motion": tables.motion(export, reader),
        "phases": tables.phases(export, reader),
        "move_listing": moves(export, reader),
        "listing": listing(export, reader),
        "derived": tables.derived(export, reader),
        "caveats": [*(sentence(text(caveat)) for caveat in CAVEATS), sentence(on_motor)],
        "cycle": {"panels": plots.cycle(export, reader), "alt": text(N_("Torque and speed of the cycle over time"))},
        "course": plots.motion(export, reader),
        "planes": plots.planes(export, reader, on_motor),
        "bearing": plots.envelope(export, reader),
        "bearing_alt": text(N_("Loads of the phases within the envelopes of the output bearing")),
        "checks": checks(export, reader),
        "ratings": tables.ratings(export, reader),
        "alternatives": alternatives(export, reader),
        "steps": steps(export, reader),
        "notices": [sentence(reader.told(notice.sentence)) for notice in selection.notices],
        "versions": [
            [text(N_("Engine")), selection.engine_version],
            [text(N_("Catalogue")), catalogue_version(export, reader)],
        ],
    }


def _block(export: Export, reader: Reader) -> list[list[str]]:
    """Fields of the title block below the title; one that nobody filled in has a dash."""
    heading, made = export.heading, export.made
    dated = reader.date(export.created) if export.created else reader.day(made) if made else ""
    fields = {
        N_("Reference"): heading.reference,
        N_("Revision"): heading.revision,
        N_("Author"): heading.author,
        N_("Saved") if export.created else N_("Date"): dated,
        N_("Ordering code"): heading.ordering_code,
    }
    return [
        [reader.text(label), _shortened(value.strip(), LONGEST_TITLE) or NOTHING] for label, value in fields.items()
    ]


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


def _carrier(link: str) -> str:
    """Carrier of the inputs on paper, as a key of UNSAVED."""
    if len(link) <= LONGEST_PRINTED_LINK:
        return "whole"
    if len(link) <= LONGEST_QR_LINK:
        return "code"
    return "shortened" if len(link) <= LONGEST_LINK else "none"


def _qr(link: str) -> str:
    """QR code as an SVG drawing."""
    drawing = BytesIO()
    segno.make(link, error="m", micro=False).save(drawing, kind="svg", border=0, xmldecl=False, svgclass=None)
    return drawing.getvalue().decode()
