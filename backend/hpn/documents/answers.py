"""Answers of the axes of a document: the gear of each, with its verdict and figures."""

from collections.abc import Iterable, Sequence
from itertools import islice
from typing import Annotated, Any, Literal, NamedTuple

import msgspec
from msgspec import UNSET, structs
from pydantic import Field

from hpn import ENGINE_VERSION
from hpn.application import InputError
from hpn.application.faults import Location, pointer, sentences_of
from hpn.catalogue import Catalogue
from hpn.catalogue.ordering import OrderingCode, read_ordering_code
from hpn.documents.merge import Fault, Resolved
from hpn.engine.batch import judge_batch
from hpn.engine.candidates import Candidate, LifeOf
from hpn.engine.evaluation import STATUS, UNRATED, Evaluation
from hpn.engine.selection import Judgement, Selection
from hpn.physics.equations import FloatArray
from hpn.words.quantities import CANDIDATE
from hpn.words.reply import Reply, described, finite
from hpn.words.wording import N_, Sentence

AxisStatus = Literal["suitable", "unsuitable", "unrated", "open"]
MOST_FAULTS = 20
"""Most faults that are kept of an axis."""

NO_CANDIDATE = N_("{gear} is not a candidate: the selected ratios or sizes exclude it")


class AxisFault(Reply, frozen=True):
    """One fault of an axis."""

    pointer: Annotated[str, Field(description="JSON pointer into the resolved application, or to the ordering code.")]
    code: Annotated[str, Field(description="Code for programs.")]
    detail: Annotated[str, Field(description="Expected value or form.")]
    sentence: Annotated[Any, Field(description="The detail as template and values, for other languages.")] = None

    @classmethod
    def of(cls, faults: Iterable[Fault]) -> tuple["AxisFault", ...]:
        """Faults in stored form, at most MOST_FAULTS."""
        named = islice(faults, MOST_FAULTS)
        return tuple(cls.at(pointer(location), sentence, code) for location, sentence, code in named)

    @classmethod
    def at(cls, pointer: str, sentence: Sentence, code: str) -> "AxisFault":
        """Fault at a place."""
        return cls(pointer, code, sentence.text, msgspec.to_builtins(sentence))

    @property
    def wording(self) -> Sentence:
        """Sentence of the fault; an answer of an earlier version kept only its text."""
        if self.sentence is None:
            return Sentence("{text}", {"text": self.detail}, ("text",))
        return msgspec.convert(self.sentence, Sentence)

    @property
    def location(self) -> Location:
        """Place of the fault."""
        parts = (part.replace("~1", "/").replace("~0", "~") for part in self.pointer.split("/")[1:])
        return tuple(int(part) if part.isdecimal() and len(part) < 10 else part for part in parts)


class AxisQuestion(NamedTuple):
    """Resolved application of an axis, and the ordering code of its ordered gear, if any."""

    resolved: Resolved
    ordering_code: str | None = None


class AxisAnswer(Reply, frozen=True):
    """The gear of an axis: that of its ordering code, else the selected one, else the nearest miss.

    An open axis has none of the figures, and `faults` say why.
    """

    __pydantic_config__ = described(CANDIDATE)

    status: Annotated[AxisStatus, Field(description="Verdict on the gear; open where there is no answer.")]
    selected: Annotated[str | None, Field(description="Designation of the first suitable gear.")] = None
    designation: Annotated[str | None, Field(description="Gear of the figures.")] = None
    governing_check: str | None = None
    utilisation: float | None = None
    life_L10_h: float | None = None
    shortest_life_h: float | None = None
    shortest_life_of: LifeOf | None = None
    natural_frequency_Hz: float | None = None
    motor_torque_limit_Nm: float | None = None
    weight_kg: Annotated[float | None, Field(description="Mass of one gear.")] = None
    suitable: Annotated[int | None, Field(description="Number of suitable gears.")] = None
    runner_up: Annotated[str | None, Field(description="Designation of the second suitable gear.")] = None
    average_torque_Nm: Annotated[float | None, Field(description="Average torque T_av of the cycle.")] = None
    holds: Annotated[
        bool | None, Field(description="True: the gear passes over the whole tolerance; null without tolerances.")
    ] = None
    worst_utilisation: Annotated[float | None, Field(description="Utilisation of the gear in the worst case.")] = None
    worst_governing_check: Annotated[str | None, Field(description="Check with that utilisation.")] = None
    not_asked: Annotated[
        tuple[str, ...],
        Field(
            description="Paths of common values that are not applied, because the axis lacks an input that they need."
        ),
    ] = ()
    unknown: Annotated[
        tuple[str, ...], Field(description="Figures unknown to the version that made this answer; they are null.")
    ] = ()
    faults: Annotated[tuple[AxisFault, ...], Field(description="Reasons why the axis is open.")] = ()
    engine_version: Annotated[str, Field(description="Version of the calculation.")] = ENGINE_VERSION
    catalogue_version: Annotated[str, Field(description="Version of the catalogue.")] = ""


def answers(axes: Sequence[AxisQuestion], catalogue: Catalogue) -> list[AxisAnswer]:
    """Answers to axes, judged together; an axis whose application has a fault is open."""
    # Copies, so that axes with the same application keep their own codes.
    applications = [each and each.model_copy() for each in (question.resolved.application for question in axes)]
    codes = {id(each): question.ordering_code for each, question in zip(applications, axes, strict=True)}

    def answer_of_judged(judged: Judgement) -> AxisAnswer | InputError:
        return _answer(judged, codes[id(judged.application)])

    sound = [application for application in applications if application is not None]
    judged = iter(judge_batch(sound, catalogue, answer_of_judged))
    outcomes = (None if application is None else next(judged) for application in applications)
    return [_whole(question.resolved, answer, catalogue) for question, answer in zip(axes, outcomes, strict=True)]


def _whole(resolved: Resolved, answer: AxisAnswer | InputError | None, catalogue: Catalogue) -> AxisAnswer:
    if not isinstance(answer, AxisAnswer):
        faults = resolved.faults if answer is None else sentences_of(answer)
        answer = AxisAnswer("open", faults=AxisFault.of(faults))
    return structs.replace(answer, not_asked=resolved.not_asked, catalogue_version=catalogue.version)


def _answer(judged: Judgement, code: str | None) -> AxisAnswer | InputError:
    evaluation, index = judged.evaluation, judged.index
    try:
        gear = _foremost(evaluation, index) if code is None else _ordered(evaluation, code)
    except InputError as error:
        return error
    figures = evaluation.case.figures
    holds, worst, worst_check = judged.worst_of(gear)
    outcome, rows, verdict = judged.outcome(), evaluation.gears.rows, evaluation.verdict.item(index, gear)
    governing = evaluation.checks[evaluation.governing.item(index, gear)].code
    return AxisAnswer(
        status=STATUS[verdict],
        selected=outcome.selected,
        designation=rows[gear].designation,
        governing_check=None if verdict == UNRATED else governing,
        utilisation=finite(evaluation.utilisation.item(index, gear)),
        life_L10_h=_figure(figures.life_L10_h, index, gear),
        shortest_life_h=_figure(figures.shortest_life_h, index, gear),
        shortest_life_of=figures.shortest_life_of[index].tolist()[gear] or None,
        natural_frequency_Hz=_figure(figures.natural_frequency_Hz, index, gear),
        motor_torque_limit_Nm=_figure(figures.motor_torque_limit_Nm, index, gear),
        weight_kg=rows[gear].weight_kg,
        suitable=outcome.suitable,
        runner_up=rows[evaluation.order.item(index, 1)].designation if outcome.suitable > 1 else None,
        average_torque_Nm=finite(evaluation.case.duty.average_torque_Nm.item(index)),
        holds=holds,
        worst_utilisation=worst,
        worst_governing_check=worst_check,
    )


def answer_of(selection: Selection, candidate: Candidate, catalogue: Catalogue) -> AxisAnswer:
    """Answer of an axis from a whole selection, for the candidate that is shown first."""
    suitable = [each.designation for each in selection.candidates if each.status == "suitable"]
    worst = None if candidate.worst is UNSET else candidate.worst
    return AxisAnswer(
        status=candidate.status,
        selected=selection.selected,
        designation=candidate.designation,
        governing_check=candidate.governing_check,
        utilisation=candidate.utilisation,
        life_L10_h=candidate.life_L10_h,
        shortest_life_h=candidate.shortest_life_h,
        shortest_life_of=candidate.shortest_life_of,
        natural_frequency_Hz=candidate.natural_frequency_Hz,
        motor_torque_limit_Nm=candidate.motor_torque_limit_Nm,
        weight_kg=catalogue.by_designation[candidate.designation].weight_kg,
        suitable=len(suitable),
        runner_up=suitable[1] if len(suitable) > 1 else None,
        average_torque_Nm=selection.duty.average_torque_Nm,
        holds=None if worst is None else worst.status == "suitable",
        worst_utilisation=None if worst is None else worst.utilisation,
        worst_governing_check=None if worst is None else worst.governing_check,
        catalogue_version=catalogue.version,
    )


def _foremost(evaluation: Evaluation, index: int) -> int:
    """Place of the selected gear, else of the first gear that is judged or lacks only an input, as in a selection."""
    order = evaluation.order[index]
    judged = evaluation.is_judged[index] | evaluation.lacks_input[index]
    return int(order[judged[order].argmax()])


def _ordered(evaluation: Evaluation, text: str) -> int:
    """Place of the gear of an ordering code; raises InputError for an invalid code, or for a gear that is no
    candidate."""
    code = read_ordering_code(evaluation.catalogue, text)
    if isinstance(code, OrderingCode):
        names = [gear.designation for gear in evaluation.gears.rows]
        if code.gear.designation in names:
            return names.index(code.gear.designation)
        code = Sentence(NO_CANDIDATE, {"gear": code.gear.designation})
    raise InputError((("ordering_code",), code))


def _figure(values: FloatArray, index: int, gear: int) -> float | None:
    """Figure of a gear under an application, from an array that may hold one value for all gears."""
    return finite(values.item(index, gear if values.shape[1] > 1 else 0))
