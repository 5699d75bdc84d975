"""Settings as text for `hpn --help`."""

import shutil
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from pydantic import SecretStr

from hpn.web.settings import Settings

INDENT = " " * 6


def text() -> str:
    """All settings with default and meaning, in lines of the terminal's width."""
    head = "settings, as environment variables or files of HPN_SECRETS_FOLDER; docs/settings.md says more:"
    return "\n".join([head, *_lines(min(shutil.get_terminal_size().columns, 120))]) + "\n"


def _lines(width: int) -> Iterator[str]:
    for name, field in Settings.model_fields.items():
        default = _text(field.default)
        yield f"  HPN_{name.upper()}{f' ({default})' if default else ''}"
        yield from textwrap.wrap(
            field.description or "",
            width,
            initial_indent=INDENT,
            subsequent_indent=INDENT,
            break_long_words=False,
            break_on_hyphens=False,
        )


def _text(default: Any) -> str:
    """Default in the form of a variable; blank for none."""
    if isinstance(default, SecretStr):
        default = default.get_secret_value()
    if isinstance(default, tuple | frozenset):
        return ",".join(sorted(map(str, default)))
    if isinstance(default, Path):
        return "that of the package"
    return "" if default is None else f"{default:.12g}" if isinstance(default, float) else str(default)
