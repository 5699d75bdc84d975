"""LibreOffice, as the second opinion on a workbook, and a machine."""

import shutil
import subprocess
from collections.abc import Callable, Mapping
from pathlib import Path

import openpyxl
import pytest
from openpyxl.workbook import Workbook

from hpn.catalogue import load_catalogue
from hpn.documents.revision import Frozen
from tests.machines import COMMON, frozen, packing_line
from tests.report.machines import TITLE

Recalculate = Callable[[Mapping[str, Workbook]], dict[str, Workbook]]
Convert = Callable[[Mapping[str, Workbook], str], dict[str, Path]]


@pytest.fixture(scope="session")
def convert(tmp_path_factory: pytest.TempPathFactory) -> Convert:
    """Files that LibreOffice makes of workbooks; the saved values of formulas are gone before it sees them."""
    program = shutil.which("soffice") or shutil.which("libreoffice")
    assert program, "LibreOffice is missing; `make office` installs it"
    folder = tmp_path_factory.mktemp("office")

    def run(books: Mapping[str, Workbook], kind: str) -> dict[str, Path]:
        sources = [_saved(book, folder / f"{name}.xlsx") for name, book in books.items()]
        profile = f"-env:UserInstallation={(folder / 'profile').as_uri()}"
        command = [program, "--headless", profile, "--convert-to", kind, "--outdir", str(folder / "out")]
        subprocess.run([*command, *map(str, sources)], check=True, capture_output=True, timeout=300)
        return {name: folder / "out" / f"{name}.{kind.partition(':')[0]}" for name in books}

    return run


@pytest.fixture(scope="session")
def recalculate(convert: Convert) -> Recalculate:
    """Workbooks as LibreOffice calculates them."""
    return lambda books: {
        name: openpyxl.load_workbook(path, data_only=True) for name, path in convert(books, "xlsx").items()
    }


def _saved(book: Workbook, path: Path) -> Path:
    book.save(path)  # openpyxl writes formulas without their values
    return path


@pytest.fixture(scope="session")
def line() -> Frozen:
    """Revision of a packing line of 40 axes."""
    return frozen(packing_line(pallet=3), load_catalogue(), COMMON, title=TITLE)
