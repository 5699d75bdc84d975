"""What the report says of the gears: the verdict, every check of the reported gear, and the alternatives to it."""

from collections.abc import Mapping
from typing import Any

from hpn.reader import Reader
from hpn.readings import Reading, readings_of
from hpn.report.export import Export
from hpn.report.symbols import formula, sentence
from hpn.report.words import bound_of, exact_percent, measured, origin, title_of, used
from hpn.selection import Candidate, CheckResult
from hpn.wording import N_, Sentence

STATUS: Mapping[str, str] = {"pass": N_("passes"), "fail": N_("fails"), "not_rated": N_("not rated")}
WORD: Mapping[str, str] = {
    "suitable": N_("suitable"),
    "unsuitable": N_("none suitable"),
    "unrated": N_("unrated"),
}

VERDICTS: Mapping[str, str] = {
    "suitable": N_("{gear} is suitable. Every check passes; the closest is “{check}” at {percent} of its limit."),
    "unsuitable": N_("No gear is suitable. {gear} comes closest; it fails because of “{check}” at {percent}."),
    "unlimited": N_(
        "No gear is suitable. {gear} comes closest, but the emergency stop is so hard that none is allowed."
    ),
    "unrated": N_("No gear is suitable. {gear} can't be judged: figures that the checks need are not published."),
}

BEST: Mapping[str, str] = {
    "weight": N_("It is the lightest of {count} suitable gears."),
    "utilisation": N_("It has the largest reserve of {count} suitable gears."),
    "length": N_("It is the shortest of {count} suitable gears."),
    "motor_torque": N_("It needs the least motor torque of {count} suitable gears."),
    "life": N_("It has the longest life of {count} suitable gears."),
    "stiffness": N_("It is the stiffest of {count} suitable gears."),
}
ONLY = N_("It is the only suitable gear.")


def verdict(export: Export, reader: Reader) -> dict[str, Any]:
    """The verdict in a sentence, and its parts."""
    candidate = export.candidate
    status, code = candidate.status, candidate.governing_check
    key = "unlimited" if status == "unsuitable" and candidate.utilisation is None else status
    values = {
        "gear": candidate.designation,
        "check": title_of(export, code, reader) if code else "",
        "percent": used(export, code, candidate.utilisation, reader),
    }
    said = [reader.told(Sentence(VERDICTS[key], values))]
    suitable = sum(c.status == "suitable" for c in export.selection.candidates)
    if suitable:
        best = BEST[export.application.rank_by] if suitable > 1 else ONLY
        said.append(reader.told(Sentence(best, {"count": suitable})))
    return {
        "status": status,
        "gear": candidate.designation if status == "suitable" else "–",
        "text": " ".join(said),
        "utilisation": reader.percent(candidate.utilisation, bound_of(export, code)),
        "word": reader.text(WORD[status]),
    }


# --- Checks -----------------------------------------------------------------------------------------------------------


def checks(export: Export, reader: Reader) -> list[dict[str, Any]]:
    """Every check of the reported gear."""
    readings = _readings(export, export.candidate)
    return [_check(export, check, readings[check.code], reader) for check in export.candidate.checks]


def _readings(export: Export, candidate: Candidate) -> dict[str, Reading]:
    return readings_of(candidate, export.selection.check_definitions, export.application, export.figures)


def _check(export: Export, check: CheckResult, read: Reading, reader: Reader) -> dict[str, Any]:
    definition, bound = export.selection.check_definitions[check.code], bound_of(export, check.code)
    part = f" {'÷' if read.kind == 'minimum' else '×'} {exact_percent(read.part, reader)}" if read.part < 1 else ""
    return {
        "title": title_of(export, check.code, reader),
        "relation": formula(read.relation),
        "demand": _demand(read, reader),
        "limit": measured(read.limit, read.unit, reader) + part,
        "utilisation": reader.percent(check.utilisation, bound),
        "share": _share(check),
        "bound": bound,
        "status": check.status,
        "word": reader.text(STATUS[check.status]),
        "where": origin(export, check.code, reader),
        "basis": sentence(reader.text(definition.basis)),
    }


def _demand(read: Reading, reader: Reader) -> str:
    return reader.text(N_("unlimited")) if read.is_unlimited else measured(read.demand, read.unit, reader)


def _share(check: CheckResult) -> float:
    """Length of a check's bar: none where it is not rated, all of it where it fails without a number."""
    if check.utilisation is None:
        return 2.0 if check.status == "fail" else 0.0
    return check.utilisation


# --- Alternatives -----------------------------------------------------------------------------------------------------


def alternatives(export: Export, reader: Reader) -> list[list[str]]:
    """How many gears were considered, the runner-up, and a smaller gear that fails."""
    counts = dict.fromkeys(("suitable", "unsuitable", "unrated"), 0)
    for candidate in export.selection.candidates:
        counts[candidate.status] += 1
    overview = Sentence(
        N_("{total} gears considered: {suitable} suitable, {unsuitable} unsuitable, {unrated} not rated."),
        {"total": len(export.selection.candidates), **counts},
    )
    rows = [["", reader.told(overview)]]
    if export.runner_up:
        rows.append([reader.text(N_("Runner-up")), _in_a_sentence(export, export.runner_up, reader)])
    if export.smaller and export.smaller is not export.candidate:
        rows.append([reader.text(N_("Smaller gear")), _in_a_sentence(export, export.smaller, reader)])
    return rows


def _in_a_sentence(export: Export, candidate: Candidate, reader: Reader) -> str:
    """A candidate in a sentence: how close it is to its limits, or every check that it fails."""
    gear, name, code = export.gear(candidate), candidate.designation, candidate.governing_check
    if gear and gear.weight_kg:
        name = f"{name} ({reader.with_unit(reader.exact(gear.weight_kg, 'kg'), 'kg')})"
    if candidate.failing:
        read = _readings(export, candidate)
        failures = "; ".join(_failure(export, check, read[check.code], reader) for check in candidate.failing)
        return reader.told(Sentence(N_("{gear} fails: {failures}."), {"gear": name, "failures": failures}))
    values = {
        "gear": name,
        "check": title_of(export, code, reader) if code else "",
        "percent": used(export, code, candidate.utilisation, reader),
    }
    return reader.told(Sentence(N_("{gear} passes too; its closest check is “{check}” at {percent}."), values))


def _failure(export: Export, check: CheckResult, read: Reading, reader: Reader) -> str:
    values = {
        "check": title_of(export, check.code, reader),
        "demand": _demand(read, reader),
        "limit": measured(read.limit, read.unit, reader),
        "percent": used(export, check.code, check.utilisation, reader),
    }
    return reader.told(Sentence(N_("{check} {demand} against {limit} ({percent})"), values))
