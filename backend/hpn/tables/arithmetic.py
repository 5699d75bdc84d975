"""Simple arithmetic behind an equals sign, as people type it into a cell: `=40*2`, `=(12+3,5)/2`.

A grammar of four operations over exact fractions; nothing of it is handed to an interpreter.
"""

from collections.abc import Callable
from fractions import Fraction
from re import ASCII

from hpn.words.patterns import Pattern
from hpn.words.wording import N_, Sentence

LONGEST = 60
"""Characters; each number in them is below 1e1000, so that no result is large enough to take long."""

_TOKEN = Pattern(r"\s*(?:([0-9.,]+(?:[eE][+-]?[0-9]{1,3})?)|([-+*/()]))", LONGEST, ASCII)
_MARKS = str.maketrans({"\N{MINUS SIGN}": "-", "\N{EN DASH}": "-", "×": "*", "·": "*", "÷": "/"})
_WRONG = N_("can’t be calculated; write an expression such as =40*2")


class _WrongError(ValueError):
    """The text is no sum; `told` says what is wrong with a number in it."""

    def __init__(self, sentence: Sentence | None = None) -> None:
        super().__init__()
        self.told = sentence


def worked_out(text: str, number_of: Callable[[str], str | Sentence | None]) -> str | Sentence:
    """Number in plain notation that `=…` comes to, or what is wrong with it; `read` reads a number in it."""
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
        return wrong.told or Sentence(_WRONG)
    if value and not number:
        return Sentence(N_("is too small"))
    return repr(number).removesuffix(".0")


class _Sum:
    """A sum of products of signed numbers and brackets, read from the left."""

    def __init__(self, text: str, number_of: Callable[[str], str | Sentence | None]) -> None:
        self.rest, self.read, self.number, self.mark = text, number_of, "", ""
        self._step()

    def value(self) -> Fraction:
        """The whole text's value; raises _WrongError and what fractions raise."""
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
