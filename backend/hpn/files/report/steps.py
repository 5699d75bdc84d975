"""The calculation of the reported gear: every equation in symbols and with its numbers, its limit and its source."""

from collections.abc import Iterable
from typing import Any

from hpn.explain.calculation import Step, calculation_of
from hpn.explain.calculation.mathml import compared, in_symbols, result, substituted
from hpn.files.export import Export
from hpn.files.words import used
from hpn.words.reader import Reader
from hpn.words.symbols import sentence
from hpn.words.terms import VERDICTS
from hpn.words.wording import N_, Sentence


def steps(export: Export, reader: Reader) -> list[dict[str, Any]]:
    """Each step with its formulas as MathML, which the template sets; none where the gear's figures are not at hand."""
    gear = export.gear(export.candidate)
    if gear is None or export.figures is None:
        return []
    worked = calculation_of(export.candidate, gear, export.application, export.figures)
    return [_step(step, export, reader) for step in worked]


def _step(step: Step, export: Export, reader: Reader) -> dict[str, Any]:
    return {
        "equation": step.equation or "",
        "title": sentence(reader.text(step.title)),
        "lines": [
            {
                "symbols": in_symbols(reader, line),
                "numbers": substituted(reader, line),
                "result": result(reader, line),
            }
            for line in step.lines
        ],
        "limits": [
            {"formula": compared(reader, one), "status": one.status, "word": reader.text(VERDICTS[one.status])}
            for one in step.comparisons
        ],
        "source": " ".join(reader.told(told) for told in _sources(step, export, reader)),
        "notes": [sentence(reader.told(note)) for note in step.notes],
    }


def _sources(step: Step, export: Export, reader: Reader) -> Iterable[Sentence]:
    if step.equation:
        yield Sentence(N_("Equation {number}, page 17 of the handbook."), {"number": step.equation})
    else:
        yield Sentence(N_("Not printed in the handbook."))
    for comparison in step.comparisons:
        share = used(export, comparison.code, comparison.utilisation, reader)
        source = reader.source(comparison.source or "your input")
        yield Sentence(N_("Limit: {source}; used: {share}."), {"source": source, "share": share})
    if step.abbreviated:
        count = len(export.application.duty_cycle.load_phases)
        text = N_("Only some of the {count} phases are written out; the result counts them all.")
        yield Sentence(text, {"count": reader.exact(count)})
