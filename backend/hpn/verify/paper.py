"""Verification of a report, workbook or package: made again from its parts or its link, and compared line by line."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, zip_longest
from pkgutil import resolve_name
from typing import Any

from msgspec import MsgspecError, structs
from pydantic import ValidationError

from hpn import ENGINE_VERSION
from hpn.application import Application, InputError
from hpn.catalogue import Catalogue
from hpn.engine.kept import UnreadableReplyError, fields_of
from hpn.engine.selection import Selection, select, with_gear
from hpn.files import formats
from hpn.files.carried import APPLICATION, DOCUMENT, RESULT, export_of
from hpn.files.export import DIGITS, Export
from hpn.files.formats import FileFormat
from hpn.installed import require
from hpn.links.writer import to_link
from hpn.verify.package import gear_in
from hpn.verify.shown import (
    POINT,
    FileLine,
    FileSubject,
    Pair,
    UnreadableFileError,
    beside,
    differing,
    is_alike,
    is_exact,
    listed,
    subject_of,
    with_same_words,
)
from hpn.verify.today import Today
from hpn.verify.verdict import FileVersions, Finding, Verdict
from hpn.words.reader import LANGUAGES, Reader
from hpn.words.units import PRESETS

MOST_LINES = 400
"""Most lines of a file that are listed as unchecked."""

REPORT = "report.pdf"
"""Place of lines on the report in a package."""


@dataclass(frozen=True, slots=True)
class Format:
    """Format of files for verification: its name, the module that reads it, and the format that makes it."""

    name: str
    reader: str
    file: FileFormat

    def read(self, what: str, content: bytes) -> Any:
        """Part of a file, read by the named function of the module."""
        return resolve_name(f"{self.reader}:{what}")(content)

    def lines(self, content: bytes) -> list[FileLine]:
        """Lines of a file."""
        return list(self.read("lines_of", content))


PDF = Format("PDF", "hpn.verify.pdf", formats.PDF)
WORKBOOK = Format("workbook", "hpn.verify.workbook", formats.WORKBOOK)
PACKAGE = Format("package", "hpn.verify.package", formats.PACKAGE)


@dataclass(frozen=True, slots=True)
class FileContents:
    """File: its lines, the export that it was made of, and today's export.

    `own` is None for a file without an answer in it. `link` is the address that its application was read from.
    """

    lines: Sequence[FileLine]
    own: Export | None
    today: Export
    reader: Reader
    parts: Mapping[str, bytes]
    link: str = ""

    @property
    def versions(self) -> FileVersions:
        """Versions in the answer of the file, else in its lines."""
        if self.own is None:
            return _printed_versions(self.lines)
        return FileVersions(self.own.selection.engine_version, self.own.selection.catalogue_version)

    @property
    def is_of_here(self) -> bool:
        """True where calculation and catalogue are those of this installation, and the file carries all its parts."""
        here = FileVersions(ENGINE_VERSION, self.today.selection.catalogue_version)
        return self.own is not None and DOCUMENT in self.parts and self.versions == here


def verified(form: Format, content: bytes, catalogue: Catalogue, question: FileSubject | None) -> Verdict:
    """Verdict on a file of a format; `asked` is for a file that carries neither an application nor a link to one."""
    for extra in form.file.extras:
        require(extra)
    file = _contents_of(form, content, catalogue, question)
    again = form.file.content(file.today, file.reader)
    own = form.file.content(file.own, file.reader) if file.own and not file.is_of_here else b""
    findings, unchecked = _compared(form, file, content, again, own)
    if file.is_of_here:
        findings = [*_of_answer(file), *findings]
    if form is PACKAGE and (report := form.read("report_of", content)):
        others = (form.read("report_of", other) if other else b"" for other in (again, own))
        file, in_report, beyond = _of_report(file, report, *others)
        findings, unchecked = findings + in_report, unchecked + beyond
    return _verdict(form, file, findings, unchecked)


def _compared(
    form: Format, file: FileContents, content: bytes, again: bytes, own: bytes
) -> tuple[list[Finding], list[FileLine]]:
    """Figures that differ between a file and today's file, and lines that can't be checked.

    `own` is the file made again from the answer in a file of other versions.
    """
    if not file.is_of_here:
        mark = file.reader.decimal if form is PDF else POINT
        return _leniently(file, mark, list(_as_here(file)), form.lines(again), form.lines(own) if own else [])
    findings = list(_strictly(beside(file.lines, form.lines(again)), is_rounded=form is PDF))
    if form is not PDF or findings:
        return findings, []
    if form.read("maker_of", content) != form.read("maker_of", again):
        return [], [FileLine("all pages", "what is drawn, which another program than that of here has set")]
    return list(_of_pages(content, again)), []


def _of_report(
    file: FileContents, report: bytes, again: bytes, own: bytes
) -> tuple[FileContents, list[Finding], list[FileLine]]:
    """Package with the lines of its report after its own, the report's differences, and its unchecked lines.

    Without the extra of reports no report is made today.
    """
    if not again:
        return file, [], [FileLine(REPORT, "not checked without the extra report")]
    lines = PDF.lines(report)
    findings, unchecked = _compared(PDF, replace(file, lines=lines), report, again, own)
    return (
        replace(file, lines=[*file.lines, *lines]),
        [structs.replace(one, place=f"{REPORT}, {one.place}") for one in findings],
        [replace(line, place=f"{REPORT}, {line.place}") for line in unchecked],
    )


def _verdict(form: Format, file: FileContents, findings: list[Finding], unchecked: list[FileLine]) -> Verdict:
    left_out = sum(len(line.figures) for line in unchecked)
    same = sum(len(line.figures) for line in file.lines) - left_out - len(findings)
    texts = list(_unchecked(unchecked))
    if len(texts) > MOST_LINES:
        texts[MOST_LINES:] = [f"and {len(texts) - MOST_LINES} lines more"]
    return Verdict(form.name, file.versions, max(same, 0), tuple(findings), tuple(texts))


# --- Contents of a file -----------------------------------------------------------------------------------------------


def _contents_of(form: Format, content: bytes, catalogue: Catalogue, question: FileSubject | None) -> FileContents:
    parts, lines = form.read("parts_of", content), form.lines(content)
    if APPLICATION in parts and RESULT in parts:
        try:
            own, reader = export_of(parts, catalogue)
        except ValidationError as error:
            raise UnreadableFileError(f"the application in the {form.name} can’t be read: {listed(error)}") from None
        except (UnreadableReplyError, MsgspecError, UnicodeDecodeError) as error:
            raise UnreadableFileError(f"what the {form.name} carries of itself can’t be read: {error}") from None
        if DOCUMENT not in parts:
            own = replace(own, chosen=gear_in(lines))
        return FileContents(lines, own, _today(own, catalogue), reader, parts)
    link = ""
    if question is None:
        link, question = _linked(form, content)
    application, chosen = question.application, question.chosen
    try:
        selection = _solved(application, catalogue, chosen)
    except InputError as error:
        raise UnreadableFileError(f"its application has no answer here: {listed(error)}") from None
    export = Export(application, selection, to_link(application), catalogue=catalogue, chosen=chosen)
    return FileContents(lines, None, export, _reader_of(form, content, export, lines), parts, link)


def _today(own: Export, catalogue: Catalogue) -> Export:
    """Export with today's selection; a saved file keeps its title block."""
    try:
        selection = _solved(own.application, catalogue, own.chosen)
    except InputError as error:
        raise UnreadableFileError(f"its application has no answer here: {listed(error)}") from None
    return replace(own, selection=structs.replace(selection, link=own.selection.link), reply=b"")


def _solved(application: Application, catalogue: Catalogue, chosen: str) -> Selection:
    """Answer of today; a chosen gear outside the requested ratios and sizes comes last, as in a file."""
    return with_gear(select(application, catalogue, to_link), application, catalogue, chosen)


def _refusal(link: str) -> str:
    """Why a file with a link has no application, and what to save in its place; blank for a file of a selection."""
    path = link.partition("?")[0]
    if path.endswith("/revisions"):
        return "compares two revisions, of which the JSON alone is calculated again: save that of each"
    if path.split("/")[-2:-1] == ["machines"] and "/axes/" not in link:
        return "is of a machine, of which the JSON alone is calculated again: save that"
    return ""


def _linked(form: Format, content: bytes) -> tuple[str, FileSubject]:
    """Link of a file, and its application with the gear."""
    links = form.read("links_of", content)
    for link in links:
        if (question := subject_of(link)) is not None:
            return link, question
    if links and (refused := _refusal(links[0])):
        raise UnreadableFileError(f"the {form.name} {refused} from the service")
    lack = f"leads to {links[0]}, which has none either" if links else "has no link"
    raise UnreadableFileError(
        f"the {form.name} is of an earlier version, carries no application, and {lack}: save the JSON of that "
        "selection from the service, and name it with --application"
    )


def _reader_of(form: Format, content: bytes, export: Export, lines: Sequence[FileLine]) -> Reader:
    """Language and units of a file that does not name them: those in which today's file shares most lines with it."""
    languages = [form.read("language_of", content)] if form is PDF else list(LANGUAGES)
    words = {line.words for line in lines}
    readers = [Reader(lang, units, DIGITS) for lang in languages if lang in LANGUAGES for units in PRESETS.values()]

    def common(reader: Reader) -> int:
        return sum(line.words in words for line in form.lines(form.file.content(export, reader)))

    return max(readers or [Reader(digits=DIGITS)], key=common)


def _printed_versions(lines: Iterable[FileLine]) -> FileVersions:
    """Versions in the lines of a file: a hash of 16 digits, and the word after “Engine”."""
    stripped = (word.strip(",;·|:") for line in lines for word in line.text.split())
    words = [word for word in stripped if word]
    catalogue = next((word for word in words if re.fullmatch("[0-9a-f]{16}", word)), None)
    engine = next((b for a, b in pairwise(words) if a in ("Engine", "Rechenkern")), None)
    return FileVersions(engine, catalogue)


# --- A file of these versions -----------------------------------------------------------------------------------------


def _of_answer(file: FileContents) -> Iterator[Finding]:
    """Figures of the answer inside a file that differ from today's: the file was altered."""
    assert file.own is not None
    for one in differing(fields_of(file.parts[RESULT]), file.today.selection):
        yield Finding(f"{RESULT}{one.pointer}", str(one.saved), str(one.today), ("file",))


def _strictly(pairs: Iterable[Pair], *, is_rounded: bool) -> Iterator[Finding]:
    """Lines that differ in any letter or figure; figures with every digit are compared to 1e-12."""
    for line, other in pairs:
        if line is None or other is None or not (line.text == other.text or (not is_rounded and is_exact(line, other))):
            place = (line or other or FileLine("", "")).place
            yield Finding(place, line.text if line else "", other.text if other else "", ("file",))
        elif line.behind != other.behind:
            yield Finding(line.place, line.behind, other.behind, ("file",))


def _of_pages(content: bytes, again: bytes) -> Iterator[Finding]:
    """Pages with the same text and other strokes, letters or notes."""
    pages = zip_longest(PDF.read("drawn_on", content), PDF.read("drawn_on", again))
    for number, (one, other) in enumerate(pages, 1):
        if one != other:
            yield Finding(f"page {number}", "a drawing, letter or note that differs from its text", "", ("file",))


# --- A file of other versions -----------------------------------------------------------------------------------------


def _leniently(
    file: FileContents, mark: str, lines: Sequence[FileLine], again: Sequence[FileLine], own: Sequence[FileLine]
) -> tuple[list[Finding], list[FileLine]]:
    """Figures that differ where the wording is the same, and other lines whose figures are not found today."""
    findings, unchecked = list[Finding](), list[FileLine]()
    today = Today.of(file.today.account, file.reader, mark, again)
    exports = (file.own, file.today) if file.own is not None else ()
    limits = [[(check.code, check.limit) for check in export.candidate.checks] for export in exports]
    reasons = file.versions.reasons(file.today.selection.catalogue_version, *limits)
    for line, other in beside(lines, again):
        if line is None:
            continue
        other = other or with_same_words(line, again, mark)
        if re.search("https?://", line.text):
            if file.link and re.sub(r"\s", "", line.text.rpartition("| ")[2]) not in file.link:
                findings.append(Finding(line.place, line.text, file.link, ("file",)))
        elif other is not None:
            if not is_alike(line, other, mark):
                before = with_same_words(line, own, mark)
                is_altered = before is not None and not is_alike(line, before, mark)
                findings.append(Finding(line.place, line.text, other.text, ("file",) if is_altered else reasons))
        elif calculated := today.other_value(line):
            findings.append(Finding(line.place, line.text, calculated, reasons))
        elif calculated is None and not today.has_all(line):
            unchecked.append(line)
    return findings, unchecked


def _as_here(file: FileContents) -> Iterator[FileLine]:
    """Lines of a file with the versions of this installation in place of its own: other versions are no fault."""
    versions, catalogue = file.versions, file.today.selection.catalogue_version
    for line in file.lines:
        text = line.text.replace(versions.engine or ENGINE_VERSION, ENGINE_VERSION)
        yield replace(line, text=text.replace(versions.catalogue or catalogue, catalogue))


def _unchecked(lines: Sequence[FileLine]) -> Iterator[str]:
    """Texts of unchecked lines; figures without a word, such as those of a chart's axis, share a text for each
    place."""
    bare = [line for line in lines if not any(map(str.isalpha, line.text))]
    yield from (f"{line.place}: {line.text}" for line in lines if line not in bare)
    for place in dict.fromkeys(line.place for line in bare):
        texts = ", ".join(line.text for line in bare if line.place == place)
        yield f"{place}, figures without a word: {texts}"
