"""Files of each format, made by hand: workbooks of parts as they are given, tables of Arrow."""

import io
import zipfile
from collections.abc import Callable, Mapping, Sequence

import pyarrow as pa
import pyarrow.parquet as pq

Make = Callable[[], bytes]

MILLION = 1_000_000

# --- XLSX -------------------------------------------------------------------------------------------------------------

MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
RELATIONS = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
PACKAGE = "http://schemas.openxmlformats.org/package/2006"
TYPES = "application/vnd.openxmlformats-officedocument.spreadsheetml"
TABLE = '<row><c t="inlineStr"><is><t>T</t></is></c></row><row><c><v>40</v></c><c><v>250</v></c><c><v>1</v></c></row>'


def workbook(
    data: str = TABLE,
    *,
    behind: str = "",
    before: str = "",
    styles: str = "",
    strings: str = "",
    names: str = "",
    types: str = "",
    relations: str = "",
    sheets: int = 1,
    name: str = "S",
    more: Mapping[str, str] | None = None,
    styles_at: str = "styles.xml",
) -> bytes:
    """A workbook of hand-made parts: rows of each sheet, what stands before and behind them, and what else it has."""
    places = range(1, sheets + 1)
    overrides = "".join(
        f'<Override PartName="/xl/worksheets/sheet{k}.xml" ContentType="{TYPES}.worksheet+xml"/>' for k in places
    )
    listed = "".join(f'<sheet name="{name}{k}" sheetId="{k}" r:id="s{k}"/>' for k in places)
    targets = "".join(
        f'<Relationship Id="s{k}" Type="{RELATIONS}/worksheet" Target="worksheets/sheet{k}.xml"/>' for k in places
    )
    sheet = f'<worksheet xmlns="{MAIN}">{before}<sheetData>{data}</sheetData>{behind}</worksheet>'
    parts = {
        "[Content_Types].xml": f'<Types xmlns="{PACKAGE}/content-types"><Default Extension="xml" '
        f'ContentType="application/xml"/><Default Extension="rels" ContentType="{PACKAGE}.relationships+xml"/>'
        f'<Override PartName="/xl/workbook.xml" ContentType="{TYPES}.sheet.main+xml"/>'
        f'<Override PartName="/xl/{styles_at}" ContentType="{TYPES}.styles+xml"/>'
        f'<Override PartName="/xl/sharedStrings.xml" ContentType="{TYPES}.sharedStrings+xml"/>{overrides}{types}'
        "</Types>",
        "_rels/.rels": f'<Relationships xmlns="{PACKAGE}/relationships"><Relationship Id="r" '
        f'Type="{RELATIONS}/officeDocument" Target="xl/workbook.xml"/></Relationships>',
        "xl/_rels/workbook.xml.rels": f'<Relationships xmlns="{PACKAGE}/relationships">{targets}'
        f'<Relationship Id="t" Type="{RELATIONS}/styles" Target="{styles_at}"/>'
        f'<Relationship Id="u" Type="{RELATIONS}/sharedStrings" Target="sharedStrings.xml"/>{relations}'
        "</Relationships>",
        "xl/workbook.xml": f'<workbook xmlns="{MAIN}" xmlns:r="{RELATIONS}"><sheets>{listed}</sheets>{names}'
        "</workbook>",
        f"xl/{styles_at}": f'<styleSheet xmlns="{MAIN}">{styles}</styleSheet>',
        "xl/sharedStrings.xml": f'<sst xmlns="{MAIN}">{strings}</sst>',
        **{f"xl/worksheets/sheet{k}.xml": sheet for k in places},
        **(more or {}),
    }
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name, content in parts.items():
            archive.writestr(name, content)
    return out.getvalue()


def many(element: str, of: int = 7_800_000) -> str:
    """An element as often as the unpacked size lets it be there."""
    return element * (of // len(element))


def within(whole: str, element: str) -> str:
    """An element as often as may be within another."""
    return f"<{whole}>{many(element)}</{whole}>"


def row_of_strings(count: int, text: int) -> str:
    """Rows of one cell each, all with the same shared text."""
    return "".join(f'<row r="{k}"><c t="s"><v>{text}</v></c></row>' for k in range(1, count + 1))


# --- Parquet and Arrow ------------------------------------------------------------------------------------------------

PHASE = ("axis", "torque_Nm", "speed_rpm", "duration_s")

OTHERS = ("Achse", "Moment", "Drehzahl", "Dauer")
"""Names of columns that only a page reads."""


def parquet(table: pa.Table, **options: object) -> bytes:
    """A table as Parquet."""
    out = io.BytesIO()
    pq.write_table(table, out, compression="zstd", **options)
    return out.getvalue()


def arrow(*batches: pa.RecordBatch) -> bytes:
    """Batches as an Arrow file."""
    out = io.BytesIO()
    with pa.ipc.new_file(out, batches[0].schema, options=pa.ipc.IpcWriteOptions(compression="zstd")) as file:
        for batch in batches:
            file.write_batch(batch)
    return out.getvalue()


def zeros(count: int, kind: pa.DataType | None = None) -> pa.Array:
    """So many zeros."""
    kind = kind or pa.float64()
    return pa.Array.from_buffers(kind, count, [None, pa.py_buffer(bytes(count * kind.bit_width // 8))])


def table_of(*values: pa.Array, names: Sequence[str] = PHASE) -> pa.Table:
    """Columns as a table."""
    return pa.Table.from_arrays(list(values), names=list(names[: len(values)]))
