"""The mutants are changes that Python takes, and what is explained of them is there."""

import ast
from pathlib import Path

import pytest

from tools.mutants.__main__ import MODULES, mutants_in
from tools.mutants.changes import Mutant, mutants_of
from tools.mutants.explained import EXPLAINED

MUTANTS = {module: mutants_in(module) for module in MODULES}


@pytest.mark.parametrize("module", MODULES)
def test_every_mutant_is_another_program_under_a_name_of_its_own(module: str) -> None:
    mutants = MUTANTS[module]

    assert len(mutants) >= {"stiffness": 35, "stops": 50, "shaft_load": 8}.get(module, 90)
    assert len({mutant.name for mutant in mutants}) == len(mutants)
    assert [mutant.name for mutant in mutants if mutant.source == mutant.path.read_text(encoding="utf-8")] == []
    for mutant in mutants[::20]:
        ast.parse(mutant.source)


def test_every_explanation_is_of_a_mutant() -> None:
    there = {mutant.name for mutants in MUTANTS.values() for mutant in mutants}

    assert EXPLAINED.keys() - there == set()


@pytest.mark.parametrize(
    ("source", "changed"),
    [
        ("a = b < c", ["a = (b) <= (c)", "a = (b) > (c)"]),
        ("a = b + c * d", ["a = ((b) - (c * d))", "a = b + ((c) / (d))"]),
        ("a = f(b=c, d=e)", ["a = f( d=e)", "a = f(b=c, )"]),
        ("a = np.where(b, c, d)", ["a = np.where(b, d, c)"]),
        ("if a:\n    raise b", ["if (not (a)):\n    raise b", "if a:\n    pass"]),
        ("a: int = N_('text')", []),
        ('"""Docstring."""', []),
    ],
)
def test_a_change_replaces_one_expression(source: str, changed: list[str], tmp_path: Path) -> None:
    path = tmp_path / "m.py"
    path.write_text(source, encoding="utf-8")
    result: list[Mutant] = list(mutants_of("m", path))

    assert [mutant.source for mutant in result] == changed
