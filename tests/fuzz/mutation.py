"""Broken versions of valid inputs: bits, slices and tokens changed, repeated and nested, as a seed says."""

import re
from collections.abc import Callable, Sequence
from random import Random

LONGEST = 400_000
"""Bytes of an input; the limits of the service on bodies have tests of their own."""

PART = 2_000
"""Bytes in which a change looks for tokens."""

_TOKENS = re.compile(rb'"[^"\n]{0,80}"|[A-Za-z_]+|[0-9.eE+-]+|\s+|.', re.DOTALL)
_NUMBER = re.compile(rb"-?[0-9]+(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?")

NUMBERS: tuple[bytes, ...] = (
    *b"0 -0 +1 -1 0.1 .5 5. 007 1e3 1E-3 1e15 1e16 1e308 -1e308 1e309 1e-308 1e-320 5e-324 1e-400 1e99999999".split(),
    *b"1.7976931348623157e308 2147483648 9007199254740993 18446744073709551616 NaN nan Infinity -inf 1e 1e+".split(),
    *b"0x1F 0b1 1_000 1,5 1.234,5 1,234.5 1.234 1,234 1'234.5 1e1e1 1.2.3 --1 true null 0.30000000000000004".split(),
    *(
        text.encode()
        for text in ("1 234", "1\u00a0234", "1\u202f234", "1’234,5", "−1", "٣٫٥", "１２", "½", "²", "Ⅷ", "一")
    ),
    b"9" * 400,
    b"9" * 5_000,
    b"0." + b"0" * 2_000 + b"1",
    b"1" + b"0" * 60,
)
"""Numbers in all notations, and what looks like one."""

TEXTS: tuple[bytes, ...] = (
    *(
        text.encode()
        for text in (
            *("\x00", "\x01", "\x08", "\x0b", "\x0c", "\x1b[31m", "\x1c", "\x1f", "\x7f", "\x85", "\xa0", "\xad"),
            *("\u200b", "\u200e", "\u202e", "\u2028", "\u2029", "\u2066", "\ufeff", "\ufffd", "\uffff", "\U0010ffff"),
            *(
                "ß",
                "İ",
                "ǆ",
                "ﬁ",
                "Ω",
                "Å",
                "𝟙",
                "e\u0301",
                "\u0301" * 60,
                "👩‍👩‍👧",
                "🇩🇪",
                "漢字",
                "עברית",
                "عربى",
                "ไทย",
            ),
            *("<script>alert(1)</script>", "{{7*7}}", "{0}", "%s%n", "'; --", "=1+1", "../../x", "\\", '"', "'", "`"),
            *("\r\n", "\n\n", "\t", " ", "  ", "%", "%00", "%ff", "%u1234", "%25", "+", "&", "=", ";", ",", "#", "?"),
            *("\\u0000", "\\ud800", "\\udfff\\ud800", "\\x", "\\/", "__proto__", "constructor", "self", "None"),
        )
    ),
    *(b"\xff\xfe", b"\xc0\x80", b"\xed\xa0\x80", b"\xf4\x90\x80\x80", b"\xe2\x82", b"\x80", b"\xef\xbb\xbf"),
)
"""Text of every class of Unicode, bytes that are no UTF-8, and what has a meaning somewhere."""

OPENINGS = (b"[", b"{", b'{"a":', b"(", b'"', b"<", b"[[", b'{"duty_cycle":', b"--", b"%25")

Change = Callable[[Random, bytes, Sequence[bytes], Sequence[bytes]], bytes]


def mutated(random: Random, corpus: Sequence[bytes], words: Sequence[bytes]) -> bytes:
    """A valid input after some changes, most often one or two; `words` are the names and marks of its format.

    Half of the inputs get changes that keep the format, so that they arrive behind the parser.
    """
    content = random.choice(corpus)
    changes = random.choice((ROUGH, GENTLE))
    for _ in range(min(1 + int(random.expovariate(0.7)), 12)):
        content = random.choice(changes)(random, content, corpus, words)[:LONGEST]
    return content


def many(random: Random) -> int:
    """A count: a few, and of fifty one of up to 60,000."""
    return int(2 ** random.uniform(4, 16)) if random.random() < 0.02 else random.randint(1, 6)


def _word(random: Random, words: Sequence[bytes]) -> bytes:
    return random.choice(random.choice((NUMBERS, TEXTS, words)))


def _span(random: Random, content: bytes) -> tuple[int, int]:
    start = random.randrange(len(content) + 1)
    return start, min(len(content), start + int(2 ** (12 * random.random() ** 2)))


def _flip(random: Random, content: bytes, corpus: Sequence[bytes], words: Sequence[bytes]) -> bytes:
    changed = bytearray(content or b"\x00")
    for _ in range(random.randint(1, 4)):
        changed[random.randrange(len(changed))] ^= 1 << random.randrange(8)
    return bytes(changed)


def _cut(random: Random, content: bytes, corpus: Sequence[bytes], words: Sequence[bytes]) -> bytes:
    start, end = _span(random, content)
    return content[:start] + content[end:]


def _repeat(random: Random, content: bytes, corpus: Sequence[bytes], words: Sequence[bytes]) -> bytes:
    start, end = _span(random, content)
    return content[:start] + content[start:end] * (1 + many(random)) + content[end:]


def _insert(random: Random, content: bytes, corpus: Sequence[bytes], words: Sequence[bytes]) -> bytes:
    start = random.randrange(len(content) + 1)
    return content[:start] + _word(random, words) * random.choice((1, 1, 1, many(random))) + content[start:]


def _splice(random: Random, content: bytes, corpus: Sequence[bytes], words: Sequence[bytes]) -> bytes:
    other = random.choice(corpus)
    return content[: random.randrange(len(content) + 1)] + other[random.randrange(len(other) + 1) :]


def _replace_tokens(random: Random, content: bytes, corpus: Sequence[bytes], words: Sequence[bytes]) -> bytes:
    """Other tokens in place of some: what is left of the format is read, so that the change arrives behind it."""
    head, part, tail = _part(random, content)
    tokens = _TOKENS.findall(part) or [b""]
    for _ in range(random.randint(1, 3)):
        tokens[random.randrange(len(tokens))] = random.choice((_word(random, words), random.choice(tokens)))
    return head + b"".join(tokens) + tail


def _replace_number(random: Random, content: bytes, corpus: Sequence[bytes], words: Sequence[bytes]) -> bytes:
    return _with_number(random, content, random.choice(NUMBERS))


def _resize(random: Random, content: bytes, corpus: Sequence[bytes], words: Sequence[bytes]) -> bytes:
    """Another number, as every format writes it, where one stood."""
    notation = random.choice((b"%d", b"-%d", b"%de3", b"%de-9", b"0.%d", b"%d.0", b"%de300"))
    return _with_number(random, content, notation % random.randrange(1, 1000))


def _with_number(random: Random, content: bytes, other: bytes) -> bytes:
    head, part, tail = _part(random, content)
    numbers = list(_NUMBER.finditer(part))
    if not numbers:
        return content
    number = random.choice(numbers)
    return head + part[: number.start()] + other + part[number.end() :] + tail


def _exchange(random: Random, content: bytes, corpus: Sequence[bytes], words: Sequence[bytes]) -> bytes:
    """A name or number of the same format where another stood."""
    head, part, tail = _part(random, content)
    tokens = _TOKENS.findall(part)
    places = [place for place, token in enumerate(tokens) if len(token) > 1 or token.isalnum()]
    if places:
        tokens[random.choice(places)] = random.choice((tokens[random.choice(places)], random.choice(words)))
    return head + b"".join(tokens) + tail


def _part(random: Random, content: bytes) -> tuple[bytes, bytes, bytes]:
    """A long input in three: what is looked at costs no more than what is sent."""
    start = random.randrange(max(len(content) - PART, 0) + 1)
    return content[:start], content[start : start + PART], content[start + PART :]


def _nest(random: Random, content: bytes, corpus: Sequence[bytes], words: Sequence[bytes]) -> bytes:
    start = random.randrange(len(content) + 1)
    return content[:start] + random.choice(OPENINGS) * many(random) + content[start:]


ROUGH: tuple[Change, ...] = (_flip, _cut, _repeat, _insert, _splice, _nest, _replace_tokens, _replace_number)
GENTLE: tuple[Change, ...] = (_resize, _exchange)
