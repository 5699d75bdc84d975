"""Simple arithmetic behind an equals sign in a typed cell: `=40*2`, `=(12+3,5)/2`.

A grammar of four operations over exact fractions; no interpreter sees the text.
"""

from collections.abc import Callable
from fractions import Fraction
from re import ASCII

from hpn.words.patterns import Pattern
from hpn.words.wording import N_, Sentence

LONGEST = 60
"""Characters of a text; each number in it is below 1e1000, so that no result grows slow to calculate."""

_TOKEN = Pattern(r"\s*(?:([0-9.,]+(?:[eE][+-]?[0-9]{1,3})?)|([-+*/()]))", LONGEST, ASCII)
_MARKS = str.maketrans({"\N{MINUS SIGN}": "-", "\N{EN DASH}": "-", "×": "*", "·": "*", "÷": "/"})
_WRONG = N_("can’t be calculated; write an expression such as =40*2")


class _WrongError(ValueError):
    """Error for a text that is not a sum; `sentence` describes a wrong number in it."""

    def __init__(self, sentence: Sentence | None = None) -> None:
        super().__init__()
        self.sentence = sentence


def worked_out(text: str, number_of: Callable[[str], str | Sentence | None]) -> str | Sentence:
    """Result of `=…` in plain notation, or an error message; `number_of` reads each number in the text."""
    if len(text) > LONGEST:
        return Sentence(_WRONG)
    try:
        value = _Sum(text.removeprefix("=").translate(_MARKS), number_of).value()
        number = float(value)
    except ZeroDivisionError:
        return Sentence(N_("divides by zero"))
    except OverflowError:
        return Sentence(N_("is too large"))
    except _WrongError as wrong:
        return wrong.sentence or Sentence(_WRONG)
    if value and not number:
        return Sentence(N_("is too small"))
    return repr(number).removesuffix(".0")


class _Sum:
    """A sum of products of signed numbers and brackets, read from the left."""

    def __init__(self, text: str, number_of: Callable[[str], str | Sentence | None]) -> None:
        self.rest, self.read, self.number, self.mark = text, number_of, "", ""
        self._step()

    def value(self) -> Fraction:
        """Value of the whole text; raises _WrongError and the errors of fractions."""
        value = self._sum()
        if self.number or self.mark:
            raise _WrongError
        return value

    def _step(self) -> None:
        if not self.rest.strip():
            self.number = self.mark = ""
            return
        token = _TOKEN.match(self.rest)
        if token is None:
            raise _WrongError
        self.number, self.mark = token[1] or "", token[2] or ""
        self.rest = self.rest[token.end() :]

    def _sum(self) -> Fraction:
        value = self._product()
        while self.mark and self.mark in "+-":
            sign = -1 if self.mark == "-" else 1
            self._step()
            value += sign * self._product()
        return value

    def _product(self) -> Fraction:
        value = self._factor()
        while self.mark and self.mark in "*/":
            divides = self.mark == "/"
            self._step()
            factor = self._factor()
            value = value / factor if divides else value * factor
        return value

    def _factor(self) -> Fraction:
        if self.mark and self.mark in "+-":
            sign = -1 if self.mark == "-" else 1
            self._step()
            return sign * self._factor()
        if self.mark == "(":
            self._step()
            value = self._sum()
            if self.mark != ")":
                raise _WrongError
        else:
            plain = self.read(self.number) if self.number else None
            if not isinstance(plain, str):
                raise _WrongError(plain)
            value = Fraction(plain)
        self._step()
        return value
