"""Report, workbook or package: made again of what it carries, or of its link, and set beside itself line by line."""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pkgutil import resolve_name
from typing import Any
from urllib.parse import parse_qsl, urlsplit

from msgspec import MsgspecError, structs
from pydantic import ValidationError

from hpn import ENGINE_VERSION
from hpn.application import Application, InputError
from hpn.catalogue import Catalogue
from hpn.engine.kept import UnreadableReplyError, fields_of
from hpn.engine.selection import Selection, judge, select
from hpn.files.carried import APPLICATION, DOCUMENT, RESULT, export_of
from hpn.files.export import DIGITS, Export
from hpn.installed import require
from hpn.links.writer import to_link
from hpn.verify.shown import (
    Pair,
    Shown,
    UnreadableFileError,
    beside,
    differing,
    is_alike,
    is_exact,
    listed,
    with_same_words,
)
from hpn.verify.today import Today
from hpn.verify.verdict import FileVersions, Finding, Reason, Verdict
from hpn.web.form import link_reader
from hpn.words.reader import LANGUAGES, Reader
from hpn.words.units import PRESETS

MOST_LINES = 400
"""Lines of a file that are named as beyond a check."""


POINT = "."
"""Decimal mark of cells and packages, whatever their language."""


@dataclass(frozen=True, slots=True)
class Format:
    """A format of files: the module that reads it, the function that makes it, and the extras of both."""

    name: str
    reader: str
    maker: str
    extras: tuple[str, ...]
    is_translated: bool = True

    def read(self, what: str, content: bytes) -> Any:
        """Part of a file by the name of the function that reads it."""
        return resolve_name(f"{self.reader}:{what}")(content)

    def made(self, export: Export, reader: Reader) -> bytes:
        """The file that is made today of an export."""
        make: Callable[..., bytes] = resolve_name(self.maker)
        return make(export, reader) if self.is_translated else make(export)

    def lines(self, content: bytes) -> list[Shown]:
        """Lines that a file shows."""
        return list(self.read("lines_of", content))


PDF = Format("PDF", "hpn.verify.pdf", "hpn.files.report.pdf:pdf", ("report", "serve"))
WORKBOOK = Format("workbook", "hpn.verify.workbook", "hpn.files.workbook.workbook:workbook", ("serve",))
PACKAGE = Format(
    "package", "hpn.verify.package", "hpn.files.aas.submodel:package", ("aas", "serve"), is_translated=False
)


@dataclass(frozen=True, slots=True)
class Told:
    """A file: its lines, the export that it was made of, and the one that is calculated today.

    `own` is None for a file that carries no answer. `link` is the address that
    its application was read from.
    """

    lines: Sequence[Shown]
    own: Export | None
    today: Export
    reader: Reader
    parts: Mapping[str, bytes]
    link: str = ""

    @property
    def versions(self) -> FileVersions:
        """FileVersions that the answer in the file names, else those that its lines do."""
        if self.own is None:
            return _printed_versions(self.lines)
        return FileVersions(self.own.selection.engine_version, self.own.selection.catalogue_version)

    @property
    def is_of_here(self) -> bool:
        """True where calculation and catalogue are those of this installation, and everything on the file is known."""
        here = FileVersions(ENGINE_VERSION, self.today.selection.catalogue_version)
        return self.own is not None and DOCUMENT in self.parts and self.versions == here


def verified(form: Format, content: bytes, catalogue: Catalogue, application: Application | None) -> Verdict:
    """Verdict on a file of a format; `application` is that of a file that carries none and has no link to one."""
    for extra in form.extras:
        require(extra)
    told = _told(form, content, catalogue, application)
    again = form.made(told.today, told.reader)
    if told.is_of_here:
        found = [*_of_answer(told), *_strictly(beside(told.lines, form.lines(again)), is_rounded=form is PDF)]
        if form is PDF and not found:
            found += _of_pages(form, content, again)
        return _verdict(form, told, found, [])
    own = form.lines(form.made(told.own, told.reader)) if told.own else []
    mark = told.reader.decimal if form is PDF else POINT
    found, unchecked = _leniently(told, mark, list(_as_here(told)), form.lines(again), own)
    return _verdict(form, told, found, unchecked)


def _verdict(form: Format, told: Told, found: list[Finding], unchecked: list[Shown]) -> Verdict:
    left_out = sum(len(line.figures) for line in unchecked)
    same = sum(len(line.figures) for line in told.lines) - left_out - len(found)
    texts = list(_unchecked(unchecked))
    if len(texts) > MOST_LINES:
        texts[MOST_LINES:] = [f"and {len(texts) - MOST_LINES} lines more"]
    return Verdict(form.name, told.versions, max(same, 0), tuple(found), tuple(texts))


# --- What the file says of itself -------------------------------------------------------------------------------------


def _told(form: Format, content: bytes, catalogue: Catalogue, application: Application | None) -> Told:
    parts, lines = form.read("parts_of", content), form.lines(content)
    if APPLICATION in parts and RESULT in parts:
        try:
            own, reader = export_of(parts, catalogue)
        except ValidationError as error:
            raise UnreadableFileError(f"the application in the {form.name} can’t be read: {listed(error)}") from None
        except (UnreadableReplyError, MsgspecError, UnicodeDecodeError) as error:
            raise UnreadableFileError(f"what the {form.name} carries of itself can’t be read: {error}") from None
        return Told(lines, own, _today(own, catalogue), reader, parts)
    link = ""
    if application is None:
        link, application = _linked(form, content)
    try:
        selection = _solved(application, catalogue)
    except InputError as error:
        raise UnreadableFileError(f"its application has no answer here: {listed(error)}") from None
    export = Export(application, selection, to_link(application), catalogue=catalogue)
    return Told(lines, None, export, _reader_of(form, content, export, lines), parts, link)


def _today(own: Export, catalogue: Catalogue) -> Export:
    """The same export with what is calculated today; a saved file keeps its title block."""
    try:
        selection = _solved(own.application, catalogue, own.chosen)
    except InputError as error:
        raise UnreadableFileError(f"its application has no answer here: {listed(error)}") from None
    return replace(own, selection=structs.replace(selection, link=own.selection.link), reply=b"")


def _solved(application: Application, catalogue: Catalogue, chosen: str = "") -> Selection:
    """The answer of today; a chosen gear that the ratios and sizes leave out comes last, as in a file."""
    selection = select(application, catalogue, to_link)
    if chosen and selection.candidate(chosen) is None:
        left_out = judge(application, catalogue).left_out()
        beyond = (candidate for candidate in left_out if candidate.designation == chosen)
        selection = structs.replace(selection, candidates=(*selection.candidates, *beyond))
    return selection


def _linked(form: Format, content: bytes) -> tuple[str, Application]:
    """The link that a file shows, and its application."""
    links = form.read("links_of", content)
    for link in links:
        found = link_reader.parse(parse_qsl(urlsplit(link).query, keep_blank_values=True, max_num_fields=200_000))
        if found.application is not None:
            return link, found.application
    leads = f"leads to {links[0]}, which" if links else "has no link that"
    raise UnreadableFileError(
        f"the {form.name} is of an earlier version, carries no application, and {leads} has none either: save the JSON "
        "of that selection from the service, and name it with --application"
    )


def _reader_of(form: Format, content: bytes, export: Export, lines: Sequence[Shown]) -> Reader:
    """Language and units of a file that does not name them: those in which today's has most of its lines."""
    languages = [form.read("language_of", content)] if form is PDF else list(LANGUAGES)
    shown = {line.words for line in lines}
    readers = [Reader(lang, units, DIGITS) for lang in languages if lang in LANGUAGES for units in PRESETS.values()]

    def common(reader: Reader) -> int:
        return sum(line.words in shown for line in form.lines(form.made(export, reader)))

    return max(readers or [Reader(digits=DIGITS)], key=common)


def _printed_versions(lines: Iterable[Shown]) -> FileVersions:
    """FileVersions that stand in the lines of a file: a hash of 16 digits, and what stands behind “Engine”."""
    stripped = (word.strip(",;·|:") for line in lines for word in line.text.split())
    words = [word for word in stripped if word]
    catalogue = next((word for word in words if len(word) == 16 and _is_hash(word)), None)
    engine = next((b for a, b in pairwise(words) if a in ("Engine", "Rechenkern")), None)
    return FileVersions(engine, catalogue)


def _is_hash(word: str) -> bool:
    return all(character in "0123456789abcdef" for character in word)


# --- A file of these versions -----------------------------------------------------------------------------------------


def _of_answer(told: Told) -> Iterator[Finding]:
    """Figures of the answer inside a file that are not calculated here: it was altered."""
    assert told.own is not None
    for one in differing(fields_of(told.parts[RESULT]), told.today.selection):
        yield Finding(f"{RESULT}{one.pointer}", str(one.saved), str(one.today), ("file",))


def _strictly(pairs: Iterable[Pair], *, is_rounded: bool) -> Iterator[Finding]:
    """Lines that differ in any letter or figure; figures with every digit to 1e-12."""
    for line, other in pairs:
        if line is None or other is None or not (line.text == other.text or (not is_rounded and is_exact(line, other))):
            place = (line or other or Shown("", "")).place
            yield Finding(place, line.text if line else "", other.text if other else "", ("file",))
        elif line.behind != other.behind:
            yield Finding(line.place, line.behind, other.behind, ("file",))


def _of_pages(form: Format, content: bytes, again: bytes) -> Iterator[Finding]:
    """Pages whose text is the same, and whose strokes, letters or notes are not."""
    if form.read("maker_of", content) != form.read("maker_of", again):
        return
    pages = zip(form.read("drawn_on", content), form.read("drawn_on", again), strict=False)
    for number, (one, other) in enumerate(pages, 1):
        if one != other:
            yield Finding(f"page {number}", "a drawing, letter or note that differs from its text", "", ("file",))


# --- A file of other versions -----------------------------------------------------------------------------------------


def _leniently(
    told: Told, mark: str, lines: Sequence[Shown], again: Sequence[Shown], own: Sequence[Shown]
) -> tuple[list[Finding], list[Shown]]:
    """Figures that differ where the wording is the same; of other lines those whose figures are not found today."""
    found, unchecked = list[Finding](), list[Shown]()
    today = Today.of(told.today.account, told.reader, mark, again)
    reasons = _reasons(told)
    for line, other in beside(lines, again):
        if line is None:
            continue
        other = other or with_same_words(line, again, mark)
        if _is_link(line):
            if told.link and re.sub(r"\s", "", line.text.rpartition("| ")[2]) not in told.link:
                found.append(Finding(line.place, line.text, told.link, ("file",)))
        elif other is not None:
            if not is_alike(line, other, mark):
                before = with_same_words(line, own, mark)
                is_altered = before is not None and not is_alike(line, before, mark)
                found.append(Finding(line.place, line.text, other.text, ("file",) if is_altered else reasons))
        elif calculated := today.other_value(line):
            found.append(Finding(line.place, line.text, calculated, reasons))
        elif calculated is None and not today.has_all(line):
            unchecked.append(line)
    return found, unchecked


def _is_link(line: Shown) -> bool:
    """True for the line of the link, which an application is read from."""
    return re.search("https?://", line.text) is not None


def _as_here(told: Told) -> Iterator[Shown]:
    """Lines of a file with the versions of here in place of its own, which it does not have wrong."""
    versions, catalogue = told.versions, told.today.selection.catalogue_version
    for line in told.lines:
        text = line.text.replace(versions.engine or ENGINE_VERSION, ENGINE_VERSION)
        yield replace(line, text=text.replace(versions.catalogue or catalogue, catalogue))


def _unchecked(lines: Sequence[Shown]) -> Iterator[str]:
    """Lines that can't be checked; figures without a word, such as those of an axis, in one for each place."""
    bare = [line for line in lines if not any(map(str.isalpha, line.text))]
    yield from (f"{line.place}: {line.text}" for line in lines if line not in bare)
    for place in dict.fromkeys(line.place for line in bare):
        texts = ", ".join(line.text for line in bare if line.place == place)
        yield f"{place}, figures without a word: {texts}"


def _reasons(told: Told) -> tuple[Reason, ...]:
    """Reasons for figures that differ; the limits in the answer tell which of two, where they are known."""
    reasons = told.versions.reasons(told.today.selection.catalogue_version)
    if len(reasons) < 2 or told.own is None:
        return reasons
    before, after = ([(c.code, c.limit) for c in export.candidate.checks] for export in (told.own, told.today))
    return ("engine",) if before == after else ("catalogue",)
