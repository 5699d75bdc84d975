"""Small files of cells that cost much to look at, and further kinds of what a format may repeat."""

import gzip
from collections.abc import Sequence
from functools import partial
from html import escape

import pyarrow as pa

from tests.fuzz.formats import (
    MAIN,
    MILLION,
    OTHERS,
    Make,
    arrow,
    many,
    parquet,
    row_of_strings,
    table_of,
    within,
    workbook,
    zeros,
)

LONGEST_CELL = 131_000
SAID = {
    "brackets": "[" * LONGEST_CELL,
    "brackets and blanks": "( " * (LONGEST_CELL // 2),
    "brackets that end": "[" * (LONGEST_CELL - 1) + "]",
    "digits and blanks": "1 " * (LONGEST_CELL // 2),
    "a digit, blanks and a letter": "5" + " " * (LONGEST_CELL - 2) + "x",
    "digits and letters": "1a" * (LONGEST_CELL // 2),
    "signs of thousands": "1'000" * (LONGEST_CELL // 5),
    "colons": ":" * LONGEST_CELL,
    "colons and blanks": ": " * (LONGEST_CELL // 2),
    "ratios": "5:1, i = 4 / " * (LONGEST_CELL // 13),
    "commas": "a," * (LONGEST_CELL // 2),
    "minus signs": "\N{MINUS SIGN}" * (LONGEST_CELL // 3),
    "degree signs": "°" * (LONGEST_CELL // 2),
    "dots": "." * LONGEST_CELL,
    "quotes": "'" * LONGEST_CELL,
    "a formula that is held as a text": '="' + "4" * LONGEST_CELL,
    "numbers and an exponent": "1e" * (LONGEST_CELL // 2),
    "names of totals": "max mittelwert " * (LONGEST_CELL // 15),
    "signs of comments": "#" * LONGEST_CELL,
    "slashes": "/" * LONGEST_CELL,
    "lines": "a\n" * (LONGEST_CELL // 2),
    "combining marks": "a\u0301\u0323" * (LONGEST_CELL // 5),
    "ligatures": "\ufdfa" * (LONGEST_CELL // 3),
    "signs of an exponent": "^(-1)" * (LONGEST_CELL // 5),
}
"""Cells by what fills them."""

_AXES_HEAD = ("Achse", "Moment [Nm]", "Drehzahl [1/min]", "Dauer [s]", "Ratio", "Size")
_AXIS = ("A", "40", "250", "1", "5", "14")


def rows_with(text: str) -> list[list[str]]:
    """A table of an axis that has a text in each place where one may stand."""
    spoiled = [[*_AXIS[:place], text, *_AXIS[place + 1 :]] for place in range(len(_AXIS))]
    return [[text], [*_AXES_HEAD, text], ["", "Nm", "1/min", "s", "", "", text], [*_AXIS, "1"], *spoiled]


def _quoted(cell: str) -> str:
    return '"' + cell.replace('"', '""') + '"'


def text_with(text: str) -> bytes:
    """The same as CSV."""
    return "\n".join(";".join(map(_quoted, row)) for row in rows_with(text)).encode()


def workbook_with(text: str) -> bytes:
    """The same as a workbook, whose places share the text."""
    texts = list(dict.fromkeys(cell for row in rows_with(text) for cell in row))
    rows = "".join(
        "<row>" + "".join(f'<c t="s"><v>{texts.index(cell)}</v></c>' for cell in row) + "</row>"
        for row in rows_with(text)
    )
    return workbook(rows, strings="".join(f'<si><t xml:space="preserve">{escape(each)}</t></si>' for each in texts))


def _styled(*formats: str) -> str:
    """Styles, one for each number format."""
    listed = "".join(
        f'<numFmt numFmtId="{k}" formatCode="{escape(code)}"/>' for k, code in enumerate(formats, start=200)
    )
    used = "".join(f'<xf numFmtId="{k}" applyNumberFormat="1"/>' for k in range(200, 200 + len(formats)))
    return f"<numFmts>{listed}</numFmts><cellXfs>{used}</cellXfs>"


def _rows_of(*rows: Sequence[str]) -> str:
    return "".join("<row>" + "".join(f"<c {cell}</c>" for cell in row) + "</row>" for row in rows)


_TORQUE = '<c t="inlineStr"><is><t>Drehmoment [Nm]</t></is></c>'
_HEAD = [f't="inlineStr"><is><t>{name}</t></is>' for name in "Tnt"]

WORKBOOKS: dict[str, Make] = {
    **{f"a workbook of {name}": partial(workbook_with, text) for name, text in SAID.items()},
    "dates beyond the calendar": lambda: workbook(
        _rows_of(_HEAD, *[['s="0"><v>1e308</v>', "><v>250</v>", "><v>1</v>"]] * 12_000), styles=_styled("yyyy-mm-dd")
    ),
    "dates": lambda: workbook(
        _rows_of(_HEAD, *[["><v>1</v>", "><v>1</v>", f's="0"><v>{45_000 + k / 9_000}</v>'] for k in range(9_000)]),
        styles=_styled("yyyy-mm-dd hh:mm:ss.000"),
    ),
    "times below nothing": lambda: workbook(
        _rows_of(_HEAD, *[["><v>1</v>", "><v>1</v>", 's="0"><v>-1e300</v>']] * 9_000), styles=_styled("[hh]:mm:ss")
    ),
    "a format of its own for each cell": lambda: workbook(
        _rows_of(_HEAD, *[[f's="{k}"><v>1</v>', "><v>1</v>", "><v>1</v>"] for k in range(6_000)]),
        styles=_styled(*[f"0.0{'[$' * 100}{k}" for k in range(6_000)]),
    ),
    "formats of quotes": lambda: workbook(
        _rows_of(_HEAD, *[[f's="{k}"><v>1</v>', "><v>1</v>", "><v>1</v>"] for k in range(6_000)]),
        styles=_styled(*[f'0{chr(34) * 240}"{k}' for k in range(6_000)]),
    ),
    "formats in thousands": lambda: workbook(
        _rows_of(_HEAD, *[['s="0"><v>4e300</v>', "><v>1</v>", "><v>1</v>"]] * 9_000), styles=_styled("0" + "," * 250)
    ),
    "numbers of a million digits": lambda: workbook(f"<row><c><v>{'1' * MILLION}</v></c></row>" * 7),
    "exponents of a million digits": lambda: workbook(f"<row><c><v>1e{'1' * MILLION}</v></c></row>" * 7),
    "errors and truths": lambda: workbook('<row><c t="e"><v>#N/A</v></c><c t="b"><v>1</v></c></row>' * 60_000),
    "long results of formulas": lambda: workbook(f'<row><c t="str"><f>A1</f><v>{"[" * 30_000}</v></c></row>' * 200),
    "long formulas without a result": lambda: workbook(f"<row><c><f>{'(' * 30_000}</f></c></row>" * 200),
    "texts that are in no list": lambda: workbook(row_of_strings(30_000, 9_999_999)),
    "comments of cells": lambda: workbook(
        more={"xl/comments1.xml": f'<comments xmlns="{MAIN}">{many("<comment/>", 7_000_000)}</comments>'}
    ),
    "a drawing": lambda: workbook(more={"xl/drawings/drawing1.xml": many("<a/>", 7_000_000)}),
    "a sheet with a long name": lambda: workbook(name="[" * MILLION),
    "very many sheets": lambda: workbook(sheets=140),
    "twenty wide sheets": lambda: workbook(
        "<row>" + _TORQUE * 190 + "</row>" + ("<row>" + "<c><v>1</v></c>" * 190 + "</row>") * 9, sheets=20
    ),
    "merged numbers": lambda: workbook(
        "".join(f'<row r="{k}"><c r="A{k}"><v>1</v></c><c r="CV{k}"><v>1</v></c></row>' for k in range(1, 1_400)),
        behind="<mergeCells>" + "".join(f'<mergeCell ref="A{k}:CU{k}"/>' for k in range(1, 1_400)) + "</mergeCells>",
    ),
    "merged cells over one another": lambda: workbook(
        "".join(f'<row r="{k}"><c r="A{k}"><v>1</v></c></row>' for k in range(1, 400)),
        behind="<mergeCells>" + '<mergeCell ref="A1:A399"/>' * 15_000 + "</mergeCells>",
    ),
    "every second row hidden": lambda: workbook(
        "".join(f'<row r="{k}" hidden="{k % 2}"><c><v>1</v></c></row>' for k in range(1, 30_000))
    ),
    "rows from below": lambda: workbook(
        "".join(f'<row r="{k}"><c r="A{k}"><v>1</v></c></row>' for k in range(15_000, 0, -1))
    ),
    "one row again and again": lambda: workbook('<row r="1"><c r="A1"><v>1</v></c></row>' * 100_000),
    "one cell again and again": lambda: workbook(within("row", '<c r="A1"><v>1</v></c>')),
    "headings as long as any is read": lambda: workbook(
        "<row>"
        + f'<c t="inlineStr"><is><t>{"[( " * 330}</t></is></c>' * 199
        + "</row>"
        + ("<row>" + "<c><v>1</v></c>" * 199 + "</row>") * 30
    ),
    "entities": lambda: workbook(f'<row><c t="inlineStr"><is><t>{"&#91;" * 130_000}</t></is></c></row>' * 4),
    "entities in one another": lambda: workbook(
        more={
            "xl/sharedStrings.xml": "<!DOCTYPE a [<!ENTITY a0 'aaaaaaaaaa'>"
            + "".join(f"<!ENTITY a{k} '{f'&a{k - 1};' * 10}'>" for k in range(1, 12))
            + f']><sst xmlns="{MAIN}"><si><t>&a11;</t></si></sst>'
        }
    ),
    "rules for what may be typed": lambda: workbook(
        behind=within("dataValidations", '<dataValidation sqref="A1"><formula1>1</formula1></dataValidation>')
    ),
    "links": lambda: workbook(behind=within("hyperlinks", '<hyperlink ref="A1" location="B1"/>')),
    "filters": lambda: workbook(behind=within("autoFilter", '<filterColumn colId="0"/>')),
    "protected ranges": lambda: workbook(behind=within("protectedRanges", '<protectedRange name="a" sqref="A1"/>')),
    "names in very many spaces": lambda: workbook(
        "<row " + " ".join(f'xmlns:a{k}="urn:{k}"' for k in range(15_000)) + "/>"
    ),
}
"""Workbooks of cells that cost much to look at, and further kinds of what a workbook may repeat."""

TEXTS: dict[str, Make] = {
    **{f"cells of {name}": partial(text_with, text[: LONGEST_CELL // 40]) for name, text in SAID.items()},
    "a heading of 95,000 brackets": lambda: b"[" * 95_000 + b";a;b\nT;n;t\n40;250;1\n",
    "a ratio of blanks": lambda: (";".join(_AXES_HEAD) + "\nA;40;250;1;5" + " " * 95_000 + "x;14\n").encode(),
    "a size of commas": lambda: (";".join(_AXES_HEAD) + "\nA;40;250;1;5;" + "a," * 48_000 + "\n").encode(),
    "a quote that is never closed": lambda: b'T;n;t\n"' + b"1;2;3\n" * 16_000,
    "quotes in quotes": lambda: b'T;n;t\n"' + b'""' * 48_000 + b'";2;3\n',
    "lines in quotes": lambda: b'T;n;t\n"' + b"\n" * 95_000 + b'";2;3\n',
    "carriage returns": lambda: b"1\t2\t3\r" * 16_000,
    "rules of Markdown": lambda: b"|T|n|t|\n" + b"|-|-|-|\n" * 12_000 + b"|1|2|3|\n",
    "a long rule of Markdown": lambda: b"|T|n|t|\n|" + b"-" * 95_000 + b"x|\n|1|2|3|\n",
    "a separator that is told": lambda: b"sep=[\n" + b"1[2[3\n" * 15_000,
    "times on a clock": lambda: b"T;n;t\n" + b"1;2;0:00:30.5\n" * 6_500,
    "moments": lambda: b"T;n;t\n" + b"".join(b"1;2;2026-03-01T08:%02d:00\n" % (k % 60) for k in range(3_600)),
    "units in cells": lambda: b"T;n;t\n" + b"1 kg.cm;2 1/min;3 ms\n" * 3_800,
    "rows of names": lambda: b"a;b;c;d\n" * 45 + b"T;n;t;x\n" + b"1;2;3;4\n" * 9_000,
    "names of phases": lambda: b"Name;T;n;t\n" + b"".join(b"%030d x;1;2;3\n" % k for k in range(2_400)),
    "axes that come and go": lambda: (
        (";".join(_AXES_HEAD[:4]) + "\n").encode() + b"".join(b"%d;1;2;3\n" % (k % 2) for k in range(9_000))
    ),
    "UTF-16 of brackets": lambda: ("\ufeff" + "[" * 45_000 + ";a;b\nT;n;t\n40;250;1\n").encode("utf-16-le"),
    "UTF-32 of brackets": lambda: ("\ufeff" + "[" * 22_000 + ";a;b\nT;n;t\n40;250;1\n").encode("utf-32-le"),
}

PACKED: dict[str, Make] = {
    "gzip of four million brackets": lambda: gzip.compress(b"[" * 4 * MILLION + b";a;b\nT;n;t\n40;250;1\n"),
    "gzip of 131,000 brackets": lambda: gzip.compress(b"[" * 131_000 + b";a;b\nT;n;t\n40;250;1\n"),
    "gzip of nothing, 10⁸ times": lambda: gzip.compress(bytes(90 * MILLION)),
    "gzip of rows": lambda: gzip.compress((";".join(_AXES_HEAD[:4]) + "\n").encode() + b"a;1;2;3\n" * 400_000),
    "gzip in very many parts": lambda: gzip.compress(b"axis,torque_Nm\n") * 2_000,
    "gzip of one row of commas": lambda: gzip.compress(b"," * 3 * MILLION),
}
"""Texts in gzip."""

TABLES: dict[str, Make] = {
    "Parquet with a heading of brackets": lambda: parquet(
        table_of(*[zeros(1)] * 4, names=("[" * 30_000, "T", "n", "t"))
    ),
    "Parquet with ratios of blanks": lambda: parquet(
        pa.table({"Achse": ["A"], "T Nm": [1.0], "n rpm": [1.0], "t s": [1.0], "Ratio": ["5" + " " * 130_000 + "x"]})
    ),
    "Arrow of decimals": lambda: arrow(
        pa.RecordBatch.from_arrays([zeros(30_000, pa.decimal128(38, 30))] * 4, names=list(OTHERS))
    ),
    "Arrow of moments": lambda: arrow(
        pa.RecordBatch.from_arrays([zeros(30_000, pa.timestamp("ns"))] * 4, names=list(OTHERS))
    ),
    "Arrow of bytes": lambda: arrow(pa.RecordBatch.from_arrays([pa.array([b"["] * 9_000)] * 4, names=list(OTHERS))),
    "Arrow of pairs": lambda: arrow(
        pa.RecordBatch.from_arrays([pa.array([[("a", 1)]] * 9_000, pa.map_(pa.string(), pa.int8()))], names=["a"])
    ),
    "Arrow with one name again and again": lambda: arrow(
        pa.RecordBatch.from_arrays([zeros(100)] * 180, names=["Drehmoment [Nm]"] * 180)
    ),
    "Parquet with very much said beside": lambda: parquet(
        table_of(*[zeros(1)] * 4, names=OTHERS).replace_schema_metadata({"a": "[" * 50_000})
    ),
}
