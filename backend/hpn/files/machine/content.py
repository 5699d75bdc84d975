"""Report of a machine as data: title page, all axes in a table, and the pages of axes."""

from collections.abc import Iterator
from typing import Any

from hpn.account import over_tolerance
from hpn.account.readings import life_of
from hpn.documents.common import TOLERANCE, Common, flat
from hpn.documents.revision import FrozenAxis
from hpn.documents.summary import failing_inside, gear_of, has_worst_case
from hpn.files.machine.axis_page import axis_page
from hpn.files.machine.export import MOST_PAGES, MachineExport, Pages, exports_of
from hpn.files.machine.inputs import label_of, line_of
from hpn.files.machine.words import bound_of, check_of, faults_of, named, ranges, utilisation_text, worst_case
from hpn.files.report import tables
from hpn.files.report.checks import bar
from hpn.files.report.content import LONGEST_HEAD, LONGEST_TITLE, block, frame, link_of, running_head, shortened
from hpn.files.report.listing import laid_out
from hpn.words.reader import NOTHING, Reader
from hpn.words.symbols import formula, sentence
from hpn.words.wording import N_, Sentence

MOST_DECIDED = 40
"""Most axes to be decided that the title page lists."""

MOST_ROWS = 1000
"""Most axes in a table; for ten times as many typst would take a gigabyte."""

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
FAILS_INSIDE = N_("{percent}, at worst {worst}; {check}")
MORE = N_("and {count} more, in the list of axes")
OWN = N_("with values of their own: {count}")
KINDS = N_("kinds: {count}")
ONLY_SOME = N_("Pages of single axes: {axes}.")
NO_PAGES = N_("A report has pages of at most {most} axes; choose some in its address, such as axes=3,7-20.")


def content(export: MachineExport, pages: Pages, reader: Reader) -> dict[str, Any]:
    """Data of the template, ready for JSON."""
    data = frame(export.heading, reader)
    title = shortened(export.heading.title.strip() or reader.text(UNTITLED), LONGEST_TITLE)
    summary, axes = export.summary, export.document.axes
    engine, catalogue = (", ".join(each) for each in (summary.engine_versions, summary.catalogue_versions))
    return data | {
        "labels": data["labels"] | {key: reader.text(label) for key, label in LABELS.items()},
        "title": title,
        "head": [shortened(title, LONGEST_HEAD), running_head(export.heading, engine, catalogue, reader)],
        "block": block(export.heading, reader, export.created, export.moment),
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
        yield reader.sentence(Sentence(NO_PAGES, {"most": MOST_PAGES}))
    elif 0 < len(pages.axes) < count:
        yield reader.sentence(Sentence(ONLY_SOME, {"axes": ranges(axis.number for axis in pages.axes)}))


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
        "word": " · ".join(map(reader.sentence, sentences or [Sentence(ALL_SOUND)])),
        "count": reader.exact(summary.suitable),
        "of": reader.sentence(Sentence(SUITABLE, {"count": reader.exact(summary.axes)})),
        "largest": None
        if most is None
        else bar(summary.utilisation, bound_of(most), "suitable", reader, most.answer.worst_utilisation)
        | {"axis": named(most), "check": check_of(most.answer.governing_check, reader)},
    }


def _facts(export: MachineExport, reader: Reader) -> Iterator[tuple[str, str]]:
    summary, text = export.summary, reader.text
    yield text(N_("Axes, with quantity")), f"{reader.exact(summary.axes)}, {reader.exact(summary.quantity)}"
    yield text(N_("Kinds of gear")), reader.exact(summary.kinds)
    weight = Sentence(N_("Weight, {count} gears"), {"count": reader.exact(summary.gears)})
    yield reader.sentence(weight), reader.with_unit(reader.mass(summary.weight_kg), "kg")
    if summary.shortest_life_h is not None:
        life = reader.sentence(life_of(summary.shortest_life_h, summary.shortest_life_of).sentence)
        sentence = Sentence(N_("{life}, axis {number}"), {"life": life, "number": str(summary.shortest_life_axis)})
        yield text(N_("Shortest life")), reader.sentence(sentence)
    if export.before and export.since:
        changed = Sentence(N_("Changed since {label}"), {"label": export.before[0]})
        yield reader.sentence(changed), reader.exact(len(export.since.axes))


def _common(export: MachineExport, reader: Reader) -> dict[str, Any]:
    """Common values, and the number of axes with values of their own in place of a common one."""
    values = dict(flat(export.document.common))
    axes = export.document.axes
    own = sum(1 for axis in axes if axis.without or axis.own & values.keys())
    single = (line_of(path, value) for path, value in values.items() if not path.startswith(TOLERANCE))
    return {
        "rows": [*tables.lines(single, reader), *_tolerances(export, reader)],
        "note": reader.sentence(Sentence(OWN, {"count": reader.exact(own)})) if own else "",
    }


def _tolerances(export: MachineExport, reader: Reader) -> Iterator[dict[str, Any]]:
    """Common tolerances as rows of the common values."""
    for path, each in (Common.model_validate(export.document.common).tolerances or {}).items():
        line = over_tolerance.line_of(path, each)
        label = reader.sentence(label_of(f"/common/{TOLERANCE}{path}"))
        symbol, text = formula(line.symbol), line.text(reader)
        yield {"code": f"{TOLERANCE}{path}", "label": sentence(label), "symbol": symbol, "text": text}


def _decided(export: MachineExport, pages: Pages, reader: Reader) -> dict[str, Any]:
    """Axes without a suitable gear, open ones, and those whose gear does not hold over the whole tolerance."""
    inside = {*failing_inside(export.document.axes)}
    axes = export.document.axes
    wanting = [axis for axis in axes if axis.answer.status != "suitable" or axis.number in inside]
    wanting.sort(key=lambda axis: (axis.number in inside, axis.answer.status == "open"))
    paged = {axis.number for axis in pages.axes}
    more = len(wanting) - MOST_DECIDED
    return {
        "rows": [
            {
                "status": _standing(axis),
                "axis": named(axis),
                "text": _why(axis, reader),
                "page": axis.number if axis.number in paged else None,
            }
            for axis in wanting[:MOST_DECIDED]
        ],
        "more": reader.sentence(Sentence(MORE, {"count": reader.exact(more)})) if more > 0 else "",
        "none": reader.text(N_("Nothing is open.")),
    }


def _standing(axis: FrozenAxis) -> str:
    """Sign of an axis to be decided."""
    if axis.answer.status == "suitable":
        return "inside"
    return "unrated" if axis.answer.status in ("open", "unrated") else "unsuitable"


def _why(axis: FrozenAxis, reader: Reader) -> str:
    answer = axis.answer
    if answer.status == "open":
        return "; ".join(faults_of(axis, reader))
    if answer.status == "suitable":
        worst = {"percent": utilisation_text(axis, reader), "worst": worst_case(axis, reader)}
        return reader.sentence(
            Sentence(FAILS_INSIDE, worst | {"check": check_of(answer.worst_governing_check, reader)})
        )
    values = {
        "gear": answer.designation or "",
        "percent": utilisation_text(axis, reader),
        "check": check_of(answer.governing_check, reader),
    }
    if answer.status == "unrated":
        return reader.sentence(Sentence(NOT_RATED, values))
    return reader.sentence(Sentence(NOT_SUITABLE if gear_of(axis) is None else ORDERED, values))


def _gears(export: MachineExport, reader: Reader) -> dict[str, Any]:
    """Gears to order by ordering code: axes, number of axes and of gears, mass of one and of all, and motors."""
    order, each = export.order, export.catalogue.by_designation
    heads = [N_("Ordering code"), N_("Axes"), N_("axes"), N_("gears"), N_("each"), N_("together")]
    names_motors = any(gear.motors for gear in order.gears)
    heads += [N_("Motors")] * names_motors
    rows = []
    for gear in order.gears:
        known = each.get(gear.designation)
        counts = (len(gear.axes), gear.quantity)
        masses = (reader.figure(known.weight_kg if known else None, "kg"), reader.mass(gear.weight_kg))
        rows.append(
            [
                gear.ordering_code,
                ranges(gear.axes),
                *map(reader.exact, counts),
                *(reader.with_unit(mass, "kg") for mass in masses),
                *[", ".join(gear.motors)] * names_motors,
            ]
        )
    kinds = reader.sentence(Sentence(KINDS, {"count": reader.exact(order.kinds)}))
    sums = (sum(len(gear.axes) for gear in order.gears), sum(gear.quantity for gear in order.gears))
    whole = reader.with_unit(reader.mass(order.weight_kg), "kg")
    return {
        "heads": list(map(reader.text, heads)),
        "rows": rows,
        "sum": [kinds, "", *map(reader.exact, sums), "", whole, *[""] * names_motors],
    }


# --- All axes ---------------------------------------------------------------------------------------------------------

BARS, WORST_CASE = N_("0 to 150 %"), N_("Worst case")
HEADS = (
    *("", N_("Axis"), "×", N_("Gear"), N_("Governing check"), BARS, N_("Utilisation"), WORST_CASE, N_("Shortest life")),
)
MARK = N_("△: changed since {label}")
LIVES = N_("Life of the gear, or L50 or L10 of its output bearing.")


def _heads(export: MachineExport) -> list[str]:
    """Heads of the list of axes; that of the worst case only where an axis has tolerances."""
    left_out = () if has_worst_case(export.document.axes) else (WORST_CASE,)
    return [head for head in HEADS if head not in left_out]


def _table(export: MachineExport, reader: Reader) -> dict[str, Any]:
    changed = {axis.number for axis in (export.since.axes if export.since else ()) if axis.change != "removed"}
    most = export.summary.utilisation_axis
    notes = [*([Sentence(MARK, {"label": export.before[0]})] if export.before else []), Sentence(LIVES)]
    return {
        "heads": list(map(reader.text, _heads(export))),
        "note": " · ".join(map(reader.sentence, notes)),
        "has_worst": has_worst_case(export.document.axes),
        "rows": [
            _row(axis, reader) | {"is_changed": axis.number in changed, "is_largest": axis.number == most}
            for axis in export.document.axes
        ],
    }


def _row(axis: FrozenAxis, reader: Reader) -> dict[str, Any]:
    answer, gear = axis.answer, gear_of(axis)
    row = {"number": axis.number, "name": axis.name or "", "quantity": reader.exact(axis.quantity)}
    if answer.status == "open":
        return row | {"faults": "; ".join(faults_of(axis, reader)), "status": "open"}
    values = {"gear": answer.designation or "", "check": check_of(answer.governing_check, reader)}
    nearest = Sentence(N_("none; {gear}: {check}"), values)
    return row | {
        "gear": gear or "",
        "check": check_of(answer.governing_check, reader),
        "nearest": "" if gear else reader.sentence(nearest),
        **bar(answer.utilisation, bound_of(axis), answer.status, reader, answer.worst_utilisation),
        **_over_tolerance(axis, reader),
        "life": _life(axis, reader),
        "hours": _hours(axis, reader),
    }


def _over_tolerance(axis: FrozenAxis, reader: Reader) -> dict[str, str]:
    """Worst case of an axis and its sign; a dash without tolerances."""
    if axis.answer.holds is None:
        return {"worst": NOTHING, "worst_status": ""}
    return {"worst": worst_case(axis, reader), "worst_status": "suitable" if axis.answer.holds else "unsuitable"}


def _life(axis: FrozenAxis, reader: Reader) -> str:
    answer = axis.answer
    if answer.shortest_life_h is None:
        return NOTHING
    return reader.sentence(life_of(answer.shortest_life_h, answer.shortest_life_of).sentence)


def _hours(axis: FrozenAxis, reader: Reader) -> str:
    """Shortest life of an axis with a short basis, for a narrow column."""
    answer = axis.answer
    if answer.shortest_life_h is None:
        return NOTHING
    life = life_of(answer.shortest_life_h, answer.shortest_life_of)
    basis = reader.text(N_("gear")) if life.check == "life" else life.basis
    return f"{reader.with_unit(reader.figure(answer.shortest_life_h, 'h'), 'h')} {basis}"


def _listing(export: MachineExport, reader: Reader) -> dict[str, Any]:
    """Axes of a large machine as lines of equal width."""
    heads = [head for head in _heads(export) if head != BARS]
    rows = [_row(axis, reader) for axis in export.document.axes]
    cells = [
        [
            str(row["number"]),
            row["name"],
            row["quantity"],
            row.get("gear") or row.get("nearest") or row["faults"][:40],
            row.get("check", "") if row.get("gear") else "",
            row.get("utilisation", ""),
            *[row.get("worst", "")] * (WORST_CASE in heads),
            row.get("life", ""),
        ]
        for row in rows
    ]
    return laid_out([list(column) for column in zip(map(reader.text, heads), *cells, strict=True)])
