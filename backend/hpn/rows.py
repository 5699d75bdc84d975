"""The candidates of a reply as JSON, which a request would spend most of its time on.

`reply.CandidateRow` says what a candidate looks like. No such object is made for each gear: its JSON is a template, and
each distinct number of a reply is spelled once.
"""

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, get_type_hints

import numpy as np
import orjson
from numpy.typing import NDArray

from hpn import checks as c
from hpn import duty as d
from hpn.bearing import L50_PER_L10
from hpn.catalogue import Catalogue, GearList
from hpn.checks import (
    CHECKS,
    FAIL,
    LOAD_CHECKS,
    STATUS,
    ByteArray,
    Evaluation,
    FloatArray,
    table_of,
    telling_decimals,
)
from hpn.compiled import compiled
from hpn.ranking import CANDIDATE_STATUS, SUITABLE, UNRATED
from hpn.reply import REASONS, CandidateRow, CheckRow, GearRow, ReserveRow, encode
from hpn.reserve import reserve_on

TextArray = NDArray[np.uint8]
PlaceArray = NDArray[np.int32]


def candidate_rows(evaluation: Evaluation, index: int, asked: tuple[int, ...]) -> memoryview:
    """CandidateRows of application `index`, best first, with the checks that it asks for, as JSON."""
    template, words = _template(asked), _words(evaluation.gears)
    count = len(evaluation.gears.rows)
    # Compiled code fills what it is given: to return an array costs ten times as much as to make one here.
    distinct = np.empty(count * template.numbers + _BEHIND)
    taken = np.empty((count, template.words + template.numbers), np.int32)
    found = _fill(
        index,
        template.checks,
        evaluation.duty.wishes,
        table_of(evaluation.gears),
        _curved(evaluation.gears, evaluation.catalogue),
        evaluation.numbers,
        evaluation.codes,
        evaluation.order,
        distinct,
        taken,
    )
    digits = np.frombuffer(orjson.dumps(distinct[: found + _BEHIND], option=orjson.OPT_SERIALIZE_NUMPY), np.uint8)
    rows = np.empty(count * (template.longest + words.longest * template.words) + 2 + _MOVE, np.uint8)
    end = _write(
        template.text,
        template.ends,
        template.takes,
        words.text,
        words.ends,
        words.gaps,
        digits,
        taken,
        rows,
    )
    return rows[:end].data


@lru_cache(maxsize=256)
def _curved(gears: GearList, catalogue: Catalogue) -> NDArray[np.bool_]:
    """Which gears a supplement gives an efficiency curve."""
    return np.array([gear.designation in catalogue.efficiency for gear in gears.rows])


# --- What a candidate is made of: a template whose gaps take words and numbers ----------------------------------------

_MARK = "\1"
"""Stands in a sentence where its number is to be put."""

_WORD, _SENTENCE, _NUMBER = range(3)
"""What a gap takes; a sentence takes a number itself."""

_LONGEST_NUMBER = 24
"""Characters of a double, written as short as it can be."""

_REASON_OF = (
    REASONS["suitable"],
    *[REASONS["unsuitable" if n == 1 else "unsuitable_more"] for n in range(1, c.COUNT + 1)],
)
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
"""Where each kind of word begins; a list of gears has three more kinds, one word for each gear: rank, sentence on an
unrated one, and GearRow."""


_RESERVE_AT, _CHECKS_AT, _STATES_AT = 10, 14, 5
"""Where among the numbers and words of a CandidateRow its reserve, its checks and their states begin."""


@dataclass(frozen=True)
class _Words:
    """Texts that gaps may take, as JSON, one behind the other; where each ends, and where in it a number belongs."""

    text: TextArray
    ends: NDArray[np.int64]
    gaps: NDArray[np.int64]
    longest: int


@dataclass(frozen=True)
class _Template:
    """JSON of a candidate with gaps: the text between them, where each part of it ends, and what each gap takes."""

    checks: NDArray[np.int64]
    text: TextArray
    ends: NDArray[np.int64]
    takes: TextArray
    words: int
    numbers: int
    longest: int
    """Bytes of a candidate, its words apart."""


_MOVE = 32
"""Bytes that are moved at once, needed or not: what is behind a text must be there to be read."""

_LONG, _BEHIND = 1.2345678901234567e300, 2
"""Behind the numbers of a reply so many of these are spelled, which nothing takes: as long together as a move."""


def _padded(text: bytes) -> TextArray:
    return np.frombuffer(text + bytes(_MOVE), np.uint8)


def _ends(parts: Sequence[bytes]) -> NDArray[np.int64]:
    return np.cumsum([0, *map(len, parts)])


@lru_cache(maxsize=256)
def _words(gears: GearList) -> _Words:
    ranks = [str(place + 1) for place in range(len(gears.rows))]
    unrated = [encode(REASONS["unrated"].format(name=gear.name)).decode() for gear in gears.rows]
    names = [_fields(GearRow(gear.designation, gear.size, gear.ratio, gear.stages)) for gear in gears.rows]
    words = [word.encode() for word in (*_FIXED_WORDS, *ranks, *unrated, *names)]
    ends = _ends(words)
    gaps = [
        start + word.find(_MARK.encode()) if _MARK.encode() in word else -1
        for start, word in zip(ends, words, strict=False)
    ]
    return _Words(_padded(b"".join(words)), ends, np.array(gaps), max(map(len, words)))


def _fields(row: GearRow) -> str:
    return encode(row).decode()[1:-1]


@lru_cache(maxsize=1024)
def _template(checks: tuple[int, ...]) -> _Template:
    kinds: Any = ("<word>", "<sentence>", "<number>")
    word, sentence, number = kinds
    numbers = {name for name, kind in get_type_hints(CandidateRow).items() if kind in (float, float | None)}
    fields = {name: number if name in numbers else word for name in CandidateRow.__struct_fields__}
    fields["reason"] = sentence
    fields["reserve"] = ReserveRow(*[number] * len(ReserveRow.__struct_fields__))
    fields["checks"] = [CheckRow(CHECKS[check].code, number, number, number, word) for check in checks]
    candidate = _fields(CandidateRow(**fields)).replace(_fields(GearRow(word, word, word, word)), f'"{word}"')
    parts = re.split('"(<[a-z]+>)"', f",{{{candidate}}}")
    takes = [kinds.index(kind) for kind in parts[1::2]]
    text = [part.encode() for part in parts[::2]]
    numbers_taken, words_taken = len(takes) - takes.count(_WORD), len(takes) - takes.count(_NUMBER)
    return _Template(
        checks=np.array(checks),
        text=_padded(b"".join(text)),
        ends=_ends(text),
        takes=np.array(takes, np.uint8),
        words=words_taken,
        numbers=numbers_taken,
        longest=sum(map(len, text)) + _LONGEST_NUMBER * numbers_taken,
    )


@compiled
def _fill(
    index: int,
    checks: NDArray[np.int64],
    wishes: FloatArray,
    gears: FloatArray,
    curved: NDArray[np.bool_],
    results: FloatArray,
    codes: ByteArray,
    order: NDArray[np.intp],
    distinct: FloatArray,
    taken: PlaceArray,
) -> int:
    """Find what fills the gaps of every candidate, best first, in the order of CandidateRow.

    `distinct` gets the distinct numbers; `taken`, shape (G, words + numbers), which words are taken, and which of the
    distinct numbers each number is. Gives how many distinct numbers there are.
    """
    count, words = gears.shape[0], _STATES_AT + checks.size
    numbers = np.empty((count, taken.shape[1] - words))
    for row in range(count):
        g = order[index, row]
        verdict, governs = codes[index, g, c.VERDICT], codes[index, g, c.GOVERNING]
        used = math.nan if verdict == UNRATED else results[index, g, governs, c.USED]
        bound = 100 * (wishes[index, d.UTILISATION] if governs < LOAD_CHECKS else 1.0)
        percent = np.round(100 * used, telling_decimals(100 * used, bound, 1))
        _fill_numbers(checks, results, used, percent, index, g, row, numbers)
        reserve = reserve_on(wishes, gears, results, curved[g], index, g)
        for driver in range(4):
            numbers[row, _RESERVE_AT + driver] = reserve[driver]
        taken[row, 0] = _OWN_WORD + 2 * count + g
        taken[row, 1] = _VERDICT_WORD + verdict
        taken[row, 2] = _OWN_WORD + row if verdict == SUITABLE else _NULL_WORD
        taken[row, 3] = _NULL_WORD if verdict == UNRATED else _CODE_WORD + governs
        taken[row, 4] = _OWN_WORD + count + g if verdict == UNRATED else _reason(codes, index, g, used, governs)
        for place in range(checks.size):
            taken[row, _STATES_AT + place] = _STATUS_WORD + codes[index, g, checks[place]]
    found = _each_once(numbers, distinct, taken[:, words:])
    distinct[found : found + _BEHIND] = _LONG
    return found


@compiled
def _fill_numbers(
    checks: NDArray[np.int64],
    results: FloatArray,
    used: float,
    percent: float,
    n: int,
    g: int,
    row: int,
    numbers: FloatArray,
) -> None:
    """Numbers of a candidate, but for its reserve."""
    figures = results[n, g, c.COUNT :].reshape(-1)
    numbers[row, 0], numbers[row, 1] = used, percent
    for place in range(5):
        numbers[row, 2 + place] = figures[place]
    numbers[row, 7] = figures[c.BEARING_L50] / L50_PER_L10
    numbers[row, 8], numbers[row, 9] = figures[c.MOTOR_PEAK], figures[c.MOTOR_RATED]
    for place in range(checks.size):
        for term in range(3):
            numbers[row, _CHECKS_AT + 3 * place + term] = results[n, g, checks[place], term]


@compiled
def _reason(codes: ByteArray, n: int, g: int, used: float, governing: int) -> int:
    """The sentence on a candidate that could be judged."""
    if math.isinf(used):
        return _NO_STOP_WORD
    failed = 0
    for check in range(c.COUNT):
        failed += codes[n, g, check] == FAIL
    return _REASON_WORD + c.COUNT * failed + governing


@compiled
def _each_once(numbers: FloatArray, distinct: FloatArray, places: PlaceArray) -> int:
    """Sort out numbers that recur, as most do: the distinct ones, where each is among them, and how many there are."""
    bits, known, found, size, shift = numbers.view(np.uint64), distinct.view(np.uint64), 0, 1, 64
    while size < 2 * numbers.size:
        size, shift = 2 * size, shift - 1
    slots = np.full(size, -1, np.int32)  # a hash table with open addresses
    for row in range(numbers.shape[0]):
        for gap in range(numbers.shape[1]):
            slot = np.int64((bits[row, gap] * _SPREAD) >> np.uint64(shift))
            while slots[slot] >= 0 and known[slots[slot]] != bits[row, gap]:
                slot = (slot + 1) % size
            if slots[slot] < 0:
                known[found], slots[slot] = bits[row, gap], found
                found += 1
            places[row, gap] = slots[slot]
    return found


_SPREAD = np.uint64(0x9E3779B97F4A7C15)
"""2^64 over the golden ratio: a product with it differs in its first bits wherever the factor differs."""


@compiled
def _write(
    text: TextArray,
    ends: NDArray[np.int64],
    takes: TextArray,
    words: TextArray,
    word_ends: NDArray[np.int64],
    word_gaps: NDArray[np.int64],
    digits: TextArray,
    taken: PlaceArray,
    rows: TextArray,
) -> int:
    """Write the list of candidates into `rows`, of distinct numbers as `digits`; gives where it ends."""
    starts, at = _starts(digits), 0
    first_number = np.sum(takes != _NUMBER)
    for row in range(taken.shape[0]):
        word, number = 0, first_number
        for gap in range(takes.size):
            at = _copy(text, ends[gap], ends[gap + 1], rows, at)
            if takes[gap] != _NUMBER:
                which, word = taken[row, word], word + 1
                start, inside, end = word_ends[which], word_gaps[which], word_ends[which + 1]
                if inside < 0:  # it has no place for a number
                    at = _copy(words, start, end, rows, at)
                    number += takes[gap] == _SENTENCE
                    continue
                at = _copy(words, start, inside, rows, at)
            place = taken[row, number]
            at = _copy(digits, starts[place], starts[place + 1] - 1, rows, at)
            number += 1
            if takes[gap] == _SENTENCE:
                at = _copy(words, inside + 1, end, rows, at)
        at = _copy(text, ends[-2], ends[-1], rows, at)
    rows[0], rows[at] = ord("["), ord("]")  # each row brings the comma before it
    return at + 1


@compiled
def _starts(digits: TextArray) -> PlaceArray:
    """Where each number of a list begins, and where one after the last would."""
    starts, found = np.empty(digits.size, np.int32), 1
    starts[0] = 1
    for place in range(digits.size):  # without a branch, which would be guessed wrong at every number
        starts[found] = place + 1
        found += (digits[place] == ord(",")) | (digits[place] == ord("]"))
    return starts


@compiled
def _copy(source: TextArray, start: int, end: int, rows: TextArray, at: int) -> int:
    """Copy in wide moves, which go beyond the end: what comes next is written over that."""
    into, since = np.uintp(at), np.uintp(start)  # without a sign, and by whole moves, the loop becomes few instructions
    for place in range(np.uintp((end - start + _MOVE - 1) // _MOVE * _MOVE)):
        rows[into + place] = source[since + place]
    return at + end - start
