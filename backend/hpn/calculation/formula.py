"""Formulas as trees of terms that know their symbol and their value: written in symbols, with numbers, or evaluated.

One tree serves all three, so that what a reader sees substituted is what the result came from.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

SHOWN_TERMS = 6
"""A series over more phases is abbreviated."""


@dataclass(frozen=True, slots=True)
class Symbol:
    """A letter of the handbook with its index, such as T and `av`."""

    letter: str
    index: str = ""


@dataclass(frozen=True, slots=True)
class Term:
    """A symbol and the value that stands for it; `unit` is a suffix such as `Nm`, blank for a pure number."""

    symbol: Symbol
    value: float
    unit: str = ""


@dataclass(frozen=True, slots=True)
class Constant:
    """A number that the equation itself prints."""

    value: float
    unit: str = ""


@dataclass(frozen=True, slots=True)
class Sum:
    """Terms added up."""

    terms: "tuple[Formula, ...]"


@dataclass(frozen=True, slots=True)
class Series:
    """A sum over the phases. `pattern` is its first, second and last term in symbols.

    Of a long series only the first terms are kept, and the last one; `total` is the value of all `count` of them.
    """

    pattern: "tuple[Formula, Formula, Formula]"
    terms: "tuple[Formula, ...]"
    count: int
    total: float

    @property
    def abbreviated(self) -> bool:
        """Whether terms in the middle are left out."""
        return self.count > len(self.terms)


@dataclass(frozen=True, slots=True)
class Difference:
    """One formula less another."""

    left: "Formula"
    right: "Formula"


@dataclass(frozen=True, slots=True)
class Product:
    """Factors multiplied."""

    factors: "tuple[Formula, ...]"


@dataclass(frozen=True, slots=True)
class Quotient:
    """A fraction; `flat` where it stands in an exponent."""

    above: "Formula"
    below: "Formula"
    flat: bool = False


@dataclass(frozen=True, slots=True)
class Power:
    """A base with an exponent."""

    base: "Formula"
    exponent: "Formula"


@dataclass(frozen=True, slots=True)
class Root:
    """A root; the square root where no degree is given."""

    body: "Formula"
    degree: "Formula | None" = None


@dataclass(frozen=True, slots=True)
class Magnitude:
    """Bars around what may be signed; the number in them is shown without its sign."""

    body: "Formula"


@dataclass(frozen=True, slots=True)
class Largest:
    """The largest of some formulas."""

    of: "tuple[Formula, ...]"


Formula = Term | Constant | Sum | Series | Difference | Product | Quotient | Power | Root | Magnitude | Largest

TEN_THIRDS = Quotient(Constant(10), Constant(3), flat=True)


def value_of(formula: Formula) -> float:
    """Value of a formula; raises what arithmetic raises, such as ZeroDivisionError."""
    match formula:
        case Term(value=value) | Constant(value=value) | Series(total=value):
            return value
        case Sum(terms):
            return math.fsum(map(value_of, terms))
        case Difference(left, right):
            return value_of(left) - value_of(right)
        case Product(factors):
            return math.prod(map(value_of, factors))
        case Quotient(above, below):
            return value_of(above) / value_of(below)
        case Power(base, exponent):
            return float(value_of(base) ** value_of(exponent))
        case Root(body, degree):
            return float(value_of(body) ** (1 / value_of(degree) if degree else 0.5))
        case Magnitude(body):
            return abs(value_of(body))
        case Largest(of):
            return max(map(value_of, of))


def over_phases(make: Callable[[str, int], Formula], count: int, total: Callable[[], float]) -> Series:
    """Series over `count` phases; `make` gives the term of a phase, and the index it is written with.

    `total` is asked for only where the series is too long to keep its terms.
    """
    shown: Sequence[int] = range(count)
    if count > SHOWN_TERMS:
        shown = (*range(SHOWN_TERMS - 2), count - 1)
    terms = tuple(make(str(k + 1), k) for k in shown)
    pattern = (make("1", 0), make("2", 0), make("n", 0))
    return Series(pattern, terms, count, total() if count > SHOWN_TERMS else math.fsum(map(value_of, terms)))


def leaves_out(formula: Formula) -> bool:
    """Whether a series in a formula is abbreviated."""
    match formula:
        case Term() | Constant():
            return False
        case Series():
            return formula.abbreviated
        case Sum(parts) | Product(parts) | Largest(parts):
            return any(map(leaves_out, parts))
        case Difference(first, second) | Quotient(first, second) | Power(first, second):
            return leaves_out(first) or leaves_out(second)
        case Root(body) | Magnitude(body):
            return leaves_out(body)
