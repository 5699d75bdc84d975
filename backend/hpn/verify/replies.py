"""Verification of JSON: a saved selection, an answer or a machine, calculated again."""

from collections.abc import Iterator, Mapping
from typing import Any

import msgspec
from msgspec import MsgspecError
from pydantic import ValidationError

from hpn.application import Application, InputError
from hpn.catalogue import Catalogue
from hpn.documents.answers import AxisQuestion, answers
from hpn.documents.axis import Axis
from hpn.documents.common import Common
from hpn.documents.merge import resolve
from hpn.engine.kept import UnreadableReplyError, decode
from hpn.engine.selection import Selection, select
from hpn.explain.comparison import aligned, is_number, is_same
from hpn.installed import require
from hpn.links.writer import to_link
from hpn.verify.shown import UnreadableFileError, differing, listed, subject_of
from hpn.verify.verdict import FileVersions, Finding, Reason, Verdict

Json = Mapping[str, Any]

COPIED = ("selected", "engine_version", "catalogue_version")
"""Fields of an answer that a saved selection repeats."""

NOT_ASKED = ("engine_version", "catalogue_version", "unknown", "problem", "faults")
"""Fields of an axis's answer that are no figures."""


def verified(value: Json, catalogue: Catalogue) -> Verdict:
    """Verdict on JSON of the API."""
    try:
        if isinstance(value.get("axes"), list):
            return _machine(value, catalogue)
        if isinstance(value.get("result"), dict):
            return _verdict_on_saved(value, catalogue)
        if isinstance(value.get("candidates"), list):
            return _answer(value, catalogue)
    except (ValidationError, InputError) as error:
        raise UnreadableFileError(f"the JSON can’t be calculated again: {listed(error)}") from None
    except (UnreadableReplyError, MsgspecError) as error:
        raise UnreadableFileError(f"the JSON can’t be calculated again: {error}") from None
    raise UnreadableFileError("the JSON is that of no selection and no machine")


# --- Selections -------------------------------------------------------------------------------------------------------


def _verdict_on_saved(value: Json, catalogue: Catalogue) -> Verdict:
    """Verdict on a saved selection: its answer, and the fields copied from it."""
    result: Json = value["result"]
    application = Application.model_validate(value.get("application"))
    findings = [
        Finding(f"/{name}", str(value[name]), str(result.get(name)), ("file",))
        for name in COPIED
        if name in value and value[name] != result.get(name)
    ]
    unchecked = ["/today: what differed when it was read"] if "today" in value else []
    versions = _versions(result)
    if isinstance(gear := value.get("gear"), dict):
        if versions.catalogue == catalogue.version:
            known = catalogue.by_designation.get(str(gear.get("designation")))
            findings += _pairs("/gear", gear, {} if known is None else msgspec.to_builtins(known), ("file",))
        else:
            unchecked.append("/gear: the catalogue of that time is not here")
    return _compared("saved selection", "/result", result, application, catalogue, findings, unchecked)


def _answer(value: Json, catalogue: Catalogue) -> Verdict:
    """Verdict on an answer without a saved selection, by its link."""
    require("serve")  # its form reads links
    question = subject_of(str(value.get("link", "")))
    if question is None:
        raise UnreadableFileError("the answer has no link with an application")
    return _compared("answer", "", value, question.application, catalogue, [], [])


def _compared(
    name: str,
    place: str,
    result: Json,
    application: Application,
    catalogue: Catalogue,
    findings: list[Finding],
    unchecked: list[str],
) -> Verdict:
    before = decode(msgspec.json.encode(result))
    after = select(application, catalogue, to_link)
    versions = _versions(result)
    reasons = versions.reasons(catalogue.version, _limits(before), _limits(after))
    for one in differing(result, after):
        findings.append(Finding(place + one.pointer, _text(one.saved), _text(one.today), reasons))
    same = sum(is_number(leaf) for _, leaf in _leaves(result, "")) - len(findings)
    return Verdict(name, versions, max(same, 0), tuple(findings), tuple(unchecked))


def _limits(selection: Selection) -> dict[tuple[str, str], float | None]:
    return {(c.designation, check.code): check.limit for c in selection.candidates for check in c.checks}


def _versions(value: Json) -> FileVersions:
    engine, catalogue = (value.get(name) for name in COPIED[1:])
    return FileVersions(engine if isinstance(engine, str) else None, catalogue if isinstance(catalogue, str) else None)


# --- Machines ---------------------------------------------------------------------------------------------------------


def _machine(value: Json, catalogue: Catalogue) -> Verdict:
    """Verdict on a machine or a revision of one: the answer of every axis, and its inherited values."""
    common = Common.model_validate(value.get("common") or {}).model_dump(mode="json", exclude_unset=True)
    axes = [Axis.model_validate(each) for each in value["axes"]]
    questions = [AxisQuestion(resolve(axis.application, common, axis.without), axis.ordering_code) for axis in axes]
    findings, same, versions = list[Finding](), 0, FileVersions(None, None)
    for place, (saved, one, after) in enumerate(
        zip(value["axes"], questions, answers(questions, catalogue), strict=True)
    ):
        whole = saved.get("resolved")
        if whole is not None:
            findings += _pairs(f"/axes/{place}/resolved", whole, one.resolved.whole, ("file",))
        before = saved.get("answer")
        if isinstance(before, dict):
            versions = _versions(before)
            today = {name: value for name, value in msgspec.to_builtins(after).items() if name in before}
            reasons = versions.reasons(catalogue.version) if versions.engine else ("file",)
            pairs = list(_pairs(f"/axes/{place}/answer", before, today, reasons))
            same += sum(is_number(leaf) for _, leaf in _leaves(before, "")) - len(pairs)
            findings += pairs
    unchecked = [] if any("answer" in each for each in value["axes"]) else ["/axes: they have no answers"]
    return Verdict("machine", versions, max(same, 0), tuple(findings), tuple(unchecked))


def _pairs(place: str, before: Json, after: Json, reasons: tuple[Reason, ...]) -> Iterator[Finding]:
    """Values that differ, except fields that are no figures and figures that a saved answer's version did not know."""
    unknown = before.get("unknown")
    beside = [*NOT_ASKED, *(unknown if isinstance(unknown, list) else ())]
    sides = ({name: value for name, value in side.items() if name not in beside} for side in (before, after))
    for pointer, (one, other) in aligned(*(dict(_leaves(side, place)) for side in sides)):
        if not is_same(one, other):
            yield Finding(pointer, _text(one), _text(other), reasons)


# --- Values -----------------------------------------------------------------------------------------------------------


def _leaves(value: Any, pointer: str) -> Iterator[tuple[str, Any]]:
    """Values of JSON by their pointers, without nulls."""
    if isinstance(value, Mapping):
        for name, item in value.items():
            yield from _leaves(item, f"{pointer}/{name}")
    elif isinstance(value, list | tuple):
        for place, item in enumerate(value):
            yield from _leaves(item, f"{pointer}/{place}")
    elif value is not None:
        yield pointer, value


def _text(value: Any) -> str:
    return "" if value is None else str(value)
