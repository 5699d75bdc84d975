"""Report as data: every text in the reader's language, every number as printed. The template only sets it in type."""

import re
from collections.abc import Mapping
from datetime import datetime
from io import BytesIO
from typing import Any

import segno

from hpn.account.inputs import MOTION_TITLE, MOVES_TITLE, PHASES_TITLE
from hpn.engine.notices import on_motor_torques
from hpn.files.export import Export, ExportTitle
from hpn.files.report import plots, tables
from hpn.files.report.checks import bases, checks
from hpn.files.report.listing import listing
from hpn.files.report.over_tolerance import tolerances
from hpn.files.report.verdict import alternatives, verdict
from hpn.files.words import catalogue_version, paper
from hpn.words.reader import NOTHING, Reader
from hpn.words.symbols import sentence
from hpn.words.wording import N_

LONGEST_TITLE, LONGEST_HEAD = 160, 60
LONGEST_QR_LINK = 600
LONGEST_LINK = 2000
"""Longest link on paper: PDF readers open no longer address, and nobody types one."""

_TURNING = re.compile("[\u202a-\u202e\u2066-\u2069]")
"""Characters that turn the direction of the text after them."""

LABELS = {
    "product": N_("HPN Select"),
    "heading": N_("Gear selection report"),
    "untitled": N_("Untitled selection"),
    "title": N_("Title"),
    "checked": N_("Checked"),
    "approved": N_("Approved"),
    "sign": N_("name, date, signature"),
    "largest": N_("Largest utilisation"),
    "governs": N_("decides"),
    "given": N_("Loads and requirements"),
    "phases": N_("Duty cycle"),
    "phases_of_motion": PHASES_TITLE,
    "motion": MOTION_TITLE,
    "moves": MOVES_TITLE,
    "derived": N_("Figures of the cycle and the gear"),
    "cycle": N_("Torque and speed over one cycle"),
    "bearing": N_("Load on the output shaft"),
    "checks": N_("Checks of {gear}"),
    "ratings": N_("Published figures of {gear}"),
    "alternatives": N_("Candidates"),
    "basis": N_("Assumptions"),
    "notices": N_("Notices"),
    "equation": N_("Eq."),
    "bars": N_("0 to 150 %"),
    "phase": N_("Phase"),
    "utilisation": N_("Utilisation"),
    "open": N_("Open"),
    "page": N_("Page {page} of {pages}"),
    "disclaimer": N_(
        "Made by an independent tool from the manufacturer’s engineering data. Check with the manufacturer before "
        "ordering."
    ),
    "too_long_link": N_("The link is too long to print; it carries every phase."),
    "unprintable": N_("□ stands for characters that the report’s fonts lack: {codes}."),
    "digits": N_("Page 17 of the handbook, to nine digits; nothing is rounded in between"),
    "each_phase": N_("Each phase of the duty cycle"),
    "each_move": N_("Each move of the motion"),
}

LINK = {
    "saved": N_("This selection as it was saved"),
    "whole": N_("This selection, to open and to change"),
    "too long": N_("Not saved, and the link is too long to print. Save the selection to get a short address."),
}
CARRIED = N_("Not saved: the link carries every input.")

LIVES = N_("Hours of operation of the whole cycle, its pause included. L10: 90 % survive; L50: 50 % survive.")


def content(export: Export, reader: Reader) -> dict[str, Any]:
    """Data of the template, ready for JSON."""
    title = shortened(export.heading.title.strip() or reader.text(LABELS["untitled"]), LONGEST_TITLE)
    head = running_head(export.heading, export.selection.engine_version, catalogue_version(export, reader), reader)
    return frame(export.heading, reader) | {
        "title": title,
        "head": [shortened(title, LONGEST_HEAD), head],
        "block": block(export.heading, reader, export.created, export.moment),
        "saved": export.created is not None,
        **link_of(export.link, reader, is_saved=export.created is not None),
        **parts(export, reader),
    }


def frame(heading: ExportTitle, reader: Reader) -> dict[str, Any]:
    """Language, paper, labels and author of a report."""
    labels = {key: reader.text(label) for key, label in LABELS.items()}
    return {"lang": reader.language, "paper": paper(reader), "labels": labels, "author": heading.author.strip()}


def parts(export: Export, reader: Reader) -> dict[str, Any]:
    """Data of the selection itself."""
    selection, account = export.selection, export.account
    on_motor, pictures = reader.sentence(on_motor_torques(selection.notices)), plots.pictures_of(export, reader)
    return inputs(export, reader) | {
        "titles": titles(export, reader),
        "verdict": verdict(export, reader),
        "move_listing": listing(account.moves, reader),
        "listing": listing(account.phases, reader),
        "derived": tables.derived(account, reader),
        "cycle": plots.cycle(export, pictures, reader),
        "planes": plots.planes(export, pictures, reader, on_motor),
        "bearing": plots.envelope(pictures, reader),
        "bearing_alt": reader.text(N_("Loads of the phases within the envelopes of the output bearing")),
        "checks": checks(export, reader),
        "tolerances": tolerances(export, reader),
        "ratings": tables.lines(account.published, reader),
        "alternatives": alternatives(export, reader),
        "basis": _basis(export, reader, on_motor),
        "notices": [sentence(reader.sentence(notice.sentence)) for notice in selection.notices],
    }


def titles(export: Export, reader: Reader) -> dict[str, str]:
    """Titles with the gear's designation."""
    return {key: reader.text(LABELS[key]).format(gear=export.candidate.designation) for key in ("checks", "ratings")}


def inputs(export: Export, reader: Reader) -> dict[str, Any]:
    """Loads, requirements, motion and phases."""
    account = export.account
    return {
        "loads": tables.lines(account.loads, reader),
        "requirements": tables.lines(account.requirements, reader),
        "motion": tables.motion(account, reader),
        "phases": tables.phases(account, reader),
    }


def _basis(export: Export, reader: Reader, on_motor: str) -> list[tuple[str, Any]]:
    """Assumptions by their subjects: bases of the checks, and notes on lives and motor torques."""
    text = reader.text
    lives, torques = (text(N_("Lives")), sentence(text(LIVES))), (text(N_("Motor torques")), sentence(on_motor))
    return [*bases(export, reader), lives, torques]


def running_head(heading: ExportTitle, engine: str, catalogue: str, reader: Reader) -> str:
    """Running head: reference and revision, then the versions of engine and catalogue."""
    text = reader.text
    revision = f"{text(N_('Revision'))} {heading.revision.strip()}" if heading.revision.strip() else ""
    own = ", ".join(filter(None, (heading.reference.strip(), revision)))
    versions = f"{text(N_('Engine'))} {engine}, {text(N_('Catalogue'))} {catalogue}"
    return " · ".join(filter(None, (shortened(own, LONGEST_HEAD), versions)))


def block(
    heading: ExportTitle, reader: Reader, created: datetime | None, moment: datetime | None
) -> dict[str, list[str]]:
    """Fields of the title block: label and text; a dash for an empty field."""
    dated = reader.date(created) if created else reader.day(moment) if moment else ""
    fields = {
        "reference": (N_("Reference"), heading.reference),
        "revision": (N_("Revision"), heading.revision),
        "author": (N_("Author"), heading.author),
        "date": (N_("Saved") if created else N_("Date"), dated),
    }
    return {
        name: [reader.text(label), shortened(value.strip(), LONGEST_TITLE) or NOTHING]
        for name, (label, value) in fields.items()
    }


def shortened(text: str, most: int) -> str:
    """Text in one line of at most `most` characters, without marks that turn its direction."""
    plain = " ".join(_TURNING.sub("\N{REPLACEMENT CHARACTER}", text).split())
    return plain if len(plain) <= most else plain[: most - 1] + "…"


def link_of(
    link: str, reader: Reader, *, is_saved: bool, notes: Mapping[str, str] = LINK, carried: str = CARRIED
) -> dict[str, Any]:
    """Link and its QR code, each where paper carries it whole, and a note on both."""
    carrier = "too long" if len(link) > LONGEST_LINK else "saved" if is_saved else "whole"
    return {
        "link": "" if carrier == "too long" else link,
        "link_note": reader.text(notes[carrier]),
        "link_hint": reader.text(carried) if carrier == "whole" else "",
        "qr": qr_code(link) if 0 < len(link) <= LONGEST_QR_LINK else "",
    }


def qr_code(link: str) -> str:
    """QR code of a link as an SVG drawing that fills its room, for the report and for a printed page."""
    drawing = BytesIO()
    code = segno.make(link, error="m", micro=False)
    code.save(drawing, kind="svg", border=0, xmldecl=False, svgclass=None, lineclass=None, omitsize=True)
    return drawing.getvalue().decode()
