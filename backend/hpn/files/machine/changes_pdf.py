"""Differences of two documents as PDF, axis by axis and cell by cell."""

from typing import Any

from hpn.documents.differences import DifferentAxis
from hpn.documents.revision import FrozenAxis
from hpn.files.machine.changes import (
    RESULT,
    DifferencesExport,
    cells_of,
    common_lines,
    effect,
    has_results,
    head_of,
    text_of,
    utilisation_text,
)
from hpn.files.machine.inputs import label_of
from hpn.files.machine.words import bound_of
from hpn.files.report.checks import bar
from hpn.files.report.content import LONGEST_HEAD, LONGEST_TITLE, block, frame, link_of, shortened
from hpn.files.report.pdf import printed
from hpn.words.reader import Reader
from hpn.words.wording import N_, Sentence

MOST_AXES, MOST_CELLS = 500, 12
"""Most axes that are written out, and most inputs of each; the workbook has all."""

LABELS = {
    "differs": N_("Axes that differ"),
    "axis": N_("Axis"),
    "input": N_("Input"),
    "gear": N_("Gear"),
    "effect": N_("Effect"),
    "every_axis": N_("For every axis"),
    "no_gear": N_("no gear"),
}
LINK = {
    "saved": N_("This comparison"),
    "whole": N_("This comparison"),
    "too long": N_("The link is too long to print."),
}
UNTITLED = N_("Untitled machine")
COUNTS = N_("{changed} of {count} axes differ; {lost} lost their gear, {other} have another one.")
NO_CHANGE = N_("Nothing differs.")
MORE_AXES, MORE_CELLS = N_("and {count} more axes; the workbook has all"), N_("and {count} more")
REORDERED = N_("The axes stand in another order.")


def pdf(export: DifferencesExport, reader: Reader) -> bytes:
    """Report on the differences."""
    return printed("differences.typ", content(export, reader), export.heading.title.strip(), export.created)


def content(export: DifferencesExport, reader: Reader) -> dict[str, Any]:
    """Data of the template."""
    data, differences, text = frame(export.heading, reader), export.differences, reader.text
    title = shortened(export.heading.title.strip() or text(UNTITLED), LONGEST_TITLE)
    arrow = " → ".join(export.labels)
    count, more = len(differences.axes) + differences.same, len(differences.axes) - MOST_AXES
    values = {
        "changed": reader.exact(len(differences.axes)),
        "count": reader.exact(count),
        "lost": reader.exact(sum(axis.lost_its_gear for axis in differences.axes)),
        "other": reader.exact(sum(axis.has_another_gear for axis in differences.axes)),
    }
    notes = [reader.sentence(Sentence(COUNTS, values)) if differences.axes else text(NO_CHANGE)]
    notes += [text(REORDERED)] if differences.order else []
    return data | {
        "labels": data["labels"] | {key: text(label) for key, label in LABELS.items()},
        "title": title,
        "head": [shortened(title, LONGEST_HEAD), arrow],
        "block": block(export.heading, reader, export.created, export.moment)
        | {"revision": [text(N_("Revision")), arrow]},
        "saved": export.created is not None,
        **link_of(export.link, reader, is_saved=True, notes=LINK),
        "sides": list(export.labels),
        "cells_head": text(head_of(differences.axes)),
        "notes": notes,
        "notices": [],
        "facts": [],
        "common": [
            [reader.sentence(label_of(each.pointer)), *(text_of(line, reader) for line in lines)]
            for each, lines in zip(differences.common, common_lines(export), strict=True)
        ],
        "rows": [_row(axis, export.sides(axis.number), reader) for axis in differences.axes[:MOST_AXES]],
        "more": reader.sentence(Sentence(MORE_AXES, {"count": reader.exact(more)})) if more > 0 else "",
    }


def _row(axis: DifferentAxis, sides: tuple[FrozenAxis | None, FrozenAxis | None], reader: Reader) -> dict[str, Any]:
    cells = cells_of(axis, reader)
    more = len(cells) - MOST_CELLS
    return {
        "number": axis.number,
        "name": axis.name or "",
        "cells": [list(cell) for cell in cells[:MOST_CELLS]],
        "cells_title": reader.text(RESULT) if has_results(axis) else "",
        "more": reader.sentence(Sentence(MORE_CELLS, {"count": reader.exact(more)})) if more > 0 else "",
        "gears": [side.gear if side else None for side in (axis.side_from, axis.side_to)],
        "bars": [_bar(side, reader) for side in sides],
        "used": [utilisation_text(side, reader) for side in sides],
        "effect": effect(axis, sides, reader),
    }


def _bar(axis: FrozenAxis | None, reader: Reader) -> dict[str, Any] | None:
    if axis is None or axis.answer.status == "open":
        return None
    return bar(axis.answer.utilisation, bound_of(axis), axis.answer.status, reader)
