"""The PDF report against PDF/UA-1, by veraPDF."""

import shutil
import subprocess
from pathlib import Path

import pytest

from hpn.catalogue import Catalogue
from hpn.files.export import DIGITS
from hpn.files.report.pdf import pdf
from hpn.words.reader import Reader
from hpn.words.units import PRESETS
from tests.report.cases import CASES, language, typed_export_of

ROOT = Path(__file__).parents[2]
LIBRARY, CHECK = ROOT / ".venv/pdfua", ROOT / "tests/report/pdfua/PdfUa.java"
TITLES = {"example": "旋转工作台 مرحبا घूर्णन 😀", "everything": "བོ \ue000 \u0378"}


@pytest.mark.soak
def test_reports_comply_with_PDF_UA(catalogue: Catalogue, tmp_path: Path) -> None:
    if not (LIBRARY / ".installed").is_file() or not shutil.which("java"):
        pytest.skip("no veraPDF here: `make pdfua` needs Java, Maven and Maven Central")
    for name, case in CASES.items():
        for reader in (language("en"), language("de"), Reader("en", PRESETS["US"], DIGITS)):
            export = typed_export_of(case, catalogue, title=TITLES.get(name, "Rotary table"))
            (tmp_path / f"{name} {reader.marker}.pdf").write_bytes(pdf(export, reader))
    files = sorted(map(str, tmp_path.iterdir()))
    run = subprocess.run(["java", "-cp", f"{LIBRARY}/*", str(CHECK), *files], capture_output=True, text=True)
    print(run.stdout)
    assert run.returncode == 0, run.stdout + run.stderr
    assert run.stdout.count("compliant true") == len(files)
