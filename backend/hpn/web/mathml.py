"""Formulas as MathML, in symbols or with the numbers substituted, and as text for whoever can't see MathML."""

from collections.abc import Iterable
from typing import Protocol

from markupsafe import Markup, escape

from hpn.calculation.formula import (
    Constant,
    Difference,
    Formula,
    Largest,
    Magnitude,
    Power,
    Product,
    Quotient,
    Root,
    Series,
    Sum,
    Symbol,
    Term,
)
from hpn.wording import Quantity

DIGITS = 9
"""Significant digits of a substituted number: enough to work out the next line by hand."""


class Reader(Protocol):
    """Who reads: numbers and units as they see them."""

    def quantity(self, quantity: Quantity) -> str:
        """A number with its unit."""
        ...

    def unit(self, unit: str) -> str:
        """Symbol of a unit."""
        ...


def number(reader: Reader, value: float, unit: str, digits: int = DIGITS) -> tuple[str, str]:
    """A value as its reader sees it, number and unit apart."""
    symbol = reader.unit(unit) if unit else ""
    return reader.quantity(Quantity(value, unit, digits)).removesuffix(symbol).strip(), symbol


def mathml(*parts: Formula | Symbol | str, reader: Reader, numbers: bool) -> Markup:
    """An equation as a `math` element; `parts` are formulas, symbols and the relations between them."""
    content = Markup("").join(
        _operator(part) if isinstance(part, str) else _Writer(reader, numbers).write(part) for part in parts
    )
    text = " ".join(part if isinstance(part, str) else _Liner(reader, numbers).write(part) for part in parts)
    return Markup('<math display="block" alttext="{}"><mrow>{}</mrow></math>').format(text, content)


def _operator(text: str) -> Markup:
    return Markup("<mo>{}</mo>").format(text)


class _Writer:
    """Writes MathML."""

    def __init__(self, reader: Reader, numbers: bool) -> None:
        self.reader, self.numbers = reader, numbers

    def write(self, formula: Formula | Symbol) -> Markup:
        """One formula, as one element."""
        match formula:
            case Symbol():
                return self.symbol(formula)
            case Term():
                return self.number(formula.value, formula.unit) if self.numbers else self.symbol(formula.symbol)
            case Constant():
                return self.number(formula.value, formula.unit)
            case Sum(terms):
                return self.row("+", map(self.write, terms))
            case Series():
                return self.series(formula)
            case Difference(left, right):
                return self.row("−", (self.write(left), self.write(right)))
            case Product(factors):
                return self.row("·", map(self.factor, factors))
            case Quotient(above, below, flat=True):
                return self.row("/", (self.write(above), self.write(below)))
            case Quotient(above, below):
                return Markup("<mfrac>{}{}</mfrac>").format(self.write(above), self.write(below))
            case Power(base, exponent):
                return Markup("<msup>{}{}</msup>").format(self.base(base), self.write(exponent))
            case Root(body, None):
                return Markup("<msqrt>{}</msqrt>").format(self.write(body))
            case Root(body, degree):
                assert degree is not None
                return Markup("<mroot>{}{}</mroot>").format(self.write(body), self.write(degree))
            case Magnitude(body):
                return self.write(body) if self.numbers else self.fenced("|", body, "|")
            case Largest(of):
                return self.call("max", map(self.write, of))

    def row(self, operator: str, parts: Iterable[Markup]) -> Markup:
        """Parts with an operator between them."""
        return Markup("<mrow>{}</mrow>").format(_operator(operator).join(parts))

    def fenced(self, opening: str, body: Formula, closing: str) -> Markup:
        """A formula between fences."""
        fence = Markup('<mo form="{}" stretchy="true">{}</mo>')
        parts = (fence.format("prefix", opening), self.write(body), fence.format("postfix", closing))
        return Markup("<mrow>{}{}{}</mrow>").format(*parts)

    def factor(self, formula: Formula) -> Markup:
        """A factor of a product, in brackets where it is a sum."""
        return self.fenced("(", formula, ")") if isinstance(formula, Sum | Difference | Series) else self.write(formula)

    def base(self, formula: Formula) -> Markup:
        """A base of a power, in brackets unless it is a symbol or a number without unit."""
        plain = isinstance(formula, Term | Constant) and not (self.numbers and formula.unit)
        return self.write(formula) if plain else self.fenced("(", formula, ")")

    def call(self, name: str, arguments: Iterable[Markup]) -> Markup:
        """A function of some arguments."""
        listed = Markup('<mo separator="true">;</mo>').join(arguments)
        return Markup("<mrow><mi>{}</mi><mo>(</mo>{}<mo>)</mo></mrow>").format(name, listed)

    def series(self, series: Series) -> Markup:
        """A series: in symbols with its general term, in numbers with the terms that are shown."""
        dots = Markup("<mo>…</mo>")
        if not self.numbers:
            first, second, last = map(self.write, series.pattern)
            return self.row("+", (first, second, dots, last))
        terms = [self.write(term) for term in series.terms]
        return self.row("+", (*terms[:-1], dots, terms[-1]) if series.abbreviated else terms)

    def symbol(self, symbol: Symbol) -> Markup:
        """A letter with its index."""
        letter = Markup("<mi>{}</mi>").format(symbol.letter)
        if not symbol.index:
            return letter
        tag = "mn" if symbol.index.isdigit() else "mi" if symbol.index.isalpha() else "mtext"
        return Markup("<msub>{}<{}>{}</{}></msub>").format(letter, Markup(tag), symbol.index, Markup(tag))

    def number(self, value: float, unit: str) -> Markup:
        """A number with its unit."""
        text, symbol = number(self.reader, value, unit)
        if not symbol:
            return Markup("<mn>{}</mn>").format(text)
        return Markup('<mrow><mn>{}</mn><mtext class="unit">\u202f{}</mtext></mrow>').format(text, symbol)


class _Liner(_Writer):
    """Writes a line of text."""

    def row(self, operator: str, parts: Iterable[str]) -> Markup:
        """Parts with an operator between them."""
        return Markup(operator if operator in "·/" else f" {operator} ").join(parts)

    def write(self, formula: Formula | Symbol) -> Markup:
        """One formula as text."""
        match formula:
            case Quotient(above, below, flat=False):
                return self.row("/", (self.grouped(above), self.grouped(below)))
            case Power(base, exponent):
                return Markup("{}^{}").format(self.base(base), self.grouped(exponent))
            case Root(body, degree):
                return Markup("root({})({})").format(self.write(degree) if degree else 2, self.write(body))
            case _:
                return super().write(formula)

    def grouped(self, formula: Formula) -> Markup:
        """In brackets, unless it is a single term."""
        text = self.write(formula)
        return text if isinstance(formula, Term | Constant) else Markup("({})").format(text)

    def fenced(self, opening: str, body: Formula, closing: str) -> Markup:
        """A formula between fences."""
        return Markup("{}{}{}").format(opening, self.write(body), closing)

    def call(self, name: str, arguments: Iterable[str]) -> Markup:
        """A function of some arguments."""
        return Markup("{}({})").format(name, Markup("; ").join(arguments))

    def series(self, series: Series) -> Markup:
        """A series of terms."""
        shown = series.terms if self.numbers else series.pattern
        terms = [self.write(term) for term in shown]
        gap = series.abbreviated or not self.numbers
        return self.row("+", (*terms[:-1], Markup("…"), terms[-1]) if gap else terms)

    def symbol(self, symbol: Symbol) -> Markup:
        """A letter with its index."""
        return escape(f"{symbol.letter}_{symbol.index}" if symbol.index else symbol.letter)

    def number(self, value: float, unit: str) -> Markup:
        """A number with its unit."""
        text, symbol = number(self.reader, value, unit)
        return escape(f"{text} {symbol}".strip())
