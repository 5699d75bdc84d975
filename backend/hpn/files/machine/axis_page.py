"""Page of one axis in a machine's report: its verdict, inputs, checks and the next gears."""

from typing import Any

from hpn.account.lines import with_values
from hpn.documents.revision import FrozenAxis
from hpn.engine.checks import allowed
from hpn.explain.comparison import is_same
from hpn.files.export import Export
from hpn.files.machine.words import faults_of, gear_phrase
from hpn.files.report import plots
from hpn.files.report.checks import limits
from hpn.files.report.content import inputs, parts, titles
from hpn.files.report.verdict import beside, verdict
from hpn.words.reader import Reader
from hpn.words.symbols import sentence
from hpn.words.wording import N_, Sentence

MOST_BESIDE = 3
"""Most gears listed beside the axis's own."""

SAVED = N_(
    "This page is calculated by engine {engine}. The revision was answered by engine {then}, which gives {answer}."
)
FROM_MACHINE = N_("from the machine: grey")
PLACE = N_("axis {place} of {count}")
QUANTITY = N_("quantity {quantity}")


def axis_page(
    axis: FrozenAxis, export: Export | None, place: tuple[int, int], reader: Reader, *, full: bool
) -> dict[str, Any]:
    """Data of an axis's page; `place` is its position, from 1, and the number of axes. An open axis has only faults."""
    notes = [
        Sentence(PLACE, {"place": place[0], "count": place[1]}),
        Sentence(QUANTITY, {"quantity": reader.exact(axis.quantity)}),
    ]
    page = {
        "number": axis.number,
        "name": axis.name or "",
        "place": " · ".join(map(reader.sentence, notes)),
        "note": axis.note or "",
        "faults": faults_of(axis, reader),
        "selection": None,
        "full": full,
    }
    if export is None:
        return page
    selection = parts(export, reader) if full else _brief(export, reader)
    inherited = axis.inherited
    for row in (*selection["loads"], *selection["requirements"]):
        row["is_inherited"] = row["code"] in inherited
    grey = reader.text(FROM_MACHINE) if inherited else ""
    return page | {"selection": selection, "was": _was(axis, export, reader), "note_on_input": grey}


def _brief(export: Export, reader: Reader) -> dict[str, Any]:
    account = export.account
    figures = (f"{line.named.symbol} {line.text(reader)}" for line in with_values(account.cycle) if line.named.symbol)
    return inputs(export, reader) | {
        "titles": titles(export, reader),
        "verdict": verdict(export, reader),
        "cycle": plots.cycle(export, plots.pictures_of(export, reader), reader),
        "figures": sentence(" · ".join(figures)),
        "limits": limits(account, reader),
        "beside": beside(export, reader, MOST_BESIDE),
    }


def _was(axis: FrozenAxis, export: Export, reader: Reader) -> str:
    """Sentence with the answer of a revision where this page's answer differs; blank where both are the same."""
    answer, candidate = axis.answer, export.candidate
    figures = ((answer.designation, candidate.designation), (answer.status, candidate.status))
    if all(is_same(*pair) for pair in (*figures, (answer.utilisation, candidate.utilisation))):
        return ""
    bound = allowed(answer.governing_check, export.application.requirements.utilisation)
    values = {
        "engine": export.selection.engine_version,
        "then": answer.engine_version,
        "answer": f"{gear_phrase(axis, reader)}, {reader.percent(answer.utilisation, bound)}",
    }
    return reader.sentence(Sentence(SAVED, values))
