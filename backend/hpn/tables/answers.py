"""Answers to the questions about a table in the form that programs send: `Moment:T`, `3:Nm`, `decimal:,`."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any, TypeVar

from hpn.tables.columns import ANY, SKIP, Choices, Column
from hpn.tables.inputs import Inputs
from hpn.words import spellings, units
from hpn.words.wording import N_, Sentence

NAMES = tuple(part.name for part in fields(Choices) if part.type is str and part.name != "of")
"""Questions about a table as a whole."""

NO_ANSWER = N_("{answer}: must be a column and what it is, or a question and its answer, with a colon between them")
NO_COLUMN = N_("{answer}: the table has no column {name}, neither by heading nor by number")
TWO_COLUMNS = N_("{answer}: the table has several columns {name}; name this one by its number")
TWO_ANSWERS = N_("{answer}: an earlier answer about {name} is another")
NO_MEANING = N_("{answer}: {meaning} is neither an input, such as T or torque_Nm, nor a unit, such as Nm, nor skip")
MOST_SHOWN = 60


@dataclass(frozen=True, slots=True)
class Answers:
    """Answers as given: about the whole table, about columns by their names, and faults for texts without an answer."""

    whole: Choices = field(default_factory=lambda: Choices(of=ANY))
    columns: Sequence[tuple[str, str]] = ()
    faults: tuple[Sentence, ...] = ()


def answers_of(texts: Sequence[str]) -> Answers:
    """Answers from texts with a colon between column and meaning, or between question and answer."""
    pairs = [(name.strip(), meaning.strip()) for name, _, meaning in (text.rpartition(":") for text in texts)]
    whole, faults = dict[str, Any](), list[Sentence]()
    for text, (name, meaning) in zip(texts, pairs, strict=True):
        if not name:
            faults.append(_refusal(NO_ANSWER, text))
        elif name in NAMES and whole.setdefault(name, meaning) != meaning:
            faults.append(_refusal(TWO_ANSWERS, text, name=name))
    columns = [pair for pair in pairs if pair[0] and pair[0] not in NAMES]
    return Answers(Choices(of=ANY, **whole), columns, tuple(faults))


T = TypeVar("T")


def reading_by_answers(
    texts: Sequence[str], inputs: Inputs, read: Callable[[Choices], T], columns_of: Callable[[T], Sequence[Column]]
) -> tuple[T, tuple[Sentence, ...]]:
    """A reading by a program's answers, and their faults; answers about columns need a first reading."""
    answers = answers_of(texts)
    reading = read(answers.whole)
    columns = columns_of(reading)
    if columns and answers.columns:
        answers = about(columns, answers, inputs)
        reading = read(answers.whole)
    return reading, answers.faults


def about(columns: Sequence[Column], answers: Answers, inputs: Inputs) -> Answers:
    """The answers, those about columns by their places, and their faults."""
    roles, of_units, faults = dict[int, str](), dict[int, str](), list(answers.faults)
    called = ((name, each.role) for each in inputs.by_role.values() for name in (each.place, each.role))
    meanings = {SKIP: SKIP, **dict(called)}  # by the symbol of links, or the name of the column for `hpn fleet`
    for name, meaning in answers.columns:
        text = f"{name}:{meaning}"
        places = _places(columns, name)
        codes = (meaning,) if meaning in units.QUANTITY_OF else spellings.codes_for(meaning)
        if len(places) != 1:
            faults.append(_refusal(TWO_COLUMNS if places else NO_COLUMN, text, name=name))
        elif meaning not in meanings and len(codes) != 1:
            faults.append(_refusal(NO_MEANING, text, meaning=meaning))
        else:
            kept, value = (roles, meanings[meaning]) if meaning in meanings else (of_units, codes[0])
            if kept.setdefault(places[0], value) != value:
                faults.append(_refusal(TWO_ANSWERS, text, name=name))
    return Answers(replace(answers.whole, roles=roles, units=of_units), (), tuple(faults))


def _places(columns: Sequence[Column], name: str) -> list[int]:
    """Places of the columns with a heading, else with a number that counts from 1."""
    places = [column.place for column in columns if column.heading.casefold() == " ".join(name.split()).casefold()]
    return places or [column.place for column in columns if name == str(column.place + 1)]


def _refusal(template: str, answer: str, **values: str) -> Sentence:
    return Sentence(template, {name: text[:MOST_SHOWN] for name, text in {"answer": answer, **values}.items()})
