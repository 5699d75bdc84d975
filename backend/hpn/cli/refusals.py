"""Errors that are the caller's, in lines that name the place."""

import argparse

from pydantic import ValidationError

from hpn.application import InputError
from hpn.catalogue import CatalogueError
from hpn.store import StoreError
from hpn.web.door.problems import Problem, plain_message
from hpn.web.settings import Settings


def lines_of(error: Exception, options: argparse.Namespace) -> list[str] | None:
    """Lines for an error of input, settings, files or database; None for a mistake of the program."""
    if isinstance(error, CatalogueError | StoreError | OSError):
        return [str(error)]
    if isinstance(error, ValidationError) and error.title == Settings.__name__:
        return _wrong_settings(error, options)
    if isinstance(error, ValidationError | InputError):
        problem = Problem.of(error)
        lines = [f"{entry['pointer'] or '/'}: {entry['detail']}" for entry in problem.body().get("errors", ())]
        return lines or [str(problem.detail)]
    return None


def _wrong_settings(error: ValidationError, options: argparse.Namespace) -> list[str]:
    """A line for each wrong setting, named as it was given: by option or by variable."""
    lines = []
    for entry in error.errors(include_url=False, include_context=False, include_input=False):
        text = plain_message(entry["type"], entry["msg"])
        for name in map(str, entry["loc"][:1]):
            given = f"--{name}" if getattr(options, name, None) is not None else f"HPN_{name.upper()}"
            text = f"{given}: {text}"
        lines.append(text)
    return list(dict.fromkeys(lines))
