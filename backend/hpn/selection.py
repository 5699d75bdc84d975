"""From an application and the catalogue to a ranked list of candidates, each with its checks and a reason."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from msgspec import Raw
from msgspec.json import decode

from hpn import ENGINE_VERSION
from hpn import duty as d
from hpn.application import Application, InputError, Location, OutputLoad
from hpn.catalogue import Catalogue, GearList
from hpn.checks import CHECKS, GOVERNING, USED, VERDICT, Evaluation
from hpn.duty import Duty
from hpn.notices import Notice, notices_of
from hpn.ranking import SUITABLE, evaluate
from hpn.reply import DutyRow, SelectReply, encode
from hpn.rows import candidate_rows
from hpn.wording import N_, Sentence


@dataclass(slots=True)
class Selection:
    """The answer to one application, which is number `index` of an evaluation; `json` is the reply of the API."""

    application: Application
    catalogue: Catalogue
    evaluation: Evaluation
    index: int = 0

    @property
    def gears(self) -> GearList:
        """The candidates in catalogue order."""
        return self.evaluation.gears

    @property
    def load(self) -> OutputLoad | None:
        """Conditions of the output load, or None where there is none."""
        return self.evaluation.duty.loads[self.index]

    @property
    def best(self) -> int | None:
        """Index of the selected gear among the candidates, or None where none is suitable."""
        first = self.evaluation.order.item(self.index, 0)
        return first if self.evaluation.codes.item(self.index, first, VERDICT) == SUITABLE else None

    @property
    def selected(self) -> str | None:
        """Designation of the selected gear, or None."""
        return None if (best := self.best) is None else self.gears.rows[best].designation

    @property
    def notices(self) -> list[Notice]:
        """What the reader must know beyond the numbers."""
        return notices_of(self.evaluation, self.index)

    def json(self, link: str) -> bytes:
        """The reply of `POST /api/v1/select` as JSON; unlimited, infinite and unpublished values are null."""
        evaluation, index = self.evaluation, self.index
        asked = evaluation.asked(index)
        return encode(
            SelectReply(
                engine_version=ENGINE_VERSION,
                catalogue_version=self.catalogue.version,
                link=link,
                duty=DutyRow(*evaluation.duty.figures[index, : d.T_RMS].tolist()),
                selected=self.selected,
                candidates=Raw(candidate_rows(evaluation, index, asked)),
                check_definitions=check_definitions(asked),
                notices=[{"code": notice.code, "text": notice.text} for notice in self.notices],
            )
        )

    def reply(self, link: str) -> dict[str, Any]:
        """The same as plain Python values."""
        reply: dict[str, Any] = decode(self.json(link))
        return reply

    def summary(self, link: str) -> dict[str, Any]:
        """One line of a batch: the selected gear, how close it is to its limits, and how many gears are suitable."""
        best, evaluation, index = self.best, self.evaluation, self.index
        governing = used = None
        if best is not None:
            check = evaluation.codes.item(index, best, GOVERNING)
            governing, used = CHECKS[check].code, evaluation.numbers.item(index, best, check, USED)
        return {
            "status": "ok",
            "selected": self.selected,
            "governing_check": governing,
            "utilisation": used,
            "suitable": int((evaluation.codes[index, :, VERDICT] == SUITABLE).sum()),
            "link": link,
        }


def select(application: Application, catalogue: Catalogue) -> Selection:
    """Evaluate every gear that the application allows, and rank them.

    Raises InputError for a ratio or size that the catalogue lacks, for a combination that leaves no gear, and for the
    digitised bearing model where no candidate has curve points.
    """
    gears = candidates_of(application, catalogue)
    return Selection(application, catalogue, evaluate(Duty([application]), gears, catalogue))


NOT_THERE = N_("the catalogue has no {value}; there are {listed}")


def candidates_of(application: Application, catalogue: Catalogue) -> GearList:
    """Gears that `ratios` and `sizes` leave; raises InputError as `select` does."""
    asked, load = application.requirements, application.output_load
    gears = _restricted(catalogue, asked.sizes, asked.ratios)
    if load is not None and load.model == "digitised" and not any(gears.curves):
        raise InputError(
            (
                ("output_load", "model"),
                Sentence(
                    "no candidate has points of a printed curve: put them into bearing_envelopes.csv of a catalogue "
                    "supplement (setting HPN_CATALOGUE_SUPPLEMENT), or choose linear or iso281"
                ),
            )
        )
    return gears


@lru_cache(maxsize=256)
def _restricted(catalogue: Catalogue, sizes: tuple[str, ...] | None, ratios: tuple[int, ...] | None) -> GearList:
    for wanted, there in ((sizes, catalogue.sizes), (ratios, catalogue.ratios)):
        if wanted is not None and not set(there).issuperset(wanted):
            raise _not_there(sizes or (), ratios or (), catalogue)
    gears = catalogue.restricted(sizes, ratios)
    if not gears.rows:
        offered = "; ".join(
            f"{size}: {', '.join(str(gear.ratio) for gear in catalogue.gears if gear.size == size)}"
            for size in sizes or ()
        )
        raise InputError(
            (
                ("requirements", "ratios"),
                Sentence("no gear has such a size and ratio together; there are {offered}", {"offered": offered}),
            )
        )
    return gears


def _not_there(sizes: Sequence[str], ratios: Sequence[int], catalogue: Catalogue) -> InputError:
    problems: list[tuple[Location, Sentence]] = [
        (
            ("requirements", name, index),
            Sentence(NOT_THERE, {"value": str(value), "listed": ", ".join(map(str, there))}),
        )
        for name, wanted, there in (("sizes", sizes, catalogue.sizes), ("ratios", ratios, catalogue.ratios))
        for index, value in enumerate(wanted)
        if value not in there
    ]
    return InputError(*problems)


@lru_cache(maxsize=1024)
def check_definitions(checks: tuple[int, ...]) -> Raw:
    """What is the same for every candidate, by check code, as JSON."""
    return Raw(encode({CHECKS[check].code: CHECKS[check].explanation for check in checks}))
