"""Figures of today, used to find the figures of a file with other wording."""

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from hpn.account.account import Account
from hpn.explain.comparison import is_same
from hpn.verify.shown import FIGURE, FileLine, agrees, value_of
from hpn.words.reader import GROUP, Reader
from hpn.words.units import CHOICES, SYMBOLS

Token = tuple[str, str]
"""Figure and the word after it, mostly its unit."""

UNITS = frozenset((*SYMBOLS.values(), *(symbol for units in CHOICES.values() for symbol in units.values()), "%"))
DESIGNATION = re.compile("HPN-[0-9]")
SOURCE = "source"
OF_SOURCES = frozenset(
    (
        *("table", "Table", "Tab.", "Tabelle", "page", "Page", "p.", "Seite", "S."),
        *("eq.", "Gl.", "Equation", "equation", "Gleichung"),
    )
)
"""Words before the number of a table, page or equation."""

RELATIONS = frozenset("=≤≥<>·≈")
FORMULA = re.compile("[=·√→]")
MANY_DIGITS = 5
"""Least digits of a figure that is recognised without a unit."""


def named(line: FileLine) -> list[Token]:
    """Figures of a line with their units, and designations; letters with an index, such as L10, are names."""
    words = [word for word in re.split(rf"[ |]+|(?<![0-9]){GROUP}", line.text) if word]
    tokens: list[Token] = []
    for before, word, following in zip(["", *words], words, [*words[1:], ""], strict=False):
        plain = word.strip("()“”,;:.→−-+±>")
        if FIGURE.fullmatch(plain):
            unit = following.strip("().,;:")
            tokens.append((plain, unit if unit in UNITS else SOURCE if before.lstrip("(") in OF_SOURCES else ""))
        elif DESIGNATION.match(plain):
            tokens.append((plain, ""))
    return tokens


@dataclass(frozen=True, slots=True)
class Today:
    """Figures of today’s file, and values of the account by symbol and unit, with every digit."""

    tokens: frozenset[Token]
    values: Mapping[Token, float]
    relations: Mapping[str, tuple[float | None, float | None]]
    mark: str

    @classmethod
    def of(cls, account: Account, reader: Reader, mark: str, lines: Iterable[FileLine]) -> "Today":
        """Figures of an account, and of the lines of the file made of it."""
        tokens = frozenset(token for line in lines for token in named(line))
        return cls(tokens, dict(_by_symbol(account, reader)), dict(_by_relation(account, reader)), mark)

    def has(self, token: Token) -> bool:
        """True for a figure that today has too, rounded to its digits: with its unit, or by many digits."""
        figure, unit = token
        if token in self.tokens and (unit or not FIGURE.fullmatch(figure)):
            return True
        value = value_of(figure, self.mark) if FIGURE.fullmatch(figure) else None
        if value is None:
            return False
        if sum(map(str.isdigit, figure)) >= MANY_DIGITS and self._has_digits(value):
            return True
        known = (other for (_, of), other in self.values.items() if unit and of == unit)
        return any(agrees(figure, other, self.mark) for other in known)

    def has_all(self, line: FileLine) -> bool:
        """True for a line whose figures today has too; False for figures inside a formula, which can't be told."""
        return not (line.figures and FORMULA.search(line.text)) and all(map(self.has, named(line)))

    def _has_digits(self, value: float) -> bool:
        figures = (figure for figure, _ in self.tokens if FIGURE.fullmatch(figure))
        return any(is_same(value, value_of(figure, self.mark)) for figure in figures)

    def other_value(self, line: FileLine) -> str | None:
        """Values of today in place of the figures after a symbol or after the relation of a check.

        Blank where they agree, None for a line without a known symbol or relation.
        """
        text = re.sub(" +", " ", re.sub(r"[_|]", "", line.text))
        for relation, values in self.relations.items():
            if f"{relation} " in text:
                figures = FileLine("", text.partition(f"{relation} ")[2]).figures
                pairs = [(figure, value) for figure, value in zip(figures, values, strict=False) if value is not None]
                is_other = any(not agrees(figure, value, self.mark) for figure, value in pairs)
                return relation + "".join(f" {value:.12g}" for _, value in pairs) if is_other else ""
        words = text.split(" ")
        for before, symbol, figure, unit in zip(["", *words], words, words[1:], words[2:], strict=False):
            value = self.values.get((symbol, unit))
            if value is not None and FIGURE.fullmatch(figure) and before not in RELATIONS:
                return "" if agrees(figure, value, self.mark) else f"{symbol} {value:.12g} {unit}"
        return None


def _by_symbol(account: Account, reader: Reader) -> Iterator[tuple[Token, float]]:
    """Values by symbol and unit, without ranges."""
    lines = (*account.cycle, *account.figures, *account.published, *account.loads, *account.requirements)
    for line in lines:
        value = line.value_for(reader)
        if line.named.symbol and isinstance(value, float | int) and line.until is None:
            yield (line.named.symbol.replace("_", ""), reader.unit(line.unit)), float(value)


def _by_relation(account: Account, reader: Reader) -> Iterator[tuple[str, tuple[float | None, float | None]]]:
    """Demand and limit of each check by its relation, such as Tk ≤ TM."""
    for check in account.checks:
        read = check.reading
        yield (
            read.relation.replace("_", ""),
            (reader.value(read.demand, read.unit), reader.value(read.limit, read.unit)),
        )
