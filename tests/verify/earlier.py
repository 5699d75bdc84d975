"""Files of earlier versions, made of the texts that were taken out of them: `files/1.0.0/report.pdf.json`, and so on.

Each was written by that very version, of the handbook's example. A workbook or package is held by its parts, which are
text; a report by the text of its pages, its links and its language, and it is set again, a line for each of its lines.
"""

import json
from functools import cache
from io import BytesIO
from pathlib import Path
from zipfile import ZipFile

import typst

FOLDER = Path(__file__).parent / "files"
VERSIONS = ("1.0.0", "1.1.0")

PAGES = """
#let told = json(bytes(sys.inputs.told))
#set document(title: "Report")
#set text(lang: told.language, size: 9pt, hyphenate: false)
#set page(width: auto, height: auto)
#for (number, page) in told.pages.enumerate() {
  if number > 0 { pagebreak() }
  for line in page.split("\\n") { block(line) }
  if number == 0 { for address in told.links { place(link(address, box(width: 1pt, height: 1pt))) } }
}
"""


@cache
def file_of(version: str, name: str) -> bytes:
    """Content of a file of that version."""
    path = FOLDER / version / name
    if path.suffix == ".json":
        return path.read_bytes()
    notice = path.with_name(f"{name}.json").read_text(encoding="utf-8")
    if path.suffix == ".pdf":
        output = typst.compile(PAGES.encode(), format="pdf", ignore_system_fonts=True, sys_inputs={"told": notice})
        assert isinstance(output, bytes)
        return output
    packed = BytesIO()
    with ZipFile(packed, "w") as archive:
        for part, text in json.loads(notice).items():
            archive.writestr(part, text)
    return packed.getvalue()
