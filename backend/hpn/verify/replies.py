"""JSON of a saved selection, of an answer or of a machine, calculated again."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any
from urllib.parse import parse_qsl, urlsplit

import msgspec
from msgspec import MsgspecError
from pydantic import ValidationError

from hpn.application import Application, InputError
from hpn.catalogue import Catalogue
from hpn.documents.answers import AxisAnswer, AxisQuestion, answers
from hpn.documents.axis import Axis
from hpn.documents.common import Common
from hpn.documents.merge import resolve
from hpn.engine.kept import UnreadableReplyError, decode
from hpn.engine.selection import Selection, select
from hpn.explain.comparison import aligned, is_same
from hpn.links.writer import to_link
from hpn.verify.shown import UnreadableFileError, differing, listed
from hpn.verify.verdict import FileVersions, Finding, Verdict
from hpn.web.form import link_reader

Json = Mapping[str, Any]

COPIED = ("selected", "engine_version", "catalogue_version")
"""Fields of an answer that a saved selection gives once more."""

NOT_ASKED = ("engine_version", "catalogue_version", "unknown", "problem", "faults")
"""Fields of an axis's answer that are no figures."""


def verified(value: Json, catalogue: Catalogue) -> Verdict:
    """Verdict on JSON of the API."""
    try:
        if isinstance(value.get("axes"), list):
            return _machine(value, catalogue)
        if isinstance(value.get("result"), dict):
            return _saved(value, catalogue)
        if isinstance(value.get("candidates"), list):
            return _answer(value, catalogue)
    except (ValidationError, InputError) as error:
        raise UnreadableFileError(f"the JSON can’t be calculated again: {listed(error)}") from None
    except (UnreadableReplyError, MsgspecError) as error:
        raise UnreadableFileError(f"the JSON can’t be calculated again: {error}") from None
    raise UnreadableFileError("the JSON is that of no selection and no machine")


# --- Selections -------------------------------------------------------------------------------------------------------


def _saved(value: Json, catalogue: Catalogue) -> Verdict:
    """A saved selection: its answer, and what is copied from it."""
    result: Json = value["result"]
    application = Application.model_validate(value.get("application"))
    found = [
        Finding(f"/{name}", str(value[name]), str(result.get(name)), ("file",))
        for name in COPIED
        if name in value and value[name] != result.get(name)
    ]
    unchecked = ["/today: what differed when it was read"] if "today" in value else []
    versions = _versions(result)
    if isinstance(gear := value.get("gear"), dict):
        if versions.catalogue == catalogue.version:
            found += _of_gear(gear, catalogue)
        else:
            unchecked.append("/gear: the catalogue of that time is not here")
    return _compared("saved selection", "/result", result, application, catalogue, found, unchecked)


def _answer(value: Json, catalogue: Catalogue) -> Verdict:
    """An answer alone, by its link."""
    query = urlsplit(str(value.get("link", ""))).query
    form = link_reader.parse(parse_qsl(query, keep_blank_values=True, max_num_fields=200_000))
    if form.application is None:
        raise UnreadableFileError("the answer has no link with an application")
    return _compared("answer", "", value, form.application, catalogue, [], [])


def _compared(
    name: str,
    place: str,
    result: Json,
    application: Application,
    catalogue: Catalogue,
    found: list[Finding],
    unchecked: list[str],
) -> Verdict:
    before = decode(msgspec.json.encode(result))
    after = select(application, catalogue, to_link)
    versions = _versions(result)
    for one in differing(result, after):
        reasons = versions.reasons(catalogue.version)
        if len(reasons) > 1:
            reasons = ("engine",) if _limits(before) == _limits(after) else ("catalogue",)
        found.append(Finding(place + one.pointer, _text(one.saved), _text(one.today), reasons))
    same = sum(isinstance(leaf, int | float) for _, leaf in _leaves(result, "")) - len(found)
    return Verdict(name, versions, max(same, 0), tuple(found), tuple(unchecked))


def _limits(selection: Selection) -> dict[tuple[str, str], float | None]:
    return {(c.designation, check.code): check.limit for c in selection.candidates for check in c.checks}


def _versions(value: Json) -> FileVersions:
    engine, catalogue = (value.get(name) for name in COPIED[1:])
    return FileVersions(engine if isinstance(engine, str) else None, catalogue if isinstance(catalogue, str) else None)


def _of_gear(gear: Json, catalogue: Catalogue) -> Iterator[Finding]:
    """Published figures of the gear that are not those of the same catalogue."""
    known = catalogue.by_designation.get(str(gear.get("designation")))
    published = {} if known is None else msgspec.to_builtins(known)
    sides = dict(_leaves(gear, "/gear")), dict(_leaves(published, "/gear"))
    for pointer, (shown, true) in aligned(*sides):
        if not is_same(shown, true):
            yield Finding(pointer, _text(shown), _text(true), ("file",))


# --- Machines ---------------------------------------------------------------------------------------------------------


def _machine(value: Json, catalogue: Catalogue) -> Verdict:
    """A machine or a revision of one: the answer of every axis, and what it inherits."""
    common = Common.model_validate(value.get("common") or {}).model_dump(mode="json", exclude_unset=True)
    axes = [Axis.model_validate(each) for each in value["axes"]]
    asked = [AxisQuestion(resolve(axis.application, common, axis.without), axis.ordering_code) for axis in axes]
    found, same, versions = list[Finding](), 0, FileVersions(None, None)
    for place, (given, one, after) in enumerate(zip(value["axes"], asked, answers(asked, catalogue), strict=True)):
        whole = given.get("resolved")
        if whole is not None:
            found += _pairs(f"/axes/{place}/resolved", whole, one.resolved.whole, FileVersions(None, None), catalogue)
        before = given.get("answer")
        if isinstance(before, dict):
            versions = _versions(before)
            pairs = list(_pairs(f"/axes/{place}/answer", before, _asked_of(before, after), versions, catalogue))
            same += sum(isinstance(leaf, int | float) for _, leaf in _leaves(before, "")) - len(pairs)
            found += pairs
    unchecked = [] if any("answer" in each for each in value["axes"]) else ["/axes: they have no answers"]
    return Verdict("machine", versions, max(same, 0), tuple(found), tuple(unchecked))


def _asked_of(before: Json, after: AxisAnswer) -> Json:
    """Answer of today with the figures that the version of a kept one knew."""
    today: Json = msgspec.to_builtins(after)
    unknown = {*NOT_ASKED, *(before.get("unknown") or ())}
    return {name: value for name, value in today.items() if name in before and name not in unknown}


def _pairs(place: str, before: Json, after: Json, versions: FileVersions, catalogue: Catalogue) -> Iterator[Finding]:
    """Values that differ; of `resolved`, which depends on no version, by the file alone."""
    reasons = versions.reasons(catalogue.version) if versions.engine else ("file",)
    shown = {name: value for name, value in before.items() if name not in NOT_ASKED and name not in _unknown(before)}
    for pointer, (one, other) in aligned(dict(_leaves(shown, place)), dict(_leaves(after, place))):
        if not is_same(one, other):
            yield Finding(pointer, _text(one), _text(other), tuple(reasons))


def _unknown(before: Json) -> Iterable[str]:
    found = before.get("unknown")
    return found if isinstance(found, list) else ()


# --- Values -----------------------------------------------------------------------------------------------------------


def _leaves(value: Any, pointer: str) -> Iterator[tuple[str, Any]]:
    """Values of JSON by their pointers; nulls are left out, as what is not given."""
    if isinstance(value, Mapping):
        for name, item in value.items():
            yield from _leaves(item, f"{pointer}/{name}")
    elif isinstance(value, list | tuple):
        for place, item in enumerate(value):
            yield from _leaves(item, f"{pointer}/{place}")
    elif value is not None and not isinstance(value, bool):
        yield pointer, value


def _text(value: Any) -> str:
    return "" if value is None else str(value)
