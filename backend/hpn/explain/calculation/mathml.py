"""Formulas as MathML for page and report, in symbols or with the numbers substituted, and as a line of text."""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from html import escape

from hpn.explain.calculation.formula import (
    Constant,
    Formula,
    Fraction,
    Largest,
    Magnitude,
    PhaseSum,
    Power,
    Product,
    Root,
    Subtraction,
    Sum,
    Term,
    Variable,
    in_wire_units,
    inside,
    value_of,
)
from hpn.explain.calculation.sheet import Comparison, EquationLine, Step
from hpn.physics.equations import FloatArray
from hpn.words.reader import Reader
from hpn.words.wording import Quantity

SHOWN_TERMS = 6
"""Largest number of terms in a sum; longer sums are abbreviated."""

DIGITS = 9
"""Significant digits of a substituted number: enough to calculate the next line by hand."""


def number(reader: Reader, value: float, unit: str) -> str:
    """Value in the reader's notation, without its unit."""
    return reader.number(Quantity(value, unit, DIGITS))


Part = tuple[Formula | Variable, bool] | str
"""A formula and True if its numbers are substituted, or the relation between two formulas."""


def mathml(reader: Reader, *parts: Part) -> str:
    """An equation as a `math` element, and as a line of text for screen readers."""
    written = "".join(_operator(p) if isinstance(p, str) else _Writer(reader, p[1]).write(p[0]) for p in parts)
    text = " ".join(p if isinstance(p, str) else _Liner(reader, p[1]).write(p[0]) for p in parts)
    return f'<math display="block" alttext="{escape(text)}"><mrow>{written}</mrow></math>'


def in_symbols(reader: Reader, line: EquationLine) -> str:
    """An equation in symbols, as in the handbook."""
    return mathml(reader, (line.result.symbol, False), "=", (line.formula, False))


def substituted(reader: Reader, line: EquationLine) -> str:
    """Right side of an equation with its numbers."""
    return mathml(_reader_of(reader, line), "=", (line.formula, True))


def result(reader: Reader, line: EquationLine) -> str:
    """Result of the equation; a count is rounded down."""
    reader = _reader_of(reader, line)
    right = (Constant(line.result.value, line.result.unit), True)
    if line.rounded_down:
        return mathml(reader, "=", (Constant(value_of(line.formula)), True), "→", right)
    return mathml(reader, "=", right)


def _reader_of(reader: Reader, line: EquationLine) -> Reader:
    """The reader, with units of the wire if the line holds only in these."""
    return replace(reader, units=()) if in_wire_units(line.formula) else reader


def compared(reader: Reader, comparison: Comparison, *, continued: bool = False) -> str:
    """Comparison of demand and limit, with the user's own reserve; `continued` if it follows its equation."""
    return mathml(reader, *_compared(comparison, continued))


def compared_apart(reader: Reader, comparison: Comparison, *, continued: bool = False) -> str:
    """Comparison with an element for each side, so that a narrow page breaks it only before a sign."""
    sides: list[list[Part]] = [[]]
    for part in _compared(comparison, continued):
        if isinstance(part, str) and sides[-1]:
            sides.append([])
        sides[-1].append(part)
    return "".join(mathml(reader, *side) for side in sides)


def _compared(comparison: Comparison, continued: bool) -> list[Part]:
    tested, u = comparison.tested, comparison.allowed
    parts: list[Part] = ["="] if continued else [(tested, False), "="]
    if not isinstance(tested, Term):
        parts += [(tested, True), "="]
    parts += [(Constant(comparison.value, comparison.unit), True), comparison.relation]
    limit = Constant(comparison.limit, comparison.unit)
    if u == 1:
        for name in comparison.limit_names:
            parts += [(name, False), "="]
        return [*parts, (limit, True)]
    named = Term(comparison.limit_names[-1], 0.0) if comparison.limit_names else limit
    reserve = Term(Variable("u"), u)
    for numbers, factor in ((False, named), (True, limit)):
        reserved = reserve * factor if comparison.relation == "≤" else factor / reserve
        parts += [(reserved, numbers), "="]
    return [*parts, (Constant(comparison.bound, comparison.unit), True)]


# --- Sums over the phases ---------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Addition:
    """Sums of a step as columns: a head for each as MathML and as text, rows by phase, and the totals.

    `left_out` is the number of omitted phases in the middle.
    """

    heads: list[tuple[str, str]]
    rows: list[tuple[int, list[str]]]
    totals: list[str]
    left_out: int


def addition(reader: Reader, step: Step) -> Addition | None:
    """Sums of a step, with every power in them; None if each term is just a product of inputs."""
    series = [one for line in step.lines for one in inside(line.formula) if isinstance(one, PhaseSum)]
    columns = list[tuple[PhaseSum, Formula]]()
    for one in sorted(series, key=lambda one: len(_factors(one.general))):
        powers = [factor for factor in _factors(one.general) if isinstance(factor, Power)]
        columns += [
            (one, formula) for formula in (*powers, one.general) if formula not in [each for _, each in columns]
        ]
    if all(formula is one.general for one, formula in columns):
        return None
    reader = replace(reader, units=()) if any(in_wire_units(line.formula) for line in step.lines) else reader
    values = [one.values(formula, _in_units_of(reader)).tolist() for one, formula in columns]
    count = len(series[0])
    places = range(count) if count <= SHOWN_TERMS else [*range(SHOWN_TERMS - 2), count - 1]
    return Addition(
        [(mathml(reader, (formula, False)), _Liner(reader, False).write(formula)) for _, formula in columns],
        [(place + 1, [_written(reader, each[place]) for each in values]) for place in places],
        [total(reader, one) if formula is one.general else "" for one, formula in columns],
        count - len(places),
    )


def _factors(formula: Formula) -> tuple[Formula, ...]:
    return formula.factors if isinstance(formula, Product) else (formula,)


def total(reader: Reader, series: PhaseSum) -> str:
    """Sum of a series of quantities in the reader's units."""
    return _written(reader, math.fsum(series.values(series.general, _in_units_of(reader)).tolist()))


def _in_units_of(reader: Reader) -> Callable[[FloatArray, str], FloatArray]:
    return lambda values, unit: values * float(reader.measure(unit).factor)


def _written(reader: Reader, value: float) -> str:
    return number(reader, value, "")


def _is_negative(formula: Formula) -> bool:
    return isinstance(formula, Term | Constant) and formula.value < 0


def _operator(text: str) -> str:
    return f"<mo>{escape(text)}</mo>"


class _Writer:
    """Writer of MathML. It makes plain strings, since a page has hundreds of these; every leaf is escaped where it is
    written.
    """

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
            case PhaseSum(general=Term(unit=unit)) if self.numbers:
                return self.number(formula.total, unit)
            case PhaseSum():
                return self.plain(total(self.reader, formula)) if self.numbers else self.summed(formula.general)
            case Subtraction(left, right):
                return self.row("−", (self.write(left), self.factor(right)))
            case Product(factors):
                return self.row("·", map(self.factor, factors))
            case Magnitude(body):
                plain = self.numbers and not _is_negative(body)
                return self.write(body) if plain else self.fenced("|", body, "|")
            case Largest(of):
                return self.call("max", map(self.write, of))
            case Fraction() | Power() | Root():
                return self.shaped(formula)

    def shaped(self, formula: Fraction | Power | Root) -> str:
        """MathML of a formula that is not a row of operands, such as a fraction."""
        match formula:
            case Fraction(above, below, flat=True):
                return self.row("/", (self.write(above), self.write(below)))
            case Fraction(above, below):
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
        """A factor of a product, or a subtrahend: in brackets if it is a sum or a negative number."""
        in_brackets = isinstance(formula, Sum | Subtraction) or (self.numbers and _is_negative(formula))
        return self.fenced("(", formula, ")") if in_brackets else self.write(formula)

    def base(self, formula: Formula) -> str:
        """A base of a power, in brackets unless it is a symbol or a number without unit."""
        plain = isinstance(formula, Term | Constant) and not (self.numbers and formula.unit)
        return self.write(formula) if plain else self.fenced("(", formula, ")")

    def call(self, name: str, arguments: Iterable[str]) -> str:
        """A function of some arguments."""
        return f"<mrow><mi>{name}</mi><mo>(</mo>{_operator(';').join(arguments)}<mo>)</mo></mrow>"

    def plain(self, text: str) -> str:
        """A number as written, without a unit."""
        return f"<mn>{escape(text)}</mn>"

    def summed(self, general: Formula) -> str:
        """A sum over the phases by its general term."""
        return f"<mrow><mo>Σ</mo>{self.write(general)}</mrow>"

    def symbol(self, symbol: Variable) -> str:
        """A letter with its index."""
        if not symbol.index:
            return f"<mi>{escape(symbol.letter)}</mi>"
        tag = "mn" if symbol.index.isdigit() else "mi" if symbol.index.isalpha() else "mtext"
        return f"<msub><mi>{escape(symbol.letter)}</mi><{tag}>{escape(symbol.index)}</{tag}></msub>"

    def number(self, value: float, unit: str) -> str:
        """A number with its unit."""
        text = self.plain(number(self.reader, value, unit))
        if not unit:
            return text
        return f'<mrow>{text}<mtext class="unit">\u202f{escape(self.reader.unit(unit))}</mtext></mrow>'


class _Liner(_Writer):
    """Writer of a line of text, not escaped yet."""

    def row(self, operator: str, parts: Iterable[str]) -> str:
        """Parts with an operator between them."""
        return (operator if operator in "·/" else f" {operator} ").join(parts)

    def shaped(self, formula: Fraction | Power | Root) -> str:
        """Fractions, powers and roots in one line."""
        match formula:
            case Fraction(above, below):
                return f"{self.grouped(above)}/{self.grouped(below)}"
            case Power(base, exponent):
                return f"{self.base(base)}^{self.grouped(exponent)}"
            case Root(body, degree):
                return f"root({self.write(degree) if degree else 2})({self.write(body)})"

    def grouped(self, formula: Formula) -> str:
        """A formula in brackets, unless it is a single term."""
        text = self.write(formula)
        return text if isinstance(formula, Term | Constant) else f"({text})"

    def fenced(self, opening: str, body: Formula, closing: str) -> str:
        """A formula between fences."""
        return f"{opening}{self.write(body)}{closing}"

    def call(self, name: str, arguments: Iterable[str]) -> str:
        """A function of some arguments."""
        return f"{name}({'; '.join(arguments)})"

    def plain(self, text: str) -> str:
        """A number as written, without a unit."""
        return text

    def summed(self, general: Formula) -> str:
        """A sum over the phases by its general term."""
        return f"Σ {self.write(general)}"

    def symbol(self, symbol: Variable) -> str:
        """A letter with its index."""
        return f"{symbol.letter}_{symbol.index}" if symbol.index else symbol.letter

    def number(self, value: float, unit: str) -> str:
        """A number with its unit."""
        text = number(self.reader, value, unit)
        return f"{text} {self.reader.unit(unit)}" if unit else text
