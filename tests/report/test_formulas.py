"""The workbook's formulas come from the tables of checks and quantities."""

import re
from dataclasses import replace

import pytest

from hpn.application.input_fields import PHASE_FIGURES
from hpn.engine.check import Sheet
from hpn.engine.checks import BY_CODE
from hpn.files.inputs import LOADS, REQUIREMENTS
from hpn.files.workbook.formulas import CHECK_FORMULAS, CYCLE_TERMS, GEAR_TERMS, RATINGS, cell_name, formulas_of
from hpn.files.workbook.inputs_sheet import REFERENCES
from hpn.files.workbook.sheets import USED
from hpn.files.workbook.unchanged import ENTERED
from hpn.words.quantities import INPUTS

SERIES = {name for name, *_ in REFERENCES}


def test_names_differ_by_more_than_their_capitals() -> None:
    """A spreadsheet takes `t_max` and `T_max` for the same name."""
    names = [*RATINGS, *(term.name for term in (*CYCLE_TERMS, *GEAR_TERMS))]
    names += [cell_name(INPUTS[path].symbol) for path in (*LOADS, *REQUIREMENTS) if INPUTS[path].symbol != "i"]
    folded = [name.casefold() for name in names if name]
    assert sorted(set(folded)) == sorted(folded)


def test_the_workbook_calculates_every_check_of_today() -> None:
    assert CHECK_FORMULAS.keys() == BY_CODE.keys()


@pytest.mark.parametrize(
    ("code", "sheet", "asked", "share"),
    [
        ("length", Sheet("{L_min}", "L_req"), 'L_req<>""', "{L_min}/L_req"),
        ("torsional_stiffness", Sheet("{K_3}", "T_mot_N"), 'K_3_req<>""', "T_mot_N/{K_3}"),
        ("length", Sheet("ABS(T_k)", "{T_N}", asked="TRUE"), "TRUE", "ABS(T_k)/{T_N}"),
        ("length", Sheet("T_k", "{T_N}", share="-T_k/{T_N}"), 'L_req<>""', "-T_k/{T_N}"),
    ],
)
def test_a_check_gives_demand_and_limit_and_the_rest_follows(code: str, sheet: Sheet, asked: str, share: str) -> None:
    formulas = formulas_of(replace(BY_CODE[code], sheet=sheet))
    assert formulas is not None
    given = (formulas.asked, formulas.demand, formulas.limit, formulas.utilisation)
    assert given == (asked, sheet.demand, sheet.limit, share)


def test_a_check_without_formulas_stands_as_saved() -> None:
    assert formulas_of(replace(BY_CODE["length"], sheet=None)) is None


def test_formulas_name_what_there_is() -> None:
    terms = (*CYCLE_TERMS, *GEAR_TERMS)
    ours = {
        *RATINGS,
        *(term.name for term in terms),
        *PHASE_FIGURES,
        *USED,
        *ENTERED,
        *SERIES,
        "unlimited",
        "iso281",
        "L10",
    }
    functions = {"IF", "OR", "AND", "NOT", "ABS", "COUNT", "SUM", "SUMPRODUCT", "MAX", "SQRT", "INT", "IFERROR", "TRUE"}
    functions |= {"MIN", "SIGN", "PI", "reverses"}
    for text in (*(term.formula for term in terms), *(check.ratio for check in CHECK_FORMULAS.values())):
        names = set(re.findall(r"[A-Za-z]\w*", re.sub(r"\b[\d.]+(E[+-]?\d+)?\b", "", text)))
        assert names - functions - ours - {"not", "rated"} == set(), text
