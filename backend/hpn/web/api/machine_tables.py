"""Machines from tables over REST: read as on the page /machines, with open questions as errors instead of a form."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from starlette.requests import Request

from hpn import ENGINE_VERSION
from hpn.application.faults import Fault
from hpn.catalogue import Catalogue
from hpn.documents.axis import MOST_AXES, MOST_PHASES
from hpn.fleet.beside import MachineReading, read_answered
from hpn.installed import ExtraMissingError, require
from hpn.store import MachineDraft
from hpn.tables.table import Choice, Table
from hpn.web.api.fleet import MEDIA_TYPES, READ_TYPES
from hpn.web.door.pools import compute, compute_beside
from hpn.web.door.problems import Problem
from hpn.web.fleets import worked
from hpn.web.machines import EXCESS
from hpn.words.wording import N_, Sentence

WORKBOOK = "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet"
TABLES = (*MEDIA_TYPES.values(), *READ_TYPES.values(), WORKBOOK)
"""Content types of tables; the content itself determines the format."""

ANSWER = ("answer",)
OPTIONS = N_("{question} Answer with answer={name}: and one of {options}.")


async def draft_of_table(request: Request, body: bytes, texts: Sequence[str]) -> MachineDraft:
    """Draft of a table's machine by answers to its questions; Problem 422 for open ones, 501 without the extra."""
    try:
        require("fleet")
    except ExtraMissingError as error:
        raise Problem(501, error.sentence) from None
    catalogue: Catalogue = request.app.state.catalogue
    reading = await compute(request, "pages", _reading, body, texts)
    reading_of_body, faults = await compute_beside(request, "files", reading)
    if faults:
        raise Problem(422, faults, [Fault(ANSWER, fault.text, "answer") for fault in faults])
    work = await compute(request, "pages", sizing_of, reading_of_body, catalogue)
    drafts = await worked(request, work)
    return MachineDraft(drafts, ENGINE_VERSION, catalogue.version, owner=request.state.api_key)


def _reading(body: bytes, texts: Sequence[str]) -> Callable[[], Any]:
    from hpn.web.axis_tables import BOUNDS  # Arrow takes half a second to import

    return partial(read_answered, body, BOUNDS, texts)


def sizing_of(reading: MachineReading, catalogue: Catalogue) -> Callable[[], Any]:
    """Call that sizes the axes of a reading; Problem 422 for an incomplete, unreadable or too large table."""
    from hpn.web.axis_tables import drafts_in

    if reading.refusal:
        raise Problem(422, reading.refusal)
    for what, count, most in (("axes", reading.axes, MOST_AXES), ("phases", reading.phases, MOST_PHASES)):
        if count > most:
            raise Problem(422, Sentence(EXCESS[what], {"most": str(most)}))
    if reading.reading.suffix:
        return partial(drafts_in, reading.rows, reading.faults, {}, catalogue)
    table = reading.reading.table
    assert table is not None
    require_whole(table)
    return partial(drafts_in, table.axes, (), dict(table.origins), catalogue)


def require_whole(table: Table) -> None:
    """Raise Problem 422 for a table that can't be read, or with all questions that are open."""
    if table.problem:
        raise Problem(422, table.problem)
    questions = [_with_options(question, table.choices) for question in table.questions]
    if questions:
        raise Problem(422, questions, [Fault(ANSWER, question.text, "question") for question in questions])


def _with_options(question: Sentence, choices: Sequence[Choice]) -> Sentence:
    """Question with the answers that it accepts; unchanged if it is not about a choice."""
    choice = next((each for each in choices if each.question == question and not each.chosen), None)
    if choice is None:
        return question
    return Sentence(OPTIONS, {"question": question, "name": choice.name, "options": ", ".join(choice.options)})
