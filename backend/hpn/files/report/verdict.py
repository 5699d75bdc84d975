"""Verdict of the report, every check of the reported gear, and the alternatives to it."""

from collections.abc import Iterable, Mapping
from typing import Any

from hpn.engine.remedy import remedy_of
from hpn.engine.selection import Candidate, CheckResult
from hpn.explain.readings import Reading, readings_of, shortest_life
from hpn.files.export import Export
from hpn.files.words import bound_of, exact_percent, measured, origin, title_of, used
from hpn.words.reader import Reader
from hpn.words.symbols import formula, sentence
from hpn.words.terms import VERDICTS
from hpn.words.wording import N_, Sentence

WORD: Mapping[str, str] = {
    "suitable": N_("suitable"),
    "unsuitable": N_("not suitable"),
    "unrated": N_("not rated"),
}
REASONS: Mapping[str, str] = {
    "suitable": N_("{gear} passes every check. “{check}” governs, at {percent} of its limit."),
    "unsuitable": N_("No gear is suitable. {gear} comes closest; “{check}” fails at {percent}."),
    "unlimited": N_(
        "No gear is suitable. {gear} comes closest, but T_k is too high: no emergency stop is permitted (eq. 17.9)."
    ),
    "unrated": N_(
        "No gear is suitable. {gear} can’t be judged: figures that the checks need are not in this catalogue’s source."
    ),
}
"""Notes on the reported gear where it is the selected one or none is suitable."""

CHOSEN: Mapping[str, str] = {
    "unsuitable": N_("{gear} was chosen, but “{check}” fails at {percent}. {selected} would be suitable."),
    "unlimited": N_(
        "{gear} was chosen, but T_k is too high: no emergency stop is permitted (eq. 17.9). {selected} would be "
        "suitable."
    ),
    "unrated": N_(
        "{gear} was chosen, but can’t be judged: figures that the checks need are not in this catalogue’s source. "
        "{selected} would be suitable."
    ),
}
"""Notes on a gear that does not pass and was chosen in place of a suitable one."""

BEST: Mapping[str, str] = {
    "weight": N_("It is the lightest of {count} suitable gears."),
    "utilisation": N_("It has the largest reserve of {count} suitable gears."),
    "length": N_("It is the shortest of {count} suitable gears."),
    "motor_torque": N_("It needs the least motor torque of {count} suitable gears."),
    "life": N_("It has the longest life of {count} suitable gears."),
    "stiffness": N_("It is the stiffest of {count} suitable gears."),
}
ONLY = N_("It is the only suitable gear.")
RANKED = N_("It was chosen; {selected} ranks first of {count} suitable gears.")

LIVES: Mapping[tuple[str, str], str] = {
    ("life", "L10"): N_("gear, L10"),
    ("output_bearing_life", "L10"): N_("output bearing, L10"),
    ("output_bearing_life", "L50"): N_("output bearing, L50"),
}
"""Lives of which the shortest counts, as both are on the same basis."""


def verdict(export: Export, reader: Reader) -> dict[str, Any]:
    """The verdict in sentences, and its parts."""
    candidate = export.candidate
    said = [reader.told(sentence) for sentence in _said(export, reader)]
    return {
        "status": candidate.status,
        "gear": candidate.designation,
        "text": sentence(" ".join(said)),
        "word": reader.text(WORD[candidate.status]),
    }


def _said(export: Export, reader: Reader) -> Iterable[Sentence]:
    candidate, selected = export.candidate, export.selection.selected
    status, code = candidate.status, candidate.governing_check
    key = "unlimited" if status == "unsuitable" and candidate.utilisation is None else status
    values = {
        "gear": candidate.designation,
        "selected": selected or "",
        "check": title_of(export, code, reader) if code else "",
        "percent": used(export, code, candidate.utilisation, reader),
    }
    yield Sentence(CHOSEN[key] if selected and status != "suitable" else REASONS[key], values)
    if status == "suitable":
        yield _place(export)
    elif remedy := remedy_of(candidate, export.application.requirements.utilisation):
        yield remedy
    life = shortest_life(candidate, export.application)
    if life is not None and life.life_h is not None:
        part = reader.text(LIVES[life.check, life.basis])
        yield Sentence(
            N_("Shortest life: {life} ({part})."), {"life": measured(life.life_h, "h", reader), "part": part}
        )


def _place(export: Export) -> Sentence:
    """Where a suitable gear stands among the suitable ones."""
    count = sum(candidate.status == "suitable" for candidate in export.selection.candidates)
    selected = export.selection.selected
    if export.candidate.designation != selected:
        return Sentence(RANKED, {"selected": selected or "", "count": count})
    return Sentence(BEST[export.application.rank_by] if count > 1 else ONLY, {"count": count})


# --- Checks -----------------------------------------------------------------------------------------------------------


def checks(export: Export, reader: Reader) -> list[dict[str, Any]]:
    """Every check of the reported gear."""
    readings = _readings(export, export.candidate)
    return [_check(export, check, readings[check.code], reader) for check in export.candidate.checks]


def _readings(export: Export, candidate: Candidate) -> dict[str, Reading]:
    return readings_of(candidate, export.selection, export.application, export.figures)


def _check(export: Export, check: CheckResult, read: Reading, reader: Reader) -> dict[str, Any]:
    definition, bound = export.selection.check_definitions[check.code], bound_of(export, check.code)
    return {
        "title": title_of(export, check.code, reader),
        "relation": formula(read.relation),
        "demand": _demand(read, reader),
        "limit": _limit(read, reader),
        "utilisation": reader.percent(check.utilisation, bound),
        "share": _share(check),
        "bound": bound,
        "status": check.status,
        "word": reader.text(VERDICTS[check.status]),
        "where": origin(export, check.code, reader),
        "basis": sentence(reader.text(definition.basis)),
    }


def _limit(read: Reading, reader: Reader) -> str:
    """Limit of a check, and the share of it that the user's own u leaves."""
    if read.has_unlimited_limit:
        return reader.text(N_("unlimited"))
    part = f" {'÷' if read.kind == 'minimum' else '×'} {exact_percent(read.part, reader)}" if read.part < 1 else ""
    return measured(read.limit, read.unit, reader, read.demand) + part


def _demand(read: Reading, reader: Reader) -> str:
    if read.has_unlimited_demand:
        return reader.text(N_("unlimited"))
    return measured(read.demand, read.unit, reader, read.bound)


def _share(check: CheckResult) -> float:
    """Length of a check's bar: none where it is not rated, all of it where it fails without a number."""
    if check.utilisation is None:
        return 2.0 if check.status == "fail" else 0.0
    return check.utilisation


# --- Alternatives -----------------------------------------------------------------------------------------------------

MOST_OTHERS = 4
"""Suitable gears that are listed beside the reported one."""

HEADS = (
    N_("Next suitable"),
    N_("Weight"),
    N_("Longest length"),
    N_("Gear life L10"),
    N_("Utilisation"),
    N_("Governing check"),
)
"""Columns of the alternatives."""


def alternatives(export: Export, reader: Reader) -> dict[str, Any]:
    """How many gears were considered, the next suitable ones, and what keeps a lighter one or the next from fitting."""
    counts = dict.fromkeys(("suitable", "unsuitable", "unrated"), 0)
    for candidate in export.selection.candidates:
        counts[candidate.status] += 1
    overview = Sentence(
        N_("{total} gears considered: {suitable} suitable, {unsuitable} not suitable, {unrated} not rated."),
        {"total": len(export.selection.candidates), **counts},
    )
    return {
        "overview": reader.told(overview),
        "heads": [reader.text(head) for head in HEADS],
        "others": [_row(export, candidate, reader) for candidate in export.others[:MOST_OTHERS]],
        "misses": [
            [reader.text(N_("Nearest miss")), sentence(_missed(export, candidate, reader))]
            for candidate in export.misses
        ],
    }


def _row(export: Export, candidate: Candidate, reader: Reader) -> list[str]:
    """A suitable gear as the cells of a table."""
    gear, code = export.gear(candidate), candidate.governing_check
    life = candidate.life_L10_h
    unlimited = candidate.is_unlimited("life_L10_h")
    return [
        candidate.designation,
        _published(gear.weight_kg if gear else None, "kg", reader),
        _published(gear.length_max_mm if gear else None, "mm", reader),
        reader.text(N_("unlimited")) if unlimited else "–" if life is None else measured(life, "h", reader),
        reader.percent(candidate.utilisation, bound_of(export, code)),
        title_of(export, code, reader) if code else "",
    ]


def _published(value: float | None, unit: str, reader: Reader) -> str:
    return reader.with_unit(reader.exact(value, unit), unit)


def _missed(export: Export, candidate: Candidate, reader: Reader) -> str:
    """Failed checks of a rejected gear, and the ways to make it fit."""
    gear, name = export.gear(candidate), candidate.designation
    if gear and gear.weight_kg:
        name = f"{name} ({_published(gear.weight_kg, 'kg', reader)})"
    read = _readings(export, candidate)
    failures = "; ".join(_failure(export, check, read[check.code], reader) for check in candidate.failing)
    failed = reader.told(Sentence(N_("{gear} fails: {failures}."), {"gear": name, "failures": failures}))
    remedy = remedy_of(candidate, export.application.requirements.utilisation)
    return f"{failed} {reader.told(remedy)}" if remedy else failed


def _failure(export: Export, check: CheckResult, read: Reading, reader: Reader) -> str:
    values = {
        "check": title_of(export, check.code, reader),
        "demand": _demand(read, reader),
        "limit": _limit(read, reader),
        "percent": reader.percent(check.utilisation, bound_of(export, check.code)),
    }
    return reader.told(Sentence(N_("{check} {demand} against {limit} ({percent})"), values))
