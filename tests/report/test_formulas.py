"""The workbook's formulas come from the tables of checks and quantities."""

from dataclasses import replace

import pytest

from hpn.engine.check import Kind
from hpn.engine.checks import BY_CODE
from hpn.files.inputs import LOADS, REQUIREMENTS
from hpn.files.workbook.formulas import CHECK_FORMULAS, CYCLE_TERMS, GEAR_TERMS, RATINGS, cell_name, formulas_of
from hpn.words.quantities import INPUTS


def test_names_differ_by_more_than_their_capitals() -> None:
    """A spreadsheet takes `t_max` and `T_max` for the same name."""
    names = [*RATINGS, *(term.name for term in (*CYCLE_TERMS, *GEAR_TERMS))]
    names += [cell_name(INPUTS[path].symbol) for path in (*LOADS, *REQUIREMENTS) if INPUTS[path].symbol != "i"]
    folded = [name.casefold() for name in names if name]
    assert sorted(set(folded)) == sorted(folded)


def test_the_workbook_calculates_every_check_of_today() -> None:
    assert CHECK_FORMULAS.keys() == BY_CODE.keys()


@pytest.mark.parametrize(
    ("relation", "kind", "asked", "demand", "limit", "share"),
    [
        ("L_min ≤ L_req", "maximum", 'L_req<>""', "{L_min}", "L_req", "{L_min}/L_req"),
        ("K_3 ≥ T_mot,N", "minimum", 'L_req<>""', "{K_3}", "T_mot_N", "T_mot_N/{K_3}"),
        ("T_max / (i · η) ≤ T_A = T_N", "maximum", 'L_req<>""', "{T_mot_peak}", "{T_N}", "{T_mot_peak}/{T_N}"),
    ],
)
def test_a_new_plain_check_has_its_formulas_from_its_relation(
    relation: str, kind: Kind, asked: str, demand: str, limit: str, share: str
) -> None:
    formulas = formulas_of(replace(BY_CODE["length"], code="new", relation=relation, kind=kind))
    assert formulas is not None
    assert (formulas.asked, formulas.demand, formulas.limit, formulas.utilisation) == (asked, demand, limit, share)


def test_a_check_of_what_no_cell_holds_stands_as_saved() -> None:
    assert formulas_of(replace(BY_CODE["length"], code="new", relation="Q ≤ L_req")) is None
