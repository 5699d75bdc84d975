"""Errors as lines with the place and the accepted form; the exit code tells whose fault it is."""

import argparse

from pydantic import ValidationError
from pydantic_settings import SettingsError

from hpn.application import InputError
from hpn.application.faults import lines_of, sentence_of, unreadable
from hpn.cli.system import CALLERS, others
from hpn.installed import ExtraMissingError
from hpn.web.settings import Settings, source_of
from hpn.words.wording import MendableError, shortened

MOST_LINES = 20


def words_of(error: Exception, options: argparse.Namespace) -> tuple[int, list[str] | None]:
    """Exit code and lines for an error of input, settings, catalogue or database; no lines for the program's own
    fault."""
    if isinstance(error, ExtraMissingError):
        return CALLERS, [f"hpn {options.command}: {error}"]
    if isinstance(error, MendableError):
        return CALLERS, [str(error)]
    if isinstance(error, SettingsError):
        return CALLERS, [str(error.__cause__ or error)]
    if isinstance(error, MemoryError):
        return others(options), ["hpn can’t go on: this takes more memory than there is"]
    if isinstance(error, ValidationError) and error.title == Settings.__name__:
        return CALLERS, _wrong_settings(error, options)
    if isinstance(error, ValidationError | InputError):
        return CALLERS, _wrong_input(error, options)
    return others(options), None


def _wrong_input(error: ValidationError | InputError, options: argparse.Namespace) -> list[str]:
    """Line for each field, named by its pointer; for invalid JSON one line with the file's name."""
    if isinstance(error, ValidationError) and (text := unreadable(error)):
        file = "standard input" if options.file == "-" else options.file
        return [f"{file}: {text}; an application is a JSON object, such as README.md shows"]
    return shortened(lines_of(error), MOST_LINES)


def _wrong_settings(error: ValidationError, options: argparse.Namespace) -> list[str]:
    """Line for each wrong setting, named as it was given: by option, variable or file."""
    lines = []
    for entry in error.errors(include_url=False, include_context=False, include_input=False):
        text = sentence_of(entry).text
        for name in map(str, entry["loc"][:1]):
            source = f"--{name}" if getattr(options, name, None) is not None else source_of(name)
            text = f"{source}: {text}"
        lines.append(text)
    return list(dict.fromkeys(lines))
