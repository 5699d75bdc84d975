"""Differences of two documents in words and numbers, alike in PDF and workbook."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from datetime import datetime
from functools import cached_property
from typing import Any

from hpn.account.lines import Line
from hpn.account.readings import life_of
from hpn.catalogue import Catalogue
from hpn.documents.differences import DifferentAnswer, DifferentAxis, DifferentInput, DocumentDifferences, differences
from hpn.documents.revision import Frozen, FrozenAxis
from hpn.files.export import ExportTitle
from hpn.files.machine.inputs import label_of, line_of, path_of
from hpn.files.machine.words import STATUS, bound_of, check_of
from hpn.words.quantities import CANDIDATE, DUTY, GEAR
from hpn.words.reader import NOTHING, Reader
from hpn.words.units import suffix_of
from hpn.words.wording import N_, Named, Sentence

ANSWER = {
    "selected": Named(N_("Selected gear")),
    "suitable": Named(N_("Suitable gears")),
    "runner_up": Named(N_("Second suitable gear")),
    "weight_kg": GEAR["weight_kg"],
    "average_torque_Nm": DUTY["average_torque_Nm"],
    "holds": Named(N_("Holds over the whole tolerance")),
    "worst_utilisation": Named(N_("Utilisation in the worst case")),
    "worst_governing_check": Named(N_("Governing check in the worst case")),
}
"""Fields of an answer that are no figures of a candidate."""

LOST = N_("was suitable; nearest {gear}, {check}")
WANTING = N_("no suitable gear; nearest {gear}, {check}")
NOW_OPEN = N_("has no answer any more")
OTHER_CHECK, LONGER = N_("{check}; was {before}"), N_("shortest life {before} → {after}")
WORST_CASE = ("holds", "worst_governing_check")

INPUT, RESULT, BOTH = N_("Input"), N_("Result"), N_("Input or result")
ADDED, REMOVED, SAME = N_("new"), N_("removed"), N_("the same result")


@dataclass(frozen=True)
class DifferencesExport:
    """Two documents to compare, with their labels, the catalogues of their answers, and the link of the comparison."""

    labels: tuple[str, str]
    documents: tuple[Frozen, Frozen]
    catalogues: tuple[Catalogue | None, Catalogue | None]
    link: str
    heading: ExportTitle = field(default_factory=ExportTitle)
    created: datetime | None = None
    moment: datetime | None = None

    @cached_property
    def differences(self) -> DocumentDifferences:
        """Differences of the two documents."""
        return differences(*self.documents, self.catalogues)

    @cached_property
    def _axes(self) -> tuple[dict[int, FrozenAxis], dict[int, FrozenAxis]]:
        one, other = ({axis.number: axis for axis in document.axes} for document in self.documents)
        return one, other

    def sides(self, number: int) -> tuple[FrozenAxis | None, FrozenAxis | None]:
        """Axis of a number in both documents; None where a document lacks it."""
        return self._axes[0].get(number), self._axes[1].get(number)


def input_lines(each: DifferentInput) -> tuple[Line, Line]:
    """Both values of a different input, as lines."""
    path = path_of(each.pointer)
    return line_of(path, each.value_from), line_of(path, each.value_to)


def answer_lines(each: DifferentAnswer, reader: Reader) -> tuple[Line, Line]:
    """Both values of a different verdict or figure, as lines."""
    named = ANSWER.get(each.field) or CANDIDATE.get(each.field) or Named(each.field)
    one, other = (_answer_line(each.field, named, value, reader) for value in (each.value_from, each.value_to))
    return one, other


def _answer_line(name: str, named: Named, value: Any, reader: Reader) -> Line:
    code = f"candidate.{name}"
    if isinstance(value, bool):
        return Line(code, named, str(value), kind="computed")
    if name in ("governing_check", "worst_governing_check"):
        return Line(code, named, check_of(value, reader) or None, kind="computed")
    if name == "status":
        return Line(code, named, STATUS.get(value, value), kind="computed")
    return Line(code, named, value, suffix_of(name) if isinstance(value, float | int) else "", "computed")


def text_of(line: Line, reader: Reader) -> str:
    """Value as text, with its unit; a dash for none, and a utilisation in percent."""
    if line.code in ("candidate.utilisation", "candidate.worst_utilisation") and isinstance(line.value, float | int):
        return reader.percent(line.value)
    return line.text(reader) if line.value is not None else NOTHING


Cell = tuple[str, str, str]
"""Name of a value, and its text in both documents."""


def cells_of(axis: DifferentAxis, reader: Reader) -> list[Cell]:
    """Different inputs of an axis, else its different figures."""
    return input_cells(axis.inputs, reader) or answer_cells(_figures(axis), reader)


def has_results(axis: DifferentAxis) -> bool:
    """True where the cells of an axis are figures."""
    return not axis.inputs and bool(_figures(axis))


def head_of(axes: Iterable[DifferentAxis]) -> str:
    """Head of a column with the cells of axes."""
    kinds = {has_results(axis) for axis in axes if axis.inputs or has_results(axis)}
    return BOTH if len(kinds) == 2 else RESULT if True in kinds else INPUT


def _figures(axis: DifferentAxis) -> list[DifferentAnswer]:
    """Figures beside the utilisation; of a worst case that only one document has the utilisation says all."""
    return [
        each
        for each in axis.figures
        if each.field != "utilisation"
        and (each.field not in WORST_CASE or None not in (each.value_from, each.value_to))
    ]


def input_cells(inputs: Iterable[DifferentInput], reader: Reader) -> list[Cell]:
    """Cells of different inputs."""
    return [_cell(reader.sentence(label_of(each.pointer)), input_lines(each), reader) for each in inputs]


def answer_cells(answered: Iterable[DifferentAnswer], reader: Reader) -> list[Cell]:
    """Cells of different verdicts and figures."""
    pairs = (answer_lines(each, reader) for each in answered)
    return [_cell(lines[0].label(reader), lines, reader) for lines in pairs]


def _cell(name: str, lines: tuple[Line, Line], reader: Reader) -> Cell:
    one, other = lines
    return name, text_of(one, reader), text_of(other, reader)


def utilisation_text(axis: FrozenAxis | None, reader: Reader) -> str:
    """Utilisation of an axis; blank where the document lacks the axis."""
    return reader.percent(axis.answer.utilisation, bound_of(axis)) if axis else ""


def effect(axis: DifferentAxis, sides: tuple[FrozenAxis | None, FrozenAxis | None], reader: Reader) -> str:
    """Effect of the differences on an axis, in words."""
    return reader.sentence(_effect(axis, sides, reader))


def _effect(axis: DifferentAxis, sides: tuple[FrozenAxis | None, FrozenAxis | None], reader: Reader) -> Sentence:
    before, after = sides
    if after is None:
        return Sentence(REMOVED)
    answer = after.answer
    check = check_of(answer.governing_check, reader)
    if answer.status == "open":
        return Sentence(NOW_OPEN if before else ADDED)
    if answer.status != "suitable" and (axis.lost_its_gear or axis.verdicts):
        template = LOST if before and axis.lost_its_gear else WANTING
        return Sentence(template, {"gear": answer.designation or "", "check": check})
    if before is None:
        return Sentence(ADDED)
    if answer.governing_check != before.answer.governing_check:
        return Sentence(OTHER_CHECK, {"check": check, "before": check_of(before.answer.governing_check, reader)})
    if lives := _lives(axis, before, after):
        return Sentence(LONGER, lives)
    return Sentence(SAME) if not axis.figures and not axis.verdicts else Sentence("{text}", {"text": check})


def _lives(axis: DifferentAxis, before: FrozenAxis, after: FrozenAxis) -> dict[str, Any] | None:
    if all(each.field != "shortest_life_h" for each in axis.figures):
        return None
    answers = (before.answer, after.answer)
    lives = [life_of(each.shortest_life_h, each.shortest_life_of).sentence for each in answers if each.shortest_life_h]
    return {"before": lives[0], "after": lives[1]} if len(lives) == 2 else None


def common_lines(export: DifferencesExport) -> Iterator[tuple[Line, Line]]:
    """Title block and common values that differ, as lines."""
    return map(input_lines, export.differences.common)
