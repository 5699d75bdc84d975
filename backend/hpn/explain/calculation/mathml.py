"""Formulas as MathML for page and report, in symbols or with the numbers substituted, and as a line of text."""

from collections.abc import Iterable
from dataclasses import replace
from html import escape

from hpn.explain.calculation.formula import (
    Constant,
    Formula,
    Largest,
    Magnitude,
    Power,
    Product,
    Quotient,
    Root,
    Series,
    Subtraction,
    Sum,
    Term,
    Variable,
    in_wire_units,
    value_of,
)
from hpn.explain.calculation.sheet import Comparison, Line
from hpn.words.reader import Reader
from hpn.words.wording import Quantity

DIGITS = 9
"""Significant digits of a substituted number: enough to calculate the next line by hand."""


def number(reader: Reader, value: float, unit: str) -> str:
    """Value as the reader sees it, without its unit."""
    return reader.number(Quantity(value, unit, DIGITS))


Part = tuple[Formula | Variable, bool] | str
"""A formula and whether its numbers are substituted, or the relation between two of them."""


def mathml(reader: Reader, *parts: Part) -> str:
    """An equation as a `math` element, and as a line of text for screen readers."""
    written = "".join(_operator(p) if isinstance(p, str) else _Writer(reader, p[1]).write(p[0]) for p in parts)
    text = " ".join(p if isinstance(p, str) else _Liner(reader, p[1]).write(p[0]) for p in parts)
    return f'<math display="block" alttext="{escape(text)}"><mrow>{written}</mrow></math>'


def in_symbols(reader: Reader, line: Line) -> str:
    """An equation as the handbook prints it."""
    return mathml(reader, (line.result.symbol, False), "=", (line.formula, False))


def substituted(reader: Reader, line: Line) -> str:
    """The same equation's right side with its numbers."""
    return mathml(_reader_of(reader, line), "=", (line.formula, True))


def result(reader: Reader, line: Line) -> str:
    """Result of the equation; a count is rounded down."""
    reader = _reader_of(reader, line)
    given = (Constant(line.result.value, line.result.unit), True)
    if line.rounded_down:
        return mathml(reader, "=", (Constant(value_of(line.formula)), True), "→", given)
    return mathml(reader, "=", given)


def _reader_of(reader: Reader, line: Line) -> Reader:
    """The reader, in the units of the wire where the line holds in them alone."""
    return replace(reader, units=()) if in_wire_units(line.formula) else reader


def compared(reader: Reader, comparison: Comparison, *, continued: bool = False) -> str:
    """Comparison of demand and limit, which the user's own reserve may lower; `continued` behind its equation."""
    tested, u = comparison.tested, comparison.allowed
    parts: list[Part] = ["="] if continued else [(tested, False), "="]
    if not isinstance(tested, Term):
        parts += [(tested, True), "="]
    parts += [(Constant(comparison.value, comparison.unit), True), comparison.relation]
    limit = Constant(comparison.limit, comparison.unit)
    if u == 1:
        for name in comparison.limit_names:
            parts += [(name, False), "="]
        return mathml(reader, *parts, (limit, True))
    named = Term(comparison.limit_names[-1], 0.0) if comparison.limit_names else limit
    reserve = Term(Variable("u"), u)
    for numbers, factor in ((False, named), (True, limit)):
        reserved = reserve * factor if comparison.relation == "≤" else factor / reserve
        parts += [(reserved, numbers), "="]
    return mathml(reader, *parts, (Constant(comparison.bound, comparison.unit), True))


def _is_negative(formula: Formula) -> bool:
    return isinstance(formula, Term | Constant) and formula.value < 0


def _operator(text: str) -> str:
    return f"<mo>{escape(text)}</mo>"


class _Writer:
    """Writes MathML. Plain strings, because a page has hundreds of these; every leaf is escaped where it is written."""

    def __init__(self, reader: Reader, numbers: bool) -> None:
        self.reader, self.numbers = reader, numbers

    def write(self, formula: Formula | Variable) -> str:
        """One formula, as one element."""
        match formula:
            case Variable():
                return self.symbol(formula)
            case Term():
                return self.number(formula.value, formula.unit) if self.numbers else self.symbol(formula.symbol)
            case Constant():
                return self.number(formula.value, formula.unit)
            case Sum(terms):
                return self.row("+", map(self.write, terms))
            case Series():
                return self.row("+", self.terms(formula))
            case Subtraction(left, right):
                return self.row("−", (self.write(left), self.factor(right)))
            case Product(factors):
                return self.row("·", map(self.factor, factors))
            case Magnitude(body):
                plain = self.numbers and not _is_negative(body)
                return self.write(body) if plain else self.fenced("|", body, "|")
            case Largest(of):
                return self.call("max", map(self.write, of))
            case Quotient() | Power() | Root():
                return self.shaped(formula)

    def shaped(self, formula: Quotient | Power | Root) -> str:
        """Formula that is not a row of operands, such as a fraction."""
        match formula:
            case Quotient(above, below, flat=True):
                return self.row("/", (self.write(above), self.write(below)))
            case Quotient(above, below):
                return f"<mfrac>{self.write(above)}{self.write(below)}</mfrac>"
            case Power(base, exponent):
                return f"<msup>{self.base(base)}{self.write(exponent)}</msup>"
            case Root(body, degree):
                if degree is None:
                    return f"<msqrt>{self.write(body)}</msqrt>"
                return f"<mroot>{self.write(body)}{self.write(degree)}</mroot>"

    def row(self, operator: str, parts: Iterable[str]) -> str:
        """Parts with an operator between them."""
        return f"<mrow>{_operator(operator).join(parts)}</mrow>"

    def fenced(self, opening: str, body: Formula, closing: str) -> str:
        """A formula between fences."""
        before, after = f'<mo form="prefix">{opening}</mo>', f'<mo form="postfix">{closing}</mo>'
        return f"<mrow>{before}{self.write(body)}{after}</mrow>"

    def factor(self, formula: Formula) -> str:
        """A factor of a product, or what is subtracted: in brackets where it is a sum or a negative number."""
        in_brackets = isinstance(formula, Sum | Subtraction | Series) or (self.numbers and _is_negative(formula))
        return self.fenced("(", formula, ")") if in_brackets else self.write(formula)

    def base(self, formula: Formula) -> str:
        """A base of a power, in brackets unless it is a symbol or a number without unit."""
        plain = isinstance(formula, Term | Constant) and not (self.numbers and formula.unit)
        return self.write(formula) if plain else self.fenced("(", formula, ")")

    def call(self, name: str, arguments: Iterable[str]) -> str:
        """A function of some arguments."""
        return f"<mrow><mi>{name}</mi><mo>(</mo>{_operator(';').join(arguments)}<mo>)</mo></mrow>"

    def terms(self, series: Series) -> list[str]:
        """Terms of a series: the general ones in symbols, the kept ones in numbers."""
        terms = [self.write(term) for term in (series.terms if self.numbers else series.pattern)]
        return [*terms[:-1], self.dots, terms[-1]] if series.abbreviated or not self.numbers else terms

    dots = "<mo>…</mo>"

    def symbol(self, symbol: Variable) -> str:
        """A letter with its index."""
        if not symbol.index:
            return f"<mi>{escape(symbol.letter)}</mi>"
        tag = "mn" if symbol.index.isdigit() else "mi" if symbol.index.isalpha() else "mtext"
        return f"<msub><mi>{escape(symbol.letter)}</mi><{tag}>{escape(symbol.index)}</{tag}></msub>"

    def number(self, value: float, unit: str) -> str:
        """A number with its unit."""
        text = f"<mn>{escape(number(self.reader, value, unit))}</mn>"
        if not unit:
            return text
        return f'<mrow>{text}<mtext class="unit">\u202f{escape(self.reader.unit(unit))}</mtext></mrow>'


class _Liner(_Writer):
    """Writes a line of text, not escaped yet."""

    dots = "…"

    def row(self, operator: str, parts: Iterable[str]) -> str:
        """Parts with an operator between them."""
        return (operator if operator in "·/" else f" {operator} ").join(parts)

    def shaped(self, formula: Quotient | Power | Root) -> str:
        """Fractions, powers and roots in one line."""
        match formula:
            case Quotient(above, below):
                return f"{self.grouped(above)}/{self.grouped(below)}"
            case Power(base, exponent):
                return f"{self.base(base)}^{self.grouped(exponent)}"
            case Root(body, degree):
                return f"root({self.write(degree) if degree else 2})({self.write(body)})"

    def grouped(self, formula: Formula) -> str:
        """In brackets, unless it is a single term."""
        text = self.write(formula)
        return text if isinstance(formula, Term | Constant) else f"({text})"

    def fenced(self, opening: str, body: Formula, closing: str) -> str:
        """A formula between fences."""
        return f"{opening}{self.write(body)}{closing}"

    def call(self, name: str, arguments: Iterable[str]) -> str:
        """A function of some arguments."""
        return f"{name}({'; '.join(arguments)})"

    def symbol(self, symbol: Variable) -> str:
        """A letter with its index."""
        return f"{symbol.letter}_{symbol.index}" if symbol.index else symbol.letter

    def number(self, value: float, unit: str) -> str:
        """A number with its unit."""
        text = number(self.reader, value, unit)
        return f"{text} {self.reader.unit(unit)}" if unit else text
