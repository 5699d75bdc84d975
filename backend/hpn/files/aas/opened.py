"""Sizing of Power Drive Trains (IDTA 02021) as somebody sends it, to an application: AASX or JSON.

Elements are found by their meanings, whatever their short ids; a number may be typed as an integer or a double. The
motion comes out of the sections: each stretch of one acceleration is a phase, its torque that of the load's inertia,
friction and weight, and of what acts from outside. Where `application.json`, to which the package leads, has the same
sections, it is the application itself, with all that the template has no place for. What is not used is listed.
"""

import csv
import io
import math
import re
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from io import BytesIO
from typing import Any

import numpy as np
from pydantic import ValidationError

from hpn.application import Application
from hpn.application.faults import pointer, sentences_of
from hpn.files.aas.courses import LINEAR, LOADS, ROTATIVE, MotionSection, sections_of
from hpn.files.aas.derived import cycle_of
from hpn.files.aas.sizing_ids import SIZING, meaning
from hpn.files.aas.tree import UNREADABLE, Element, submodels_of
from hpn.tables.sheets import RefusedError
from hpn.words.wording import N_, Sentence

MAGIC, MARKS = b"PK\x03\x04", (b"aasx/", b"aasx-origin")
IN_JSON = (b'"submodelElements"', b'"modelType"')
MOST_PARTS, MOST_BYTES, MOST_ROWS = 1000, 50_000_000, 100_000

NO_SIZING = N_("the Asset Administration Shell has no Sizing of Power Drive Trains (IDTA 02021)")
NO_MOTION = N_("the sizing has no section of a motion with its course as CSV: give the phases here")
TOO_LARGE = N_("the package unpacks to more than {most} MB: leave out what is no sizing")
NO_COURSE = N_("{section}: its course can’t be read: it takes numbers in SI units, under the columns {columns}")
NO_UNIT = N_("{section}: {column} is in {unit}, and has to be in SI units")


@dataclass(frozen=True, slots=True)
class OpenedSizing:
    """JSON of an application, and the elements of which nothing was taken; or the problem why there is none."""

    text: str = ""
    unused: tuple[str, ...] = ()
    problem: Sentence | None = None


def is_shell(content: bytes) -> bool:
    """True for a package, or JSON, of an Asset Administration Shell."""
    if content.startswith(MAGIC):
        return any(mark in content for mark in MARKS)
    return content.lstrip()[:1] == b"{" and all(mark in content for mark in IN_JSON)


def opened(content: bytes) -> OpenedSizing:
    """Application of a package or JSON, or the problem with it; raises nothing but MemoryError."""
    try:
        return _Sizing(content).opened()
    except RefusedError as refused:
        return OpenedSizing(problem=refused.sentence)
    except ValidationError as error:
        at, sentence, _ = sentences_of(error)[0]
        return OpenedSizing(problem=Sentence(N_("{field}: {message}"), {"field": pointer(at), "message": sentence}))
    except MemoryError:
        raise
    except Exception:  # whatever the libraries meet in a broken file
        return OpenedSizing(problem=Sentence(UNREADABLE))


@dataclass(slots=True)
class _Sizing:
    """A sizing under way: parts of its package, and the elements that were taken so far."""

    content: bytes
    parts: Mapping[str, bytes] = field(default_factory=dict)
    taken: set[int] = field(default_factory=set)

    def opened(self) -> OpenedSizing:
        self.parts = _unpacked(self.content) if self.content.startswith(MAGIC) else {"": self.content}
        sizing = next(self._sizings(), None)
        if sizing is None:
            raise RefusedError(NO_SIZING)
        sections = list(self._sections(sizing))
        application = self._carried(sizing, sections)
        if application is None:
            if not sections:
                raise RefusedError(NO_MOTION)
            application = Application.model_validate(self._derived(sizing, sections))
        text = application.model_dump_json(exclude_none=True)
        return OpenedSizing(text, tuple(_unused(sizing, self.taken)))

    def _sizings(self) -> Iterator[Element]:
        for name, part in self.parts.items():
            if (not name or name.endswith((".xml", ".json"))) and SIZING.encode() in part:
                yield from (each for each in submodels_of(part) if SIZING in each.meanings)

    def _take(self, element: Element, *names: str) -> Element | None:
        """First part along these short ids of the template, which counts as taken."""
        found: Element | None = element
        for name in names:
            found = next(found.of(meaning(name)), None) if found else None
        if found is not None:
            self.taken.add(id(found))
        return found

    def _number(self, element: Element, name: str) -> float | None:
        found = self._take(element, name)
        return None if found is None or not found.value else _float(found.value, name)

    # --- Motion -------------------------------------------------------------------------------------------------------

    def _sections(self, sizing: Element) -> Iterator[MotionSection]:
        pattern = self._take(sizing, "ApplicationRequirements", "MotionPattern", "MotionPatternSections")
        for part in pattern.parts if pattern else ():
            for kind, metadata, columns in (
                ("RotativeSection", "MetadataRotativeMotionFile", ROTATIVE),
                ("LinearSection", "MetadataLinearMotionFile", LINEAR),
            ):
                if meaning(kind) in part.meanings:
                    yield self._section(part, kind, metadata, columns)

    def _section(self, part: Element, kind: str, metadata: str, columns: Sequence[str]) -> MotionSection:
        wanted = [*columns, *ACTING]
        file, described = self._take(part, "MotionSectionFile"), self._take(part, metadata)
        known = _columns_of(described, part.name) if described else {}
        self.taken |= {*known.values()}
        content = self.parts.get((file.value or "").lstrip("/")) if file else None
        if content is None:
            raise RefusedError(NO_COURSE, section=part.name, columns=", ".join(columns[:3]))
        names, rows = _course(content, part.name, [name for name in wanted if name in known] or list(columns))
        constants = {name: value for name in CONSTANTS if (value := self._number(part, name)) is not None}
        return MotionSection(kind, metadata, constants, names, rows)

    def _derived(self, sizing: Element, sections: Sequence[MotionSection]) -> dict[str, Any]:
        mechanism = next(iter(part.parts), None) if (part := self._take(sizing, "TransformationMechanism")) else None
        values = {}
        if mechanism is not None:
            values = {n: value for n in OF_MECHANISM if (value := self._number(mechanism, n)) is not None}
        cycle = cycle_of(sections, values)
        loads = any("radial_N" in phase or "axial_N" in phase for phase in cycle["phases"])
        degrees = self._ambient(sizing)
        asked = {"requirements": {"ambient_temperature_degC": degrees}} if degrees is not None else {}
        return {"duty_cycle": cycle, **({"output_load": {}} if loads else {}), **asked}

    def _ambient(self, sizing: Element) -> float | None:
        span = self._take(sizing, "ApplicationRequirements", "Environmental", "AmbientTemperatureMotor")
        value = span and (span.largest or span.value)
        return _float(value, "AmbientTemperatureMotor") if value else None

    # --- The application that the package carries ---------------------------------------------------------------------

    def _carried(self, sizing: Element, sections: Sequence[MotionSection]) -> Application | None:
        """The application of `application.json` where its motion is that of the sections; None for any other."""
        information = next(sizing.of(meaning("SizingProjectInformation")), None)
        for link in information.of(meaning("SizingProjectLink")) if information else ():
            content = self.parts.get((link.value or "").lstrip("/"))
            try:
                application = Application.model_validate_json(content or b"")
            except ValidationError:
                continue
            own = list(sections_of(application.duty_cycle))
            if len(own) == len(sections) and all(map(_is_same, own, sections)):
                self.taken.add(id(link))
                self._ambient(sizing)
                return application
        return None


CONSTANTS = (
    *("FrictionTorque", "AxialForce", "RadialForce", "MomentOfInertiaOfLoad", "LoadTorque"),
    *("FrictionCoefficient", "FrictionForce", "CompensationForce", "LoadMass", "LoadSideForce", "CounterMass"),
)
"""Elements that hold for a whole section."""
OF_MECHANISM = (
    *("Efficiency", "InertiaMotorSide", "NoLoadTorque", "InclinationAngle", "FrictionCoefficient"),
    *("FeedConstant", "DiameterPinion"),
)
"""Elements that are read of a mechanism."""

SAME = 1e-9
"""Relative difference below which two courses are the same: whoever hands them on may round."""


def _is_same(one: MotionSection, other: MotionSection) -> bool:
    if one.kind != other.kind or one.rows.shape != other.rows.shape or list(one.columns) != list(other.columns):
        return False
    names = {*one.constants, *other.constants}
    constants = all(
        math.isclose(one.constants.get(name, 0.0), other.constants.get(name, 0.0), rel_tol=SAME) for name in names
    )
    room = SAME * np.abs(one.rows).max(axis=0, initial=1e-300)
    return constants and bool((np.abs(one.rows - other.rows) <= room).all())


def _unused(element: Element, taken: set[int], path: str = "") -> Iterator[str]:
    """Paths of elements in which nothing was taken."""
    for part in element.parts:
        if not (part.name or part.meanings):
            continue
        place = "/".join(filter(None, (path, part.name or part.meanings[0])))
        if id(part) in taken and not part.parts:
            continue
        if _has_taken(part, taken):
            yield from _unused(part, taken, place)
        else:
            yield place[:200]


def _has_taken(element: Element, taken: set[int]) -> bool:
    return id(element) in taken or any(_has_taken(part, taken) for part in element.parts)


# --- Package, numbers, courses ----------------------------------------------------------------------------------------


def _unpacked(content: bytes) -> Mapping[str, bytes]:
    with zipfile.ZipFile(BytesIO(content)) as package:
        entries = package.infolist()
        # The zip module unpacks no more of a part than is declared here.
        if len(entries) > MOST_PARTS or sum(entry.file_size for entry in entries) > MOST_BYTES:
            raise RefusedError(TOO_LARGE, most=MOST_BYTES // 1_000_000)
        return {entry.filename.lstrip("/"): package.read(entry) for entry in entries}


_LEADING = re.compile(r"\s*([-+]?[0-9]{1,40}(?:[.,][0-9]{1,40})?(?:[eE][-+]?[0-9]{1,3})?)\s*(.{0,40})", re.S)
SI = {"", "s", "rad", "rad/s", "rad/s²", "rad/s^2", "m", "m/s", "m/s²", "m/s^2", "N", "Nm", "kg", "kg m²", "kgm²", "%"}


def _float(text: str, name: str) -> float:
    """A number, an integer or not, with or without its unit in SI."""
    found = _LEADING.fullmatch(text[:200])
    value = float(found[1].replace(",", ".")) if found else math.nan
    if not math.isfinite(value) or found is None:
        raise RefusedError(N_("{field}: {value} is no number"), field=name, value=repr(text[:40]))
    return value


def _columns_of(described: Element, section: str) -> dict[str, int]:
    """Columns that the metadata of a section name, and the element of each; raises where one is not in SI units."""
    known = {}
    for part in described.parts:
        name = next((name for name in NAMED if meaning(name).strip() in part.meanings), None)
        if name is None:
            continue
        found = _LEADING.fullmatch(part.value or "1")
        if found is None or found[2].strip() not in SI or float(found[1].replace(",", ".")) != 1:
            raise RefusedError(NO_UNIT, section=section, column=name, unit=repr((part.value or "")[:40]))
        known[name] = id(part)
    return known


ACTING = (*LOADS, "FrictionTorque", "FrictionForce", "LoadSideForce")
NAMED = (*ROTATIVE, *LINEAR[1:], *ACTING, "AngularJerk", "LinearJerk")
"""Columns that a course may have."""


def _course(content: bytes, section: str, columns: Sequence[str]) -> tuple[list[str], Any]:
    """Columns and rows of a course; raises RefusedError. Without a header its columns are those of the metadata."""
    refused = RefusedError(NO_COURSE, section=section, columns=", ".join(columns[:3]))
    try:
        lines = content.decode("utf-8-sig").splitlines()
        separator = max(",;\t", key=lines[0].count)
        rows = list(csv.reader(io.StringIO("\n".join(lines[: MOST_ROWS + 2])), delimiter=separator))
        names = [cell.strip() for cell in rows[0]]
        if any(name in NAMED for name in names):
            rows = rows[1:]
        else:
            names = list(columns)
        values = np.array([[float(cell) for cell in row] for row in rows if row], dtype=np.float64)
    except (UnicodeDecodeError, ValueError, IndexError, csv.Error):
        raise refused from None
    if values.ndim != 2 or not 2 <= len(values) <= MOST_ROWS or values.shape[1] != len(names):
        raise refused
    if not np.isfinite(values).all() or "Time" not in names or len({*names}) < len(names):
        raise refused
    return names, values
