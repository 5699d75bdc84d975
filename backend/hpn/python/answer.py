"""Selection of a gear: `hpn.select` and its answer."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import msgspec

from hpn.application import Application
from hpn.engine.candidates import Candidate
from hpn.engine.notice import Notice
from hpn.engine.selection import DutyFigures, Selection, encode
from hpn.engine.selection import select as selection_of
from hpn.links.writer import to_link
from hpn.python import html
from hpn.python.faults import with_application_errors
from hpn.python.gears import Gears

ROWS = 10
"""Most candidates that a notebook shows."""


@dataclass(frozen=True, eq=False, repr=False)
class Answer:
    """Answer to an application: the selection as from `POST /api/v1/select`, and the application.

    Iterable and indexed by candidates, the best first.
    """

    application: Application
    selection: Selection
    gears: Gears

    @property
    def selected(self) -> str | None:
        """Designation of the first suitable gear, or None."""
        return self.selection.selected

    @property
    def candidates(self) -> Sequence[Candidate]:
        """All gears considered, the best first, each with its checks."""
        return self.selection.candidates

    @property
    def duty(self) -> DutyFigures:
        """Figures of the duty cycle."""
        return self.selection.duty

    @property
    def notices(self) -> Sequence[Notice]:
        """Assumptions and remarks."""
        return self.selection.notices

    @property
    def link(self) -> str:
        """Path and query of the application's page."""
        return self.selection.link

    def candidate(self, designation: str) -> Candidate:
        """Candidate with a designation in any spelling; raises KeyError where it was not considered."""
        candidate = self.selection.candidate(self.gears[designation].designation)
        if candidate is None:
            raise KeyError(f"{designation} is none of the gears that were asked for")
        return candidate

    def columns(self) -> dict[str, list[Any]]:
        """Figures of the candidates by column, in the form that every library of data frames takes."""
        rows = self.to_dict()["candidates"]
        names = [name for name, value in rows[0].items() if not isinstance(value, list | dict)]
        return {name: [row[name] for row in rows] for name in names}

    def to_json(self) -> str:
        """Reply of `POST /api/v1/select`, byte for byte."""
        return encode(self.selection).decode()

    def to_dict(self) -> dict[str, Any]:
        """Reply as plain data."""
        plain: dict[str, Any] = msgspec.json.decode(encode(self.selection))
        return plain

    def __repr__(self) -> str:
        return f"<hpn.Answer: {self._verdict}>"

    @property
    def _verdict(self) -> str:
        best = self.selection.foremost
        return f"{self.selected or f'no gear is suitable; nearest {best.designation}'}: {best.reason}"

    def _repr_html_(self) -> str:
        best, definitions = self.selection.foremost, self.selection.check_definitions
        checks = [
            (
                definitions[one.code].title,
                one.demand,
                one.limit,
                definitions[one.code].unit,
                _percent(one.utilisation),
                one.status,
            )
            for one in best.checks
        ]
        gears = [(one.designation, one.status, _percent(one.utilisation), one.reason) for one in self.candidates]
        heads = ("check", "demand", "limit", "unit", "utilisation", "status")
        return html.table(self._verdict, heads, checks) + html.table(
            f"{min(ROWS, len(gears))} of {len(gears)} gears considered",
            ("gear", "status", "utilisation", "reason"),
            gears[:ROWS],
        )


def _percent(utilisation: float | None) -> str | None:
    return None if utilisation is None else f"{100 * utilisation:.1f} %"


def select(application: Application | Mapping[str, Any], *, catalogue: Gears | None = None, samples: int = 0) -> Answer:
    """Answer to an application.

        answer = hpn.select({"duty_cycle": {"phases": [{"torque_Nm": 40, "speed_rpm": 250, "duration_s": 0.3}]}})
        answer.selected, answer.candidates[0].utilisation

    `application` has the fields of `POST /api/v1/select`. `catalogue` comes from `hpn.catalogue(…)`, by default the one
    of the settings; `samples` is the number of points tried inside the tolerances for the share of failures.
    Raises `hpn.ApplicationError` for an application without an answer.
    """
    known = Gears.of() if catalogue is None else catalogue
    with with_application_errors():
        question = application if isinstance(application, Application) else Application.model_validate(application)
        return Answer(question, selection_of(question, known.catalogue, to_link, samples), known)
