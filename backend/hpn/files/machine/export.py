"""Machine for a file: its document, and whole selections of the axes with a page."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from functools import cached_property
from typing import NamedTuple

from pydantic import ValidationError

from hpn.application import Application, InputError
from hpn.catalogue import Catalogue
from hpn.documents.differences import DocumentDifferences, differences
from hpn.documents.gears import GearOrder
from hpn.documents.revision import Frozen, FrozenAxis
from hpn.documents.summary import Summary, order_of, summary_of
from hpn.engine.batch import judge_batch
from hpn.engine.selection import Judgement, Selection
from hpn.files.export import Export, ExportTitle
from hpn.words.wording import N_, Sentence

MOST_PAGES, MOST_FULL = 500, 100
"""Most axes with a page, and most axes with their whole calculation."""

AT_ONCE = 50
"""Most selections in memory at a time."""

_RANGE = re.compile(r"([0-9]{1,7})(?:-([0-9]{1,7}))?")
NONE = "none"

NOT_A_LIST = N_("must be numbers and ranges of axes, such as 3,7-20, or none")
NO_AXIS = N_("the machine has no such axis")
TOO_MANY = N_("the report has pages of at most {most} axes; choose some, such as 3,7-20")
TOO_MANY_FULL = N_("the report has the whole calculation of at most {most} axes; choose some, such as 3,7-20")


@dataclass(frozen=True)
class MachineExport:
    """Document, the catalogue of its answers, and the data that lead a reader back to it.

    `heading` has the label of the revision, none for the working copy. `created` is the moment of that revision,
    `moment` that of a file of the working copy. `before` is the previous revision with its label; the report marks
    the differences from it.
    """

    document: Frozen
    catalogue: Catalogue
    link: str
    heading: ExportTitle = field(default_factory=ExportTitle)
    created: datetime | None = None
    moment: datetime | None = None
    before: tuple[str, Frozen] | None = None

    @cached_property
    def summary(self) -> Summary:
        """Machine in brief."""
        return summary_of(self.document, self.catalogue)

    @cached_property
    def order(self) -> GearOrder:
        """Gears to order."""
        return order_of(self.document.axes, self.catalogue)

    @cached_property
    def since(self) -> DocumentDifferences | None:
        """Differences from the previous revision; None without one."""
        return differences(self.before[1], self.document) if self.before else None


class Pages(NamedTuple):
    """Axes with pages of their own, in the order of the machine; `full` for pages with the whole calculation."""

    axes: tuple[FrozenAxis, ...]
    full: bool = False


def pages_of(document: Frozen, axes: str | None = None, *, full: bool = False) -> Pages:
    """Axes with pages: those of a list such as `3,7-20`, by default all.

    Without a list, a machine with too many axes for pages gets none. Raises InputError for an invalid list, for a list
    that names a missing axis, and for too many axes.
    """
    most, template = (MOST_FULL, TOO_MANY_FULL) if full else (MOST_PAGES, TOO_MANY)
    if axes is None:
        if full and len(document.axes) > most:
            raise _wrong(template, most)
        return Pages(document.axes if len(document.axes) <= most else (), full)
    ranges = [] if axes.strip() == NONE else [_range(part.strip()) for part in axes.split(",")]
    chosen = tuple(axis for axis in document.axes if any(axis.number in numbers for numbers in ranges))
    numbers = {axis.number for axis in chosen}
    if any(not numbers.intersection(part) if len(part) > 1 else part[0] not in numbers for part in ranges):
        raise _wrong(NO_AXIS)
    if len(chosen) > most:
        raise _wrong(template, most)
    return Pages(chosen, full)


def _range(text: str) -> range:
    match = _RANGE.fullmatch(text)
    if match is None or (match[2] and int(match[2]) < int(match[1])):
        raise _wrong(NOT_A_LIST)
    return range(int(match[1]), int(match[2] or match[1]) + 1)


def _wrong(template: str, most: int = 0) -> InputError:
    return InputError((("axes",), Sentence(template, {"most": most} if most else {})))


# --- Selections of axes -----------------------------------------------------------------------------------------------


def exports_of(export: MachineExport, axes: Sequence[FrozenAxis]) -> Iterator[tuple[FrozenAxis, Export | None]]:
    """Axes with their selections under the catalogue of the document; None for an axis without an answer.

    Only AT_ONCE selections are in memory at a time.
    """
    for start in range(0, len(axes), AT_ONCE):
        some = axes[start : start + AT_ONCE]
        applications = [_application(axis) for axis in some]
        sound = [application for application in applications if application is not None]
        selections = iter(judge_batch(sound, export.catalogue, Judgement.selection))
        for axis, application in zip(some, applications, strict=True):
            selection = None if application is None else next(selections)
            if application is None or not isinstance(selection, Selection):
                yield axis, None
            else:
                yield axis, _export(export, axis, application, selection)


def _application(axis: FrozenAxis) -> Application | None:
    """Application of an axis; None for an open axis, and for an application of another version that is no longer
    valid."""
    if axis.answer.status == "open":
        return None
    try:
        return Application.model_validate_json(bytes(axis.resolved))
    except ValidationError:
        return None


def _export(export: MachineExport, axis: FrozenAxis, application: Application, selection: Selection) -> Export:
    heading = ExportTitle(
        axis.name or "", export.heading.reference, "", export.heading.revision, axis.ordering_code or ""
    )
    return Export(
        application=application,
        selection=selection,
        link=f"{export.link}/axes/{axis.number}",
        heading=heading,
        created=export.created,
        moment=export.moment,
        catalogue=export.catalogue,
        chosen=axis.answer.designation or "",
    )
