"""Small files that stand for very much: in each format, what can be repeated or claimed, a million-fold."""

import io
import json
from collections.abc import Sequence
from functools import cache

import pyarrow as pa
import pyarrow.parquet as pq

from tests.fuzz import cells
from tests.fuzz.formats import (
    MILLION,
    OTHERS,
    PHASE,
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

LETTERS = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"

# --- XLSX -------------------------------------------------------------------------------------------------------------


WORKBOOKS: dict[str, Make] = {
    "a cell in the last row of 20 sheets": lambda: workbook(
        '<row r="1048576"><c r="A1048576"><v>1</v></c></row>', sheets=20
    ),
    "a cell in the last column of each row": lambda: workbook(
        "".join(f'<row r="{k}"><c r="XFD{k}"><v>1</v></c></row>' for k in range(1, 100_000))
    ),
    "1,500,000 formats": lambda: workbook(styles="<cellXfs>" + "<xf/>" * 1_500_000 + "</cellXfs>"),
    "formats in a part of another name": lambda: workbook(
        styles="<cellXfs>" + "<xf/>" * 1_500_000 + "</cellXfs>", styles_at="x.xml"
    ),
    "fonts": lambda: workbook(styles=within("fonts", "<font/>")),
    "fills": lambda: workbook(styles=within("fills", "<fill/>")),
    "borders": lambda: workbook(styles=within("borders", "<border/>")),
    "number formats": lambda: workbook(styles=within("numFmts", '<numFmt numFmtId="200" formatCode="0"/>')),
    "names of styles": lambda: workbook(styles=within("cellStyles", '<cellStyle name="a" xfId="0"/>')),
    "conditional styles": lambda: workbook(styles=within("dxfs", "<dxf/>")),
    "colours": lambda: workbook(styles=f"<colors>{within('indexedColors', '<rgbColor/>')}</colors>"),
    "a long number format on each cell": lambda: workbook(
        "".join('<row><c s="1"><v>1</v></c></row>' for _ in range(60_000)),
        styles='<numFmts><numFmt numFmtId="200" formatCode="'
        + "0;" * 1_000_000
        + '"/></numFmts><cellXfs><xf/><xf numFmtId="200"/></cellXfs>',
    ),
    "shared strings": lambda: workbook(strings=many("<si/>")),
    "rich texts": lambda: workbook(strings=many("<si><r><t>a</t></r></si>")),
    "one rich text of very many parts": lambda: workbook(strings=within("si", "<r/>")),
    "phonetic parts": lambda: workbook(strings=within("si", '<rPh sb="0" eb="1"/>')),
    "a long text in each cell": lambda: workbook(
        row_of_strings(100_000, 0), strings=f"<si><t>{'a' * 2_000_000}</t></si>"
    ),
    "a text as long as may be in each cell": lambda: workbook(
        row_of_strings(100_000, 0), strings=f"<si><t>{'a' * 32_000}</t></si>"
    ),
    "empty rows": lambda: workbook(many("<row/>")),
    "empty cells": lambda: workbook(within("row", "<c/>")),
    "cells in one row": lambda: workbook(within("row", "<c><v>1</v></c>")),
    "cells by the row": lambda: workbook(many("<row><c><v>1</v></c></row>")),
    "inline texts": lambda: workbook(many('<row><c t="inlineStr"><is><t>a</t></is></c></row>')),
    "formulas": lambda: workbook(many("<row><c><f>A1</f></c></row>")),
    "merged cells": lambda: workbook(behind=within("mergeCells", '<mergeCell ref="A1:B2"/>')),
    "large merged cells": lambda: workbook(
        behind="<mergeCells>" + '<mergeCell ref="A2:XFD1048576"/>' * 19_000 + "</mergeCells>"
    ),
    "hidden columns": lambda: workbook(before=within("cols", '<col min="1" max="16384" hidden="1"/>')),
    "rules of conditional formats": lambda: workbook(behind=many('<conditionalFormatting sqref="A1"/>')),
    "defined names": lambda: workbook(names=within("definedNames", '<definedName name="a">S1!A1</definedName>')),
    "content types": lambda: workbook(types=many('<Default Extension="a" ContentType="b"/>')),
    "relations": lambda: workbook(relations=many('<Relationship Id="a" Type="b" Target="c"/>')),
    "elements in one another": lambda: workbook("<a>" * 900_000 + "</a>" * 900_000),
    "attributes": lambda: workbook("<row " + " ".join(f'a{k}="1"' for k in range(30_000)) + "/>"),
    "very many parts": lambda: workbook(more={f"{k}": "" for k in range(900)}),
    "comments and white space": lambda: workbook(many("<!---->")),
}
"""Workbooks by what is repeated in them; no part of a workbook here is read that Excel would not read as well."""

# --- Parquet and Arrow ------------------------------------------------------------------------------------------------


def _nothing(count: int) -> pa.Array:
    return pa.Array.from_buffers(pa.null(), count, [None])


def long_text(length: int) -> pa.Array:
    """One text of so many characters."""
    offsets = pa.py_buffer(b"\0\0\0\0" + length.to_bytes(4, "little"))
    return pa.StringArray.from_buffers(1, offsets, pa.py_buffer(b"a" * length))


def _of_one(text: pa.Array, names: Sequence[str] = PHASE) -> pa.Table:
    return table_of(text, *[zeros(1)] * 3, names=names)


def _many_rows(names: Sequence[str], rows: int = 100 * MILLION, groups: int = 100) -> bytes:
    out = io.BytesIO()
    part = table_of(*[zeros(rows // groups, pa.int8())] * len(names), names=names)
    with pq.ParquetWriter(out, part.schema, compression="zstd") as file:
        for _ in range(groups):
            file.write_table(part, row_group_size=rows // groups)
    return out.getvalue()


def _nested(depth: int) -> pa.DataType:
    kind: pa.DataType = pa.float64()
    for _ in range(depth):
        kind = pa.struct([("a", kind)])
    return kind


def _dictionary(length: int, rows: int) -> pa.Array:
    return pa.DictionaryArray.from_arrays(zeros(rows, pa.int32()), long_text(length))


TABLES: dict[str, Make] = {
    "Parquet of 10⁸ rows": lambda: _many_rows(("a",)),
    "Parquet of 10⁷ phases": lambda: _many_rows(PHASE[1:], 10 * MILLION, 10),
    "Parquet of 10⁷ rows as the command names them": lambda: _many_rows(PHASE, 10 * MILLION, 10),
    "Parquet with a long text": lambda: parquet(_of_one(long_text(400 * MILLION), OTHERS), write_statistics=False),
    "Parquet with a long axis": lambda: parquet(_of_one(long_text(400 * MILLION)), write_statistics=False),
    "Parquet with one long text in each row": lambda: parquet(
        table_of(_dictionary(30_000, 30_000), *[zeros(30_000)] * 3, names=OTHERS)
    ),
    "Parquet of many columns": lambda: parquet(table_of(*[zeros(1)] * 2000, names=[f"c{k}" for k in range(2000)])),
    "Parquet of many groups of rows": lambda: parquet(table_of(zeros(1000), names=("a",)), row_group_size=1),
    "Parquet of types in one another": lambda: parquet(
        pa.table({"a": pa.array([None] * 1000, _nested(90)), "b": [1.0] * 1000})
    ),
    "Arrow of 20 columns and 10⁷ rows": lambda: arrow(
        pa.RecordBatch.from_arrays([zeros(10 * MILLION)] * 20, names=list(LETTERS[:20]))
    ),
    "Arrow of 10⁷ phases as the command names them": lambda: arrow(
        pa.RecordBatch.from_arrays([zeros(10 * MILLION, pa.int64()), *[zeros(10 * MILLION)] * 3], names=list(PHASE))
    ),
    "Arrow with an axis of 3·10⁸ characters": lambda: arrow(
        pa.RecordBatch.from_arrays([long_text(300 * MILLION), *[zeros(1)] * 3], names=list(PHASE))
    ),
    "Arrow with a long text": lambda: arrow(
        pa.RecordBatch.from_arrays([long_text(500 * MILLION), *[zeros(1)] * 3], names=list(OTHERS))
    ),
    "Arrow of nothing, 2⁴⁰ times": lambda: arrow(
        *[pa.RecordBatch.from_arrays([_nothing(2**31 - 1)], names=["a"])] * 500
    ),
    "Arrow of axes without anything, 2³⁹ times": lambda: arrow(
        *[pa.RecordBatch.from_arrays([_nothing(2**31 - 1)] * 4, names=list(PHASE))] * 200
    ),
    "Arrow of a dictionary": lambda: arrow(
        pa.RecordBatch.from_arrays([_dictionary(30_000, 30_000), *[zeros(30_000)] * 3], names=list(OTHERS))
    ),
    "Arrow with one long axis in each row": lambda: arrow(
        pa.RecordBatch.from_arrays([_dictionary(30_000, 30_000), *[zeros(30_000)] * 3], names=list(PHASE))
    ),
    "Arrow of batches": lambda: arrow(*[pa.RecordBatch.from_arrays([zeros(1)], names=["a"])] * 400),
    "Arrow of columns": lambda: arrow(
        pa.RecordBatch.from_arrays([zeros(1)] * 1000, names=[f"c{k}" for k in range(1000)])
    ),
    "Arrow of types in one another": lambda: arrow(
        pa.RecordBatch.from_arrays([pa.array([None] * 1000, _nested(60))], names=["a"])
    ),
    "Arrow of one list of very many": lambda: arrow(
        pa.RecordBatch.from_arrays(
            [
                pa.array(["a"]),
                *[
                    pa.ListArray.from_arrays(pa.array([0, 20 * MILLION], pa.int32()), zeros(20 * MILLION))
                    for _ in range(3)
                ],
            ],
            names=list(PHASE),
        )
    ),
    "Arrow of a long text in a list": lambda: arrow(
        pa.RecordBatch.from_arrays(
            [
                pa.array(["a"]),
                *[pa.array([[1.0]])] * 3,
                pa.ListArray.from_arrays(pa.array([0, 1], pa.int32()), long_text(300 * MILLION)),
            ],
            names=[*PHASE, "requirements.sizes"],
        )
    ),
    "Arrow of a long text where a word belongs": lambda: arrow(
        pa.RecordBatch.from_arrays(
            [pa.array(["a"]), *[pa.array([[1.0]])] * 3, long_text(300 * MILLION)], names=[*PHASE, "rank_by"]
        )
    ),
}

# --- Texts ------------------------------------------------------------------------------------------------------------

TEXTS: dict[str, Make] = {
    "semicolons": lambda: b";" * 100_000,
    "rows of one cell": lambda: b"1\n" * 50_000,
    "lines without anything": lambda: b"\n" * 100_000,
    "columns": lambda: b";".join(b"%d" % k for k in range(20_000)) + b"\n1;2;3\n",
    "blanks": lambda: b"1 " * 50_000,
    "rows and columns": lambda: b"1;1;1;1\n" * 12_500,
    "rows of three readings": lambda: b"1,1 1,1 1,1\n" * 8_000,
    "quotes": lambda: b'"' * 99_999,
    "one cell": lambda: b"T;n;t\n" + b"1" * 99_000 + b";2;3\n",
    "cells too long for numbers": lambda: b"T;n;t\n" + (b"1" * 390 + b";2;3\n") * 250,
    "headings": lambda: b";".join([b"Drehmoment [Nm]"] * 199) + b"\n" + b";".join([b"1"] * 199) + b"\n",
    "header rows": lambda: b"T;n;t\nNm;rpm;s\n" * 7_000 + b"1;2;3\n",
    "titles": lambda: b"T;n;t\n1;2;3\n" + b"Summe;;\n1;2;3\n" * 7_000,
    "bars": lambda: b"|1|2|3|\n" * 12_000,
    "axes": lambda: (
        b"Achse;Moment [Nm];Drehzahl [1/min];Dauer [s]\n" + b"".join(b"%d;1;2;3\n" % k for k in range(7_000))
    ),
    "one axis": lambda: b"Achse;Moment [Nm];Drehzahl [1/min];Dauer [s]\n" + b"a;1;2;3\n" * 12_000,
    "an axis with a long name": lambda: b"Achse;Moment [Nm];Drehzahl [1/min];Dauer [s]\n" + b"a" * 30_000 + b";1;2;3\n",
    "columns as the command names them": lambda: b"axis,torque_Nm,speed_rpm,duration_s\n" + b",,,,,,,,\n" * 10_000,
    "broken rows": lambda: b"axis,torque_Nm,speed_rpm,duration_s\n" + b"a,1\n" * 24_000,
    "UTF-16": lambda: ("\ufeff" + ";" * 49_000).encode("utf-16-le"),
}

OBJECTS: dict[str, Make] = {
    "14,000 rows, each with a key of its own": lambda: b"".join(b'{"k%d":1}\n' % k for k in range(14_000)),
    "a row of keys": lambda: json.dumps({f"k{k}": 1 for k in range(8_000)}).encode(),
    "objects in one another": lambda: b'{"a":' * 20_000 + b"1" + b"}" * 20_000,
    "lists in one another": lambda: b'{"a":' + b"[" * 49_000 + b"]" * 49_000 + b"}",
    "a number of many digits": lambda: b'{"axis":"a","x":' + b"1" * 90_000 + b"}",
    "an exponent of many digits": lambda: b'{"axis":"a","x":1e' + b"1" * 90_000 + b"}",
    "one name again and again": lambda: b"{" + b'"a":1,' * 16_000 + b'"a":1}',
    "broken lines": lambda: b'{"axis":"a","torque_Nm":[1],"speed_rpm":[1],"duration_s":[1]}\n' + b"{x\n" * 33_000,
    "objects that say nothing": lambda: b"{}\n" * 33_000,
    "a list for each axis": lambda: b'{"axis":"a","torque_Nm":[1],"speed_rpm":[1],"duration_s":[1]}\n' * 1_500,
    "one list": lambda: b'{"axis":"a","torque_Nm":[%s1],"speed_rpm":[1],"duration_s":[1]}' % (b"1," * 49_000),
    "phases without anything": lambda: b'{"duty_cycle":{"phases":[' + b"{}," * 33_000 + b"{}]}}",
    "phases that are none": lambda: b'{"duty_cycle":{"phases":[' + b"1," * 49_000 + b"1]}}",
    "phases": lambda: (
        b'{"duty_cycle":{"phases":[' + b",".join([b'{"torque_Nm":1,"speed_rpm":1,"duration_s":1}'] * 2_000) + b"]}}"
    ),
    "fields that are unknown": lambda: (
        b'{"duty_cycle":{"phases":[{"torque_Nm":1,"speed_rpm":1,"duration_s":1}]},'
        + b",".join(b'"k%d":1' % k for k in range(9_000))
        + b"}"
    ),
    "ratios": lambda: (
        b'{"duty_cycle":{"phases":[{"torque_Nm":1,"speed_rpm":1,"duration_s":1}]},'
        b'"requirements":{"ratios":[' + b"5," * 45_000 + b"5]}}"
    ),
    "moves": lambda: (
        b'{"duty_cycle":{"motion":{"mechanism":{"type":"rotary","inertia_kgm2":1,"gravity_mass_kg":1,'
        b'"gravity_radius_mm":1},"moves":['
        + b",".join([b'{"profile":"trapezoidal","angle_deg":360000,"time_s":1}'] * 1_000)
        + b"]}}}"
    ),
}

WORKBOOKS |= cells.WORKBOOKS
TABLES |= cells.TABLES
TEXTS |= cells.TEXTS
PACKED = cells.PACKED

FILES: dict[str, Make] = {**WORKBOOKS, **TABLES, **TEXTS, **PACKED, **OBJECTS}
"""All of them by name."""

NAMES = {
    **{**dict.fromkeys(WORKBOOKS, "a.xlsx"), **dict.fromkeys(TEXTS, "a.csv"), **dict.fromkeys(OBJECTS, "a.json")},
    **dict.fromkeys(PACKED, "a.csv.gz"),
}


@cache
def made(name: str) -> bytes:
    """One of them: to make it may take a second."""
    return FILES[name]()


def name_of(name: str) -> str:
    """Name of such a file."""
    return NAMES.get(name) or ("a.parquet" if name.startswith("Parquet") else "a.arrow")
