"""The report's page and the workbook's tables on the tolerances."""

from io import BytesIO

import openpyxl
import pytest
from pypdf import PdfReader

from hpn.catalogue import Catalogue
from hpn.files.report.content import content
from hpn.files.report.pdf import pdf
from hpn.files.workbook.workbook import workbook
from tests.build import Json, worked_example
from tests.report.cases import language, typed_export_of

STOP = "emergency_stop.torque_Nm"
WIDE: Json = worked_example(tolerances={"torque_Nm": {"percent": 5}, STOP: {"percent": 40}})


@pytest.mark.parametrize("code", ["en", "de"])
def test_the_page_has_each_worst_case_and_what_decides(code: str, catalogue: Catalogue) -> None:
    """T_k of 200 Nm ± 40 % reaches 280 Nm, 109.4 % of 256 Nm, which 28 % leave: 200 · 1.28 = 256."""
    export, reader = typed_export_of(WIDE, catalogue), language(code)
    view = content(export, reader)["tolerances"]
    row = next(row for row in view["checks"] if row["share"] == 280 / 256)
    text = " ".join(PdfReader(BytesIO(pdf(export, reader))).pages[-1].extract_text().split())

    assert (row["worst"], row["given"]) == ("280\u202fNm", "200\u202fNm")
    assert [("T", "k")] in row["case"][0][1]
    falls = f"{reader.percent(280 / 256)} → {reader.percent(200 / 256)}"
    assert view["inputs"][0][2:] == [
        "±40\u202f%",
        falls,
        "±28\u202f%",
    ]
    assert reader.text("Over the whole tolerance") in text
    assert "±28" in text


def test_without_tolerances_files_have_none_of_it(catalogue: Catalogue) -> None:
    export = typed_export_of(worked_example(), catalogue)
    book = openpyxl.load_workbook(BytesIO(workbook(export, language("en"))))

    assert content(export, language("en"))["tolerances"] is None
    assert "Over the whole tolerance" not in {cell.value for row in book.worksheets[0] for cell in row}


def test_the_workbook_has_every_digit_of_the_worst_cases(catalogue: Catalogue) -> None:
    book = openpyxl.load_workbook(BytesIO(workbook(typed_export_of(WIDE, catalogue), language("en"))))
    cells = [cell.value for row in book.worksheets[0] for cell in row]

    assert "Over the whole tolerance" in cells
    assert 280 / 256 in cells
    assert "high T_k" in cells
    assert "±28\u202f%" in cells
