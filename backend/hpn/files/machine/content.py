"""The report of a machine as data: title page, all axes in a table, and the pages of axes."""

from collections.abc import Iterator
from typing import Any

from hpn.account.readings import life_of
from hpn.documents.common import flat
from hpn.documents.revision import FrozenAxis
from hpn.documents.summary import failing_inside, gear_of
from hpn.files.machine.axis_page import axis_page
from hpn.files.machine.export import MOST_PAGES, MachineExport, Pages, exports_of
from hpn.files.machine.inputs import line_of
from hpn.files.machine.words import bound_of, check_of, faults_of, named, ranges, used
from hpn.files.report import tables
from hpn.files.report.checks import bar
from hpn.files.report.content import LONGEST_HEAD, LONGEST_TITLE, block, frame, link_of, running_head, shortened
from hpn.files.report.listing import laid_out
from hpn.words.reader import NOTHING, Reader
from hpn.words.symbols import sentence
from hpn.words.wording import N_, Sentence

MOST_DECIDED = 40
"""Axes to be decided that the title page lists."""

MOST_ROWS = 1000
"""Axes up to which they stand in a table; typst would take a gigabyte for ten times as many."""

UNTITLED = N_("Untitled machine")

LABELS = {
    "largest_suitable": N_("Largest utilisation among the suitable"),
    "for_every_axis": N_("For every axis"),
    "to_be_decided": N_("To be decided"),
    "gear_list": N_("Gear list"),
    "in_list": N_("by ordering code; axes without a gear are not in it"),
    "axes": N_("Axes"),
    "page_of": N_("page {page}"),
    "check": N_("Check"),
    "demand": N_("Demand"),
    "limit": N_("Limit"),
    "open_axis": N_("Open: this axis has no answer."),
}
LINK = {
    "saved": N_("This revision as it was saved"),
    "whole": N_("This machine, to open and to change"),
    "too long": N_("The link is too long to print."),
}
NOT_FROZEN = N_("The working copy: what the link shows changes with it.")

SUITABLE = N_("of {count} axes suitable")
WITHOUT, OPEN = N_("{count} without a suitable gear"), N_("{count} open")
NOT_OVER = N_("{count} suitable as given, but not over the whole tolerance: {axes}")
ALL_SOUND = N_("every axis has a suitable gear")
NOT_SUITABLE = N_("no suitable gear. Nearest {gear}, {percent}; {check}")
ORDERED = N_("{gear} is ordered and not suitable: {percent}; {check}")
NOT_RATED = N_("{gear} can’t be rated")
MORE = N_("and {count} more, in the list of axes")
OWN = N_("with values of their own: {count}")
KINDS = N_("kinds: {count}")
ONLY_SOME = N_("Pages of single axes: {axes}.")
NO_PAGES = N_("A report has pages of at most {most} axes; choose some in its address, such as axes=3,7-20.")


def content(export: MachineExport, pages: Pages, reader: Reader) -> dict[str, Any]:
    """Everything that the template sets, as JSON-ready data."""
    data = frame(export.heading, reader)
    title = shortened(export.heading.title.strip() or reader.text(UNTITLED), LONGEST_TITLE)
    summary, axes = export.summary, export.document.axes
    engine, catalogue = (", ".join(each) for each in (summary.engine_versions, summary.catalogue_versions))
    return data | {
        "labels": data["labels"] | {key: reader.text(label) for key, label in LABELS.items()},
        "title": title,
        "head": [shortened(title, LONGEST_HEAD), running_head(export.heading, engine, catalogue, reader)],
        "block": block(export.heading, reader, export.created, export.made),
        "saved": export.created is not None,
        **link_of(export.link, reader, is_saved=export.created is not None, notes=LINK, carried=NOT_FROZEN),
        "summary": _summary(export, reader),
        "facts": [[sentence(label), text] for label, text in _facts(export, reader)],
        "common": _common(export, reader),
        "decided": _decided(export, pages, reader),
        "gears": _gears(export, reader),
        "notices": [[note] for note in _notes(export, pages, reader)],
        "axes": _table(export, reader) if len(axes) <= MOST_ROWS else None,
        "axes_listing": None if len(axes) <= MOST_ROWS else _listing(export, reader),
        "pages": list(_pages(export, pages, reader)),
    }


def _pages(export: MachineExport, pages: Pages, reader: Reader) -> Iterator[dict[str, Any]]:
    places = {axis.number: place for place, axis in enumerate(export.document.axes, 1)}
    for axis, one in exports_of(export, pages.axes):
        place = places[axis.number], len(places)
        yield axis_page(axis, one, place, reader, full=pages.full)


def _notes(export: MachineExport, pages: Pages, reader: Reader) -> Iterator[str]:
    count = len(export.document.axes)
    if not pages.axes and count > MOST_PAGES:
        yield reader.told(Sentence(NO_PAGES, {"most": MOST_PAGES}))
    elif 0 < len(pages.axes) < count:
        yield reader.told(Sentence(ONLY_SOME, {"axes": ranges(axis.number for axis in pages.axes)}))


# --- Title page -------------------------------------------------------------------------------------------------------


def _summary(export: MachineExport, reader: Reader) -> dict[str, Any]:
    summary = export.summary
    lacking = summary.unsuitable + summary.unrated
    sentences = [Sentence(WITHOUT, {"count": lacking})] if lacking else []
    sentences += [Sentence(OPEN, {"count": summary.open})] if summary.open else []
    inside = failing_inside(export.document.axes)
    sentences += [Sentence(NOT_OVER, {"count": len(inside), "axes": ranges(inside)})] if inside else []
    most = next((axis for axis in export.document.axes if axis.number == summary.utilisation_axis), None)
    return {
        "status": "unsuitable" if lacking else "unrated" if summary.open or inside else "suitable",
        "word": " · ".join(map(reader.told, sentences or [Sentence(ALL_SOUND)])),
        "count": reader.exact(summary.suitable),
        "of": reader.told(Sentence(SUITABLE, {"count": reader.exact(summary.axes)})),
        "largest": None
        if most is None
        else bar(summary.utilisation, bound_of(most), "suitable", reader)
        | {"axis": named(most), "check": check_of(most.answer.governing_check, reader)},
    }


def _facts(export: MachineExport, reader: Reader) -> Iterator[tuple[str, str]]:
    summary, text = export.summary, reader.text
    yield text(N_("Axes, with quantity")), f"{reader.exact(summary.axes)}, {reader.exact(summary.quantity)}"
    yield text(N_("Kinds of gear")), reader.exact(summary.kinds)
    weight = Sentence(N_("Weight, {count} gears"), {"count": reader.exact(summary.gears)})
    yield reader.told(weight), reader.with_unit(reader.figure(summary.weight_kg, "kg"), "kg")
    if summary.shortest_life_h is not None:
        life = reader.told(life_of(summary.shortest_life_h, summary.shortest_life_of).sentence)
        sentence = Sentence(N_("{life}, axis {number}"), {"life": life, "number": str(summary.shortest_life_axis)})
        yield text(N_("Shortest life")), reader.told(sentence)
    if export.before and export.since:
        changed = Sentence(N_("Changed since {label}"), {"label": export.before[0]})
        yield reader.told(changed), reader.exact(len(export.since.axes))


def _common(export: MachineExport, reader: Reader) -> dict[str, Any]:
    """Common values, and how many axes have their own in place of one."""
    values = dict(flat(export.document.common))
    axes = export.document.axes
    own = sum(1 for axis in axes if axis.without or axis.own & values.keys())
    return {
        "rows": tables.lines((line_of(path, value) for path, value in values.items()), reader),
        "note": reader.told(Sentence(OWN, {"count": reader.exact(own)})) if own else "",
    }


def _decided(export: MachineExport, pages: Pages, reader: Reader) -> dict[str, Any]:
    """Axes without a suitable gear, and open ones."""
    wanting = [axis for axis in export.document.axes if axis.answer.status != "suitable"]
    wanting.sort(key=lambda axis: axis.answer.status == "open")
    paged = {axis.number for axis in pages.axes}
    more = len(wanting) - MOST_DECIDED
    return {
        "rows": [
            {
                "status": "unrated" if axis.answer.status in ("open", "unrated") else "unsuitable",
                "axis": named(axis),
                "text": _why(axis, reader),
                "page": axis.number if axis.number in paged else None,
            }
            for axis in wanting[:MOST_DECIDED]
        ],
        "more": reader.told(Sentence(MORE, {"count": reader.exact(more)})) if more > 0 else "",
        "none": reader.text(N_("Nothing is open.")),
    }


def _why(axis: FrozenAxis, reader: Reader) -> str:
    answer = axis.answer
    if answer.status == "open":
        return "; ".join(faults_of(axis, reader))
    values = {
        "gear": answer.designation or "",
        "percent": used(axis, reader),
        "check": check_of(answer.governing_check, reader),
    }
    if answer.status == "unrated":
        return reader.told(Sentence(NOT_RATED, values))
    return reader.told(Sentence(NOT_SUITABLE if gear_of(axis) is None else ORDERED, values))


def _gears(export: MachineExport, reader: Reader) -> dict[str, Any]:
    """Gears to order by ordering code: axes, their number, the number of gears, mass of one and of all."""
    order, each = export.order, export.catalogue.by_designation
    heads = (N_("Ordering code"), N_("Axes"), N_("axes"), N_("gears"), N_("each"), N_("together"))
    rows = []
    for gear in order.gears:
        known = each.get(gear.designation)
        counts = (len(gear.axes), gear.quantity)
        masses = (known.weight_kg if known else None, gear.weight_kg)
        rows.append(
            [
                gear.ordering_code,
                ranges(gear.axes),
                *map(reader.exact, counts),
                *(reader.with_unit(reader.figure(mass, "kg"), "kg") for mass in masses),
            ]
        )
    kinds = reader.told(Sentence(KINDS, {"count": reader.exact(order.kinds)}))
    sums = (sum(len(gear.axes) for gear in order.gears), sum(gear.quantity for gear in order.gears))
    whole = reader.with_unit(reader.figure(order.weight_kg, "kg"), "kg")
    return {
        "heads": list(map(reader.text, heads)),
        "rows": rows,
        "sum": [kinds, "", *map(reader.exact, sums), "", whole],
    }


# --- All axes ---------------------------------------------------------------------------------------------------------

HEADS = (
    *("", N_("Axis"), "×", N_("Gear"), N_("Governing check"), N_("0 to 150 %"), N_("Utilisation"), N_("Shortest life")),
)
MARK = N_("△: changed since {label}")


def _table(export: MachineExport, reader: Reader) -> dict[str, Any]:
    changed = _changed(export)
    most = export.summary.utilisation_axis
    mark = Sentence(MARK, {"label": export.before[0]}) if export.before else None
    return {
        "heads": list(map(reader.text, HEADS)),
        "note": reader.told(mark) if mark else "",
        "rows": [
            _row(axis, reader) | {"is_changed": axis.number in changed, "is_largest": axis.number == most}
            for axis in export.document.axes
        ],
    }


def _changed(export: MachineExport) -> frozenset[int]:
    axes = export.since.axes if export.since else ()
    return frozenset(axis.number for axis in axes if axis.change != "removed")


def _row(axis: FrozenAxis, reader: Reader) -> dict[str, Any]:
    answer, gear = axis.answer, gear_of(axis)
    row = {"number": axis.number, "name": axis.name or "", "quantity": reader.exact(axis.quantity)}
    if answer.status == "open":
        return row | {"faults": "; ".join(faults_of(axis, reader)), "status": "open"}
    nearest = Sentence(N_("none; {gear}: {check}"), {"gear": answer.designation or ""} | _check(axis, reader))
    return row | {
        "gear": gear or "",
        "check": check_of(answer.governing_check, reader),
        "nearest": "" if gear else reader.told(nearest),
        **bar(answer.utilisation, bound_of(axis), answer.status, reader),
        "life": _life(axis, reader),
    }


def _check(axis: FrozenAxis, reader: Reader) -> dict[str, str]:
    return {"check": check_of(axis.answer.governing_check, reader)}


def _life(axis: FrozenAxis, reader: Reader) -> str:
    answer = axis.answer
    if answer.shortest_life_h is None:
        return NOTHING
    return reader.told(life_of(answer.shortest_life_h, answer.shortest_life_of).sentence)


def _listing(export: MachineExport, reader: Reader) -> dict[str, Any]:
    """Axes of a large machine as lines of one width."""
    heads = [reader.text(head) for head in HEADS if head != N_("0 to 150 %")]
    rows = [_row(axis, reader) for axis in export.document.axes]
    cells = [
        [
            str(row["number"]),
            row["name"],
            row["quantity"],
            row.get("gear") or row.get("nearest") or row["faults"][:40],
            row.get("check", "") if row.get("gear") else "",
            row.get("utilisation", ""),
            row.get("life", ""),
        ]
        for row in rows
    ]
    return laid_out([list(column) for column in zip(heads, *cells, strict=True)])
