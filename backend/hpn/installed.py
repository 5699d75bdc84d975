"""Parts of this installation beside its modules: the folders of data, and the packages of the extras."""

from functools import cache
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path

from hpn.words.wording import N_, MendableError, Sentence

EXTRAS = {
    "serve": (
        *("aiosqlite", "alembic", "babel", "brotli", "fastapi", "httptools", "jinja2", "markupsafe", "openpyxl"),
        *("orjson", "prometheus_client", "segno", "sqlalchemy", "starlette", "structlog", "uvicorn", "xlsxwriter"),
        "zstandard",
    ),
    "report": ("segno", "typst"),
    "aas": ("basyx", "pyecma376_2"),
    "fleet": ("pyarrow", "tqdm"),
    "cluster": ("dask", "distributed"),
    "postgres": ("psycopg",),
}
"""Modules that each extra of pyproject.toml brings for what needs it."""


MISSING = N_("the extra {extra} is not installed: pip install 'hpn-select[{extra}]'")


class ExtraMissingError(MendableError):
    """An extra that is not installed; the text names it and how it is, the sentence says the same in any language."""

    def __init__(self, extra: str) -> None:
        super().__init__(MISSING.format(extra=extra))
        self.sentence = Sentence(MISSING, {"extra": extra})


def require(extra: str) -> None:
    """Raise ExtraMissingError where a module of an extra is not installed."""
    if not _is_installed(extra):
        raise ExtraMissingError(extra)


@cache
def _is_installed(extra: str) -> bool:
    return all(find_spec(module) for module in EXTRAS[extra])


def data_folder(name: str) -> Path:
    """`catalogue`, `frontend/templates` or `frontend/dist`: in the package where the build put them there, else of the
    checkout that this is.
    """
    packed = Path(str(files("hpn") / "data"))
    return (packed if packed.is_dir() else Path(__file__).parents[2]) / name
