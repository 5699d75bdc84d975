"""Application from a Sizing of Power Drive Trains (IDTA 02021) in AASX or JSON.

Elements are found by their meanings, not by their short ids; a number may be typed as an integer or a double. The
sections give the motion: each stretch of constant acceleration is a phase. Its torque is that of the load's inertia,
friction and weight, and of the torques and forces from outside. Where the linked `application.json` has the same
sections, its application is taken whole, with all inputs that the template lacks. Unused elements are listed.
"""

import csv
import io
import math
import re
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from io import BytesIO
from itertools import chain
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
from hpn.words.wording import N_, Sentence, first_of

MAGIC, MARKS = b"PK\x03\x04", (b"aasx/", b"aasx-origin")
IN_JSON = (b'"submodelElements"', b'"modelType"')
MOST_PARTS, MOST_BYTES, MOST_ROWS = 1000, 50_000_000, 100_000

NO_SIZING = N_("the Asset Administration Shell has no Sizing of Power Drive Trains (IDTA 02021)")
NO_MOTION = N_("the sizing has no section of a motion with its course as CSV: give the phases here")
TOO_LARGE = N_("the package unpacks to more than {most} MB: leave out what is no sizing")
NO_COURSE = N_("{section}: its course can’t be read: it takes numbers in SI units, under the columns {columns}")
MISSING = N_(
    "In no phase, since no torque follows from it: {names}. Add what it does to the load, such as the weight of a mass "
    "off its centre, before you select."
)
NO_UNIT = N_("{section}: {column} is in {unit}, and has to be in SI units")


@dataclass(frozen=True, slots=True)
class OpenedSizing:
    """JSON of an application with the unused elements, or the problem that prevents it.

    `note` names those unused elements that act on the load: no phase includes their effect.
    """

    text: str = ""
    unused: tuple[str, ...] = ()
    problem: Sentence | None = None
    note: Sentence | None = None


def is_shell(content: bytes) -> bool:
    """True for a package, or JSON, of an Asset Administration Shell."""
    if content.startswith(MAGIC):
        return any(mark in content for mark in MARKS)
    return content.lstrip()[:1] == b"{" and all(mark in content for mark in IN_JSON)


def sizing_in(content: bytes) -> OpenedSizing:
    """Application of a package or JSON, or the problem with it; raises nothing but MemoryError."""
    try:
        return _Sizing(content).result()
    except RefusedError as refused:
        return OpenedSizing(problem=refused.sentence)
    except ValidationError as error:
        at, sentence, _ = sentences_of(error)[0]
        return OpenedSizing(problem=Sentence(N_("{field}: {message}"), {"field": pointer(at), "message": sentence}))
    except MemoryError:
        raise
    except Exception:  # any error of the libraries on a broken file
        return OpenedSizing(problem=Sentence(UNREADABLE))


@dataclass(slots=True)
class _Sizing:
    """Sizing in progress: parts of its package, and the ids of the elements taken so far."""

    content: bytes
    parts: Mapping[str, bytes] = field(default_factory=dict)
    used: set[int] = field(default_factory=set)

    def result(self) -> OpenedSizing:
        self.parts = _unpacked(self.content) if self.content.startswith(MAGIC) else {"": self.content}
        sizing = next(self._sizings(), None)
        if sizing is None:
            raise RefusedError(NO_SIZING)
        sections = list(self._sections(sizing))
        application, note = self._own_application(sizing, sections), None
        if application is None:
            if not sections:
                raise RefusedError(NO_MOTION)
            application = Application.model_validate(self._derived(sizing, sections))
            note = self._missing(sizing)
        text = application.model_dump_json(exclude_none=True)
        return OpenedSizing(text, tuple(_unused(sizing, self.used)), note=note)

    def _sizings(self) -> Iterator[Element]:
        for name, part in self.parts.items():
            if (not name or name.endswith((".xml", ".json"))) and SIZING.encode() in part:
                yield from (each for each in submodels_of(part) if SIZING in each.meanings)

    def _take(self, element: Element, *names: str) -> Element | None:
        """First part along these short ids of the template; it counts as taken."""
        part: Element | None = element
        for name in names:
            part = next(part.of(meaning(name)), None) if part else None
        if part is not None:
            self.used.add(id(part))
        return part

    def _number(self, element: Element, name: str) -> float | None:
        part = self._take(element, name)
        return None if part is None or not part.value else _float(part.value, name)

    def _missing(self, sizing: Element) -> Sentence | None:
        """Sentence about unused elements that act on the load; None where all of them are 0."""
        groups = [sizing.of(meaning(name)) for name in ("ApplicationRequirements", "TransformationMechanism")]
        parts = [part for element in chain(*groups) for part in _inside(element)]
        open_ = {known for part in parts if id(part) not in self.used and _is_given(part) for known in part.meanings}
        outside = [name for name in ON_LOAD if meaning(name).strip() in open_]
        return Sentence(MISSING, {"names": first_of(outside, len(outside))}) if outside else None

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
        candidates = [*columns, *ACTING]
        file, described = self._take(part, "MotionSectionFile"), self._take(part, metadata)
        known = _columns_of(described, part.name) if described else {}
        self.used |= {*known.values()}
        content = self.parts.get((file.value or "").lstrip("/")) if file else None
        if content is None:
            raise RefusedError(NO_COURSE, section=part.name, columns=", ".join(columns[:3]))
        names, rows = _course(content, part.name, [name for name in candidates if name in known] or list(columns))
        constants = {name: value for name in CONSTANTS if (value := self._number(part, name)) is not None}
        return MotionSection(kind, metadata, constants, names, rows)

    def _derived(self, sizing: Element, sections: Sequence[MotionSection]) -> dict[str, Any]:
        mechanism = next(iter(part.parts), None) if (part := self._take(sizing, "TransformationMechanism")) else None
        values = {}
        if mechanism is not None:
            names = OF_MECHANISM if any(each.kind == "LinearSection" for each in sections) else OF_ROTATION
            values = {n: value for n in names if (value := self._number(mechanism, n)) is not None}
            if not 0 < values.get("Efficiency", 1.0) <= 100:
                del values["Efficiency"]
                self.used.discard(id(next(mechanism.of(meaning("Efficiency")))))
        cycle = cycle_of(sections, values)
        loads = any("radial_N" in phase or "axial_N" in phase for phase in cycle["phases"])
        degrees = self._ambient(sizing)
        requirements = {"requirements": {"ambient_temperature_degC": degrees}} if degrees is not None else {}
        return {"duty_cycle": cycle, **({"output_load": {}} if loads else {}), **requirements}

    def _ambient(self, sizing: Element) -> float | None:
        span = self._take(sizing, "ApplicationRequirements", "Environmental", "AmbientTemperatureMotor")
        match = _LEADING.fullmatch((span.largest or span.value or "")[:200]) if span else None
        if match is None or match[2].strip() not in ("", "°C"):
            self.used.discard(id(span))
            return None
        return float(match[1].replace(",", "."))

    # --- The application that the package carries ---------------------------------------------------------------------

    def _own_application(self, sizing: Element, sections: Sequence[MotionSection]) -> Application | None:
        """Application of `application.json` where its motion is that of the sections; None for any other."""
        information = next(sizing.of(meaning("SizingProjectInformation")), None)
        for link in information.of(meaning("SizingProjectLink")) if information else ():
            content = self.parts.get((link.value or "").lstrip("/"))
            try:
                application = Application.model_validate_json(content or b"")
            except ValidationError:
                continue
            own = list(sections_of(application.duty_cycle))
            if len(own) == len(sections) and all(map(_is_same, own, sections)):
                self.used.add(id(link))
                self._ambient(sizing)
                return application
        return None


CONSTANTS = (
    *("FrictionTorque", "AxialForce", "RadialForce", "MomentOfInertiaOfLoad", "LoadTorque"),
    *("FrictionCoefficient", "FrictionForce", "LoadMass", "LoadSideForce", "CounterMass"),
)
"""Elements that are constant over a section."""
OF_ROTATION = ("Efficiency", "InertiaMotorSide", "NoLoadTorque")
OF_MECHANISM = (*OF_ROTATION, "InclinationAngle", "FrictionCoefficient", "FeedConstant", "DiameterPinion")
"""Elements read of a mechanism, with rotative sections only and with linear ones."""

ON_LOAD = (
    *("StaticEccentricity", "InclinationAngle", "CompensationForce", "LeverArmAxialForce", "LeverArmRadialForce"),
    *("HelixAngle", "Efficiency"),
)
"""Elements that change the load: named in a note where they were not taken."""

SAME = 1e-9
"""Relative difference below which two courses are the same: other tools may round."""


def _is_same(one: MotionSection, other: MotionSection) -> bool:
    if one.kind != other.kind or one.rows.shape != other.rows.shape or list(one.columns) != list(other.columns):
        return False
    names = {*one.constants, *other.constants}
    constants = all(
        math.isclose(one.constants.get(name, 0.0), other.constants.get(name, 0.0), rel_tol=SAME) for name in names
    )
    room = SAME * np.abs(one.rows).max(axis=0, initial=1e-300)
    return constants and bool((np.abs(one.rows - other.rows) <= room).all())


def _unused(element: Element, used: set[int], path: str = "") -> Iterator[str]:
    """Paths of unused elements: those without a taken element inside."""
    for part in element.parts:
        if not (part.name or part.meanings):
            continue
        place = "/".join(filter(None, (path, part.name or part.meanings[0])))
        if id(part) in used and not part.parts:
            continue
        if _has_used(part, used):
            yield from _unused(part, used, place)
        else:
            yield place[:200]


def _has_used(element: Element, used: set[int]) -> bool:
    return id(element) in used or any(_has_used(part, used) for part in element.parts)


# --- Package, numbers, courses ----------------------------------------------------------------------------------------


def _unpacked(content: bytes) -> Mapping[str, bytes]:
    with zipfile.ZipFile(BytesIO(content)) as package:
        entries = package.infolist()
        # The zip module unpacks no more of a part than its declared size.
        if len(entries) > MOST_PARTS or sum(entry.file_size for entry in entries) > MOST_BYTES:
            raise RefusedError(TOO_LARGE, most=MOST_BYTES // 1_000_000)
        return {entry.filename.lstrip("/"): package.read(entry) for entry in entries}


_LEADING = re.compile(r"\s*([-+]?[0-9]{1,40}(?:[.,][0-9]{1,40})?(?:[eE][-+]?[0-9]{1,3})?)\s*(.{0,40})", re.S)
SI = {
    *("", "s", "rad", "rad/s", "rad/s²", "rad/s^2", "m", "m/s", "m/s²", "m/s^2", "m/rev", "N", "Nm", "N·m", "N m"),
    *("kg", "kg m²", "kgm²", "kg·m²", "kg m^2", "kgm^2", "kg*m^2", "%", "1"),
}


def _float(text: str, name: str) -> float:
    """Number, integer or not, with or without its SI unit; raises RefusedError for any other text."""
    match = _LEADING.fullmatch(text[:200])
    value = float(match[1].replace(",", ".")) if match else math.nan
    if not math.isfinite(value) or match is None:
        raise RefusedError(N_("{field}: {value} is no number"), field=name, value=repr(text[:40]))
    if match[2].strip() not in SI:
        raise RefusedError(N_("{field} is in {unit}, and has to be in SI units"), field=name, unit=repr(match[2]))
    return value


def _is_given(element: Element) -> bool:
    """True for an element with a value other than 0, and for any efficiency: a 0 there is a share cut to an integer."""
    match = _LEADING.fullmatch((element.value or "")[:200])
    counts = match is None or float(match[1].replace(",", ".")) != 0 or meaning("Efficiency") in element.meanings
    return bool(element.value) and counts


def _inside(element: Element) -> Iterator[Element]:
    """Elements inside another, at any depth."""
    for part in element.parts:
        yield part
        yield from _inside(part)


def _columns_of(described: Element, section: str) -> dict[str, int]:
    """Columns in the metadata of a section, with the ids of their elements; raises RefusedError unless all are
    in SI."""
    known = {}
    for part in described.parts:
        name = next((name for name in NAMED if meaning(name).strip() in part.meanings), None)
        if name is None:
            continue
        match = _LEADING.fullmatch(part.value or "1")
        if match is None or match[2].strip() not in SI or float(match[1].replace(",", ".")) != 1:
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
