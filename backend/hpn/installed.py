"""Parts of this installation beside its modules: the folders of data, and the packages of the extras."""

import json
from functools import cache
from importlib.metadata import PackageNotFoundError, distribution
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from urllib.parse import urlsplit
from urllib.request import url2pathname

from hpn.words.wording import N_, MendableError, Sentence

EXTRAS = {
    "serve": (
        *("aiosqlite", "alembic", "babel", "brotli", "fastapi", "httptools", "jinja2", "markupsafe", "openpyxl"),
        *(
            "orjson",
            "prometheus_client",
            "python_multipart",
            "segno",
            "sqlalchemy",
            "starlette",
            "structlog",
            "uvicorn",
        ),
        *("xlsxwriter", "zstandard"),
    ),
    "report": ("pypdf", "segno", "typst"),
    "aas": ("basyx", "pyecma376_2"),
    "mcp": ("anyio", "mcp", "mcp_types"),
    "fleet": ("pyarrow", "tqdm"),
    "cluster": ("dask", "distributed"),
    "postgres": ("psycopg",),
}
"""Modules that each extra of pyproject.toml brings for what needs it."""


PACKAGE = "hpn-select"

MISSING = N_(
    "the extra {extra} is not installed: install the wheel or folder that this program came from again, with [{extra}] "
    "behind its path"
)


class ExtraMissingError(MendableError):
    """An extra that is not installed; the sentence says how it is added.

    The text, which the person at the machine reads, gives the command where it is known: the package is on no index.
    """

    def __init__(self, extra: str) -> None:
        self.sentence = Sentence(MISSING, {"extra": extra})
        origin = _origin()
        known = f"the extra {extra} is not installed: pip install '{origin}[{extra}]'"
        super().__init__(self.sentence.text if origin is None else known)


def require(extra: str) -> None:
    """Raise ExtraMissingError where a module of an extra is not installed."""
    if not has_extra(extra):
        raise ExtraMissingError(extra)


@cache
def has_extra(extra: str) -> bool:
    """True where every module of an extra is installed."""
    return all(find_spec(module) for module in EXTRAS[extra])


def _origin() -> Path | None:
    """Wheel, sdist or folder that this was installed from, by the note of PEP 610, if it is still there."""
    try:
        noted = distribution(PACKAGE).read_text("direct_url.json")
        address = urlsplit(json.loads(noted or "{}").get("url", ""))
    except (PackageNotFoundError, ValueError):
        return None
    path = Path(url2pathname(address.path))
    return path if address.scheme == "file" and path.exists() else None


def data_folder(name: str) -> Path:
    """`catalogue`, `frontend/templates` or `frontend/dist`: in the package where the build put them there, else of the
    checkout that this is.
    """
    packed = Path(str(files("hpn") / "data"))
    return (packed if packed.is_dir() else Path(__file__).parents[2]) / name
