"""The reply of `POST /api/v1/select`, typed; writing it is what a request spends most of its time on.

The rows below say what a candidate looks like. They are not filled in for every gear: their JSON is a template, and all
numbers of a reply are written at once.
"""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, get_type_hints

import msgspec
import numpy as np
import orjson
from numpy.typing import NDArray

from hpn import checks as c
from hpn.bearing import L50_PER_L10
from hpn.catalogue import GearList
from hpn.checks import CHECKS, FAIL, STATUS, Evaluation
from hpn.compiled import compiled
from hpn.ranking import CANDIDATE_STATUS, SUITABLE, UNRATED, Ranking
from hpn.reserve import reserve_of
from hpn.wording import N_

FloatArray = NDArray[np.float64]
ByteArray = NDArray[np.uint8]

REASONS = {
    "suitable": N_("Every check passes; the closest is {check} at {percent} of its limit."),
    "unsuitable": N_("{check} is at {percent} of its limit."),
    "unsuitable_more": N_("{check} is at {percent} of its limit; checks that fail: {failed}."),
    "no_stop_allowed": N_("The emergency stop is so hard that not one is allowed (equation 17.9)."),
    "unrated": N_("Not rated: figures of {name} that the checks need are not published."),
}
"""Why a candidate stands where it does: templates of sentences."""


class CheckRow(msgspec.Struct):
    """One check of one candidate."""

    code: str
    demand: float | None
    limit: float | None
    utilisation: float | None
    status: str


class ReserveRow(msgspec.Struct):
    """How far each driver may grow (above 1) or must shrink (below 1) on one candidate, the others as given."""

    torque_factor: float | None
    speed_factor: float | None
    load_factor: float | None
    emergency_stop_torque_Nm: float | None


class CandidateRow(msgspec.Struct):
    """One gear, its verdict and why."""

    designation: str
    size: str
    ratio: int
    stages: int
    status: str
    rank: int | None
    utilisation: float | None
    governing_check: str | None
    reason: str
    average_input_speed_rpm: float
    maximum_input_speed_rpm: float
    life_L10_h: float | None
    momentary_peak_count: float | None
    bearing_life_L50_h: float | None
    bearing_life_L10_h: float | None
    motor_peak_torque_Nm: float
    motor_rated_torque_Nm: float
    reserve: ReserveRow
    checks: list[CheckRow]


class DutyRow(msgspec.Struct):
    """What the duty cycle comes to."""

    average_torque_Nm: float
    average_output_speed_rpm: float
    maximum_torque_Nm: float
    maximum_output_speed_rpm: float


class SelectReply(msgspec.Struct):
    """The whole reply."""

    engine_version: str
    catalogue_version: str
    link: str
    duty: DutyRow
    selected: str | None
    candidates: msgspec.Raw
    check_definitions: msgspec.Raw
    notices: list[dict[str, Any]]


encode = msgspec.json.Encoder().encode
"""Encode as JSON; NaN and infinity, which stand for unpublished and unlimited, become null."""


def candidate_rows(evaluation: Evaluation, ranking: Ranking, index: int) -> msgspec.Raw:
    """CandidateRows of application `index`, best first, as JSON."""
    template, words = _template(evaluation.asked(index)), _words(evaluation.gears)
    count = len(evaluation.gears.rows)
    numbers, chosen = np.empty((count, template.numbers)), np.empty((count, template.words), np.int64)
    _fill(
        template.checks,
        ranking.order[index],
        evaluation.terms[:, :, index],
        evaluation.status[:, index],
        evaluation.figures[:, index],
        reserve_of(evaluation)[:, index],
        ranking.status[index],
        ranking.utilisation[index],
        ranking.governing[index],
        numbers,
        chosen,
    )
    digits = _bytes(orjson.dumps(numbers.ravel(), option=orjson.OPT_SERIALIZE_NUMPY))
    (commas,) = (digits == ord(",")).nonzero()
    rows = np.empty(2 + count * (template.text.size + words.longest * template.words) + digits.size, np.uint8)
    end = _write(
        template.text,
        template.ends,
        template.takes,
        words.text,
        words.ends,
        words.gaps,
        digits,
        commas,
        chosen,
        rows,
    )
    return msgspec.Raw(rows[:end].tobytes())


# --- What a candidate is made of: a template whose gaps take words and numbers ----------------------------------------

_MARK = "\1"
"""Stands in a sentence where its number is to be put."""

_WORD, _SENTENCE, _NUMBER = range(3)
"""What a gap takes; a sentence takes a number itself."""

_REASON_OF = (REASONS["suitable"], *[REASONS["unsuitable" if n == 1 else "unsuitable_more"] for n in range(1, 18)])
"""By the number of checks that fail."""

_STATES = [f'"{status}"' for status in (*STATUS, *CANDIDATE_STATUS)]
_CODES = [f'"{check.code}"' for check in CHECKS]
_SENTENCES = [
    encode(template.format(check=check.explanation.title, percent=f"{_MARK} %", failed=failed))
    .decode()
    .replace("\\u0001", _MARK)
    for failed, template in enumerate(_REASON_OF)
    for check in CHECKS
]
_FIXED_WORDS = ["null", *_STATES, *_CODES, encode(REASONS["no_stop_allowed"]).decode(), *_SENTENCES]
_NULL_WORD, _STATUS_WORD, _VERDICT_WORD, _CODE_WORD = 0, 1, 1 + len(STATUS), 1 + len(_STATES)
_NO_STOP_WORD = _CODE_WORD + len(_CODES)
_REASON_WORD, _OWN_WORD = _NO_STOP_WORD + 1, len(_FIXED_WORDS)
"""Where each kind of word begins; a list of gears has five more kinds of its own, one word for each gear."""


@dataclass(frozen=True)
class _Words:
    """Texts that gaps may take, as JSON, one behind the other; where each ends, and where in it a number belongs."""

    text: ByteArray
    ends: NDArray[np.int64]
    gaps: NDArray[np.int64]
    longest: int


@dataclass(frozen=True)
class _Template:
    """JSON of a candidate with gaps: the text between them, where each part of it ends, and what each gap takes."""

    checks: NDArray[np.int64]
    text: ByteArray
    ends: NDArray[np.int64]
    takes: ByteArray
    words: int
    numbers: int


def _bytes(text: bytes) -> ByteArray:
    return np.frombuffer(text, np.uint8)


def _ends(parts: Sequence[bytes]) -> NDArray[np.int64]:
    return np.cumsum([0, *map(len, parts)])


@lru_cache(maxsize=256)
def _words(gears: GearList) -> _Words:
    ranks = [str(place + 1) for place in range(len(gears.rows))]
    unrated = [encode(REASONS["unrated"].format(name=gear.name)).decode() for gear in gears.rows]
    names = [encode(value).decode() for column in gears.names for value in column]
    words = [word.encode() for word in (*_FIXED_WORDS, *ranks, *unrated, *names)]
    ends = _ends(words)
    gaps = [
        start + word.find(_MARK.encode()) if _MARK.encode() in word else -1
        for start, word in zip(ends, words, strict=False)
    ]
    return _Words(_bytes(b"".join(words)), ends, np.array(gaps), max(map(len, words)))


@lru_cache(maxsize=1024)
def _template(checks: tuple[int, ...]) -> _Template:
    kinds: Any = ("<word>", "<sentence>", "<number>")
    word, sentence, number = kinds
    numbers = {name for name, kind in get_type_hints(CandidateRow).items() if kind in (float, float | None)}
    fields = {name: number if name in numbers else word for name in CandidateRow.__struct_fields__}
    fields["reason"] = sentence
    fields["reserve"] = ReserveRow(*[number] * len(ReserveRow.__struct_fields__))
    fields["checks"] = [CheckRow(CHECKS[check].code, number, number, number, word) for check in checks]
    parts = re.split('"(<[a-z]+>)"', encode(CandidateRow(**fields)).decode())
    takes = [kinds.index(kind) for kind in parts[1::2]]
    text = [part.encode() for part in parts[::2]]
    numbers_taken = len(takes) - takes.count(_WORD)
    words_taken = len(takes) - takes.count(_NUMBER)
    return _Template(
        np.array(checks), _bytes(b"".join(text)), _ends(text), np.array(takes, np.uint8), words_taken, numbers_taken
    )


@compiled
def _fill(
    checks: NDArray[np.int64],
    order: NDArray[np.intp],
    terms: FloatArray,
    status: NDArray[np.int8],
    figures: FloatArray,
    reserve: FloatArray,
    verdicts: NDArray[np.int8],
    utilisation: FloatArray,
    governing: NDArray[np.int8],
    numbers: FloatArray,
    words: NDArray[np.int64],
) -> None:
    """Numbers and words of every candidate, best first, in the order of CandidateRow."""
    count = order.size
    for row in range(count):
        g, value, word = order[row], numbers[row], words[row]
        verdict, check, failed = verdicts[g], governing[g], 0
        for place in range(17):
            failed += status[place, g] == FAIL
        value[0], value[1] = utilisation[g], np.round(100 * utilisation[g], 1)
        for place in range(5):
            value[2 + place] = figures[place, g]
        value[7] = figures[c.BEARING_L50, g] / L50_PER_L10
        value[8], value[9] = figures[c.MOTOR_PEAK, g], figures[c.MOTOR_RATED, g]
        for place in range(4):
            value[10 + place] = reserve[place, g]
            word[place] = _OWN_WORD + (2 + place) * count + g
        word[4] = _VERDICT_WORD + verdict
        word[5] = _OWN_WORD + row if verdict == SUITABLE else _NULL_WORD
        word[6] = _NULL_WORD if verdict == UNRATED else _CODE_WORD + check
        word[7] = _REASON_WORD + 17 * failed + check
        if verdict == UNRATED:
            word[7] = _OWN_WORD + count + g
        elif math.isinf(utilisation[g]):
            word[7] = _NO_STOP_WORD
        for place in range(checks.size):
            word[8 + place] = _STATUS_WORD + status[checks[place], g]
            for term in range(3):
                value[14 + 3 * place + term] = terms[term, checks[place], g]


@compiled
def _write(
    text: ByteArray,
    ends: NDArray[np.int64],
    takes: ByteArray,
    words: ByteArray,
    word_ends: NDArray[np.int64],
    word_gaps: NDArray[np.int64],
    digits: ByteArray,
    commas: NDArray[np.intp],
    chosen: NDArray[np.int64],
    rows: ByteArray,
) -> int:
    """Write the list of candidates; how long it is."""
    at, number = 0, 0
    for row in range(chosen.shape[0]):
        rows[at] = ord(",") if row else ord("[")
        at, place = at + 1, 0
        for gap in range(takes.size):
            at = _copy(text, ends[gap], ends[gap + 1], rows, at)
            if takes[gap] == _NUMBER:
                at = _copy_number(digits, commas, number, rows, at)
                number += 1
                continue
            start, inside, end = (
                word_ends[chosen[row, place]],
                word_gaps[chosen[row, place]],
                word_ends[chosen[row, place] + 1],
            )
            place += 1
            if inside >= 0:
                at = _copy(words, start, inside, rows, at)
                at = _copy_number(digits, commas, number, rows, at)
                number += 1
                start = inside + 1
            elif takes[gap] == _SENTENCE:  # which has no place for its number
                number += 1
            at = _copy(words, start, end, rows, at)
        at = _copy(text, ends[-2], ends[-1], rows, at)
    rows[at] = ord("]")
    return at + 1


@compiled
def _copy(source: ByteArray, start: int, end: int, rows: ByteArray, at: int) -> int:
    into, since = np.uintp(at), np.uintp(start)  # without a sign the loop becomes one move of memory
    for place in range(np.uintp(end - start)):
        rows[into + place] = source[since + place]
    return at + end - start


@compiled
def _copy_number(digits: ByteArray, commas: NDArray[np.intp], number: int, rows: ByteArray, at: int) -> int:
    start = commas[number - 1] + 1 if number else 1
    return _copy(digits, start, commas[number] if number < commas.size else digits.size - 1, rows, at)
