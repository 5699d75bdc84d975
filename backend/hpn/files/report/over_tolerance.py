"""Page of the report on the tolerances: the worst case of each check, and the inputs that decide."""

from typing import Any

from hpn.account.over_tolerance import OverTolerance, WorstLine, over_tolerance
from hpn.engine.tolerance_words import tolerance_of
from hpn.files.export import Export
from hpn.files.report.checks import bar, bounds, demand
from hpn.words.reader import NOTHING, Reader
from hpn.words.symbols import formula, sentence
from hpn.words.wording import N_

HEADS = (
    (N_("Check"), N_("Case that is worst")),
    (N_("Worst"), N_("as given")),
    (N_("Limit"), ""),
    ("", ""),
    (N_("Utilisation"), N_("as given")),
)
"""Headings of two lines each."""

INPUT_HEADS = (N_("Input"), N_("Tolerance"), N_("Worst case, with it exact"), N_("Holds up to"))


def tolerances(export: Export, reader: Reader) -> dict[str, Any] | None:
    """Data of the page; None without tolerances."""
    over = over_tolerance(export.account)
    tolerance = tolerance_of(export.candidate)
    if over is None or tolerance is None:
        return None
    sentences = [reader.sentence(tolerance), *([reader.sentence(over.growth)] if over.growth else [])]
    remedies = [over.remedy(line, reader) for line in over.holding]
    return {
        "title": reader.text(N_("Over the whole tolerance")),
        "text": sentence(" ".join(sentences)),
        "remedies": [sentence(text) for text in remedies],
        "standing": reader.sentence(over.standing),
        "heads": [[reader.text(line) if line else "" for line in head] for head in HEADS],
        "checks": [_check(line, reader) for line in over.checks],
        "input_heads": [reader.text(head) for head in INPUT_HEADS],
        "inputs": _inputs(over, reader),
        "failing": sentence(" ".join(map(reader.sentence, over.failing))),
    }


def _check(line: WorstLine, reader: Reader) -> dict[str, Any]:
    nominal, reading = line.check.reading, line.reading
    sides = [(reader.text(N_("high")), line.high), (reader.text(N_("low")), line.low)]
    drawing = bar(line.worst, line.bound, line.status, reader)
    return {
        **drawing,
        "utilisation": f"{'' if line.is_exact or line.worst is None else '≈ '}{drawing['utilisation']}",
        "title": sentence(reader.text(line.check.definition.title)),
        "worst": demand(reading, reader) if reading else NOTHING,
        "given": demand(nominal, reader),
        "limit": f"{nominal.sign} {bounds(reading or nominal, reader)}",
        "nominal": reader.percent(line.check.result.utilisation, line.bound),
        "case": [[word, [formula(name) for name in names]] for word, names in sides if names],
    }


def _inputs(over: OverTolerance, reader: Reader) -> list[list[Any]]:
    """Tolerances as they were given; those that decide come first."""
    deciding = {line.tolerance.path: line for line in over.deciding}
    worst = over.governing.worst if over.governing else None
    lines = sorted(
        over.tolerances, key=lambda line: [*deciding].index(line.path) if line.path in deciding else len(deciding)
    )
    rows = []
    for line in lines:
        one = deciding.get(line.path)
        exact = NOTHING
        if one:
            between = one.between(worst)
            shares = (NOTHING if share is None else reader.percent(share, between) for share in (worst, one.worst))
            exact = " → ".join(shares)
        up_to = one.tolerance.text(reader, one.allowed) if one and one.allowed else NOTHING
        rows.append([formula(line.symbol), reader.sentence(line.place), line.text(reader), exact, up_to])
    return rows
