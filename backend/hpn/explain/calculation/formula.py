"""Formulas as trees of terms with symbol and value: written in symbols, with numbers, or evaluated.

One tree serves all three, so that the substituted numbers are those of the result.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self, cast

import numpy as np

from hpn.physics.equations import FloatArray


@dataclass(frozen=True, slots=True)
class Variable:
    """A letter of the handbook with its index, such as T and `av`."""

    letter: str
    index: str = ""

    @classmethod
    def of(cls, written: str) -> Self:
        """Symbol from its spelling in the tables of quantities and checks, its index behind an underscore: `T_av`."""
        letter, _, index = written.partition("_")
        return cls(letter, index)

    def of_phase(self, index: str) -> "Variable":
        """Letter of one phase."""
        return Variable(self.letter, ",".join(filter(None, (self.index, index))))


class Expression:
    """Base of all formulas: operators build them in their printed form; a number becomes a constant."""

    __slots__ = ()

    def __add__(self, other: "Operand") -> "Sum":
        return Sum((*(self.terms if isinstance(self, Sum) else (_formula(self),)), _formula(other)))

    def __sub__(self, other: "Operand") -> "Subtraction":
        return Subtraction(_formula(self), _formula(other))

    def __rsub__(self, other: float) -> "Subtraction":
        return Subtraction(Constant(other), _formula(self))

    def __mul__(self, other: "Operand") -> "Product":
        return Product((*(self.factors if isinstance(self, Product) else (_formula(self),)), _formula(other)))

    def __rmul__(self, other: float) -> "Product":
        return Product((Constant(other), _formula(self)))

    def __truediv__(self, other: "Operand") -> "Fraction":
        return Fraction(_formula(self), _formula(other))

    def __rtruediv__(self, other: float) -> "Fraction":
        return Fraction(Constant(other), _formula(self))

    def __pow__(self, other: "Operand") -> "Power":
        return Power(_formula(self), _formula(other))

    def __rpow__(self, other: float) -> "Power":
        return Power(Constant(other), _formula(self))

    def __abs__(self) -> "Magnitude":
        return Magnitude(_formula(self))


@dataclass(frozen=True, slots=True)
class Term(Expression):
    """A symbol and its value; `unit` is a suffix such as `Nm`, blank for a pure number."""

    symbol: Variable
    value: float
    unit: str = ""


@dataclass(frozen=True)
class PhaseValues:
    """A quantity of every phase; `values` has shape (phases,)."""

    symbol: Variable
    values: FloatArray
    unit: str = ""

    def term(self, index: str, place: int) -> Term:
        """The quantity of one phase, written with an index."""
        return Term(self.symbol.of_phase(index), self.values.item(place), self.unit)


@dataclass(frozen=True, slots=True)
class Constant(Expression):
    """A number printed in the equation itself."""

    value: float
    unit: str = ""


@dataclass(frozen=True, slots=True)
class Sum(Expression):
    """Terms added up."""

    terms: "tuple[Formula, ...]"


@dataclass(frozen=True, eq=False)
class PhaseSum(Expression):
    """A sum over the phases: `make` makes the term of a phase from its quantities, in their order."""

    make: "Callable[..., Formula]"
    quantities: tuple[PhaseValues, ...]

    @cached_property
    def general(self) -> "Formula":
        """Term of any phase, with the index j."""
        return self.make(*(quantity.term("j", 0) for quantity in self.quantities))

    @cached_property
    def total(self) -> float:
        """Sum of all terms."""
        return math.fsum(self.values(self.general).tolist())

    def __len__(self) -> int:
        return len(self.quantities[0].values)

    def values(self, of: "Formula", scale: Callable[[FloatArray, str], FloatArray] | None = None) -> FloatArray:
        """Values of the general term or one of its factors in every phase, shape (phases,); `scale` converts
        quantities.
        """
        values = {
            each.symbol.of_phase("j"): scale(each.values, each.unit) if scale else each.values
            for each in self.quantities
        }
        return np.broadcast_to(values_of(of, values), len(self))


@dataclass(frozen=True, slots=True)
class Subtraction(Expression):
    """One formula less another."""

    left: "Formula"
    right: "Formula"


@dataclass(frozen=True, slots=True)
class Product(Expression):
    """Factors multiplied."""

    factors: "tuple[Formula, ...]"


@dataclass(frozen=True, slots=True)
class Fraction(Expression):
    """A fraction; `flat` in an exponent."""

    above: "Formula"
    below: "Formula"
    flat: bool = False


@dataclass(frozen=True, slots=True)
class Power(Expression):
    """A base with an exponent."""

    base: "Formula"
    exponent: "Formula"


@dataclass(frozen=True, slots=True)
class Root(Expression):
    """A root; the square root without a degree."""

    body: "Formula"
    degree: "Formula | None" = None


@dataclass(frozen=True, slots=True)
class Magnitude(Expression):
    """Magnitude, in bars; a number in them is shown without its sign."""

    body: "Formula"


@dataclass(frozen=True, slots=True)
class Largest(Expression):
    """The largest of some formulas."""

    of: "tuple[Formula, ...]"


Formula = Term | Constant | Sum | PhaseSum | Subtraction | Product | Fraction | Power | Root | Magnitude | Largest

Operand = Expression | float


def _formula(operand: Operand) -> Formula:
    return cast(Formula, operand if isinstance(operand, Expression) else Constant(operand))


TEN_THIRDS = Fraction(Constant(10), Constant(3), flat=True)


def value_of(formula: Formula, instead: Mapping[Variable, float] | None = None) -> float:
    """Value of a formula; raises the errors of arithmetic, such as ZeroDivisionError.

    `instead` gives some symbols another value, except those in a series.
    """
    return float(_evaluated(formula, instead or {}))


def values_of(formula: Formula, values: Mapping[Variable, FloatArray]) -> FloatArray:
    """Values of a formula for arrays of values of some symbols."""
    result: FloatArray = _evaluated(formula, values)
    return result


def _evaluated(formula: Formula, instead: Mapping[Variable, Any]) -> Any:
    """Value of a formula, a number or an array like its symbols."""

    def each(formulas: Sequence[Formula]) -> list[Any]:
        return [_evaluated(one, instead) for one in formulas]

    match formula:
        case Term(symbol, value):
            return instead.get(symbol, value)
        case Constant(value=value) | PhaseSum(total=value):
            return value
        case Sum(terms):
            return sum(each(terms))
        case Subtraction(left, right):
            return _evaluated(left, instead) - _evaluated(right, instead)
        case Product(factors):
            return math.prod(each(factors))
        case Fraction(above, below):
            return _evaluated(above, instead) / _evaluated(below, instead)
        case Power(base, exponent):
            return _evaluated(base, instead) ** _evaluated(exponent, instead)
        case Root(body, degree):
            return _evaluated(body, instead) ** (1 / _evaluated(degree, instead) if degree else 0.5)
        case Magnitude(body):
            return abs(_evaluated(body, instead))
        case Largest(of):
            return max(each(of))


def over_phases(make: Callable[..., Formula], *quantities: PhaseValues) -> PhaseSum:
    """Series over the phases; `make` makes the term of a phase from its quantities, in their order."""
    return PhaseSum(make, quantities)


def in_wire_units(formula: Formula) -> bool:
    """True for a formula that holds only in the units of the wire: with an inertia, or with a torque and its arm."""
    units = {one.unit for one in inside(formula) if isinstance(one, Term)}
    return bool(units & {"kgm2", "rad_per_s2"}) or {"Nm", "mm"} <= units


def inside(formula: Formula) -> Iterator[Formula]:
    """The formula and every formula in it; a series counts as one."""
    yield formula
    match formula:
        case Sum(parts) | Product(parts) | Largest(parts):
            inner: tuple[Formula, ...] = parts
        case Subtraction(first, second) | Fraction(first, second) | Power(first, second):
            inner = (first, second)
        case Root(body) | Magnitude(body):
            inner = (body,)
        case _:
            inner = ()
    for one in inner:
        yield from inside(one)
