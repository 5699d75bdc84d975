"""Inputs that can't be used, as an error that Python expects."""

from collections.abc import Iterator
from contextlib import contextmanager

from pydantic import ValidationError

from hpn.application.faults import InputError, faults_of, pointer
from hpn.words.wording import MendableError

MOST_LINES = 20
"""Faults that the text lists; `faults` has all of them."""


class ApplicationError(ValueError):
    """An application or table that can't be used; the text names each fault and says what would be right.

    `faults` are (JSON pointer, sentence, code), as in the problems of REST.
    """

    def __init__(self, text: str, faults: tuple[tuple[str, str, str], ...] = ()) -> None:
        self.faults = faults
        super().__init__(text)


@contextmanager
def told() -> Iterator[None]:
    """Raise ApplicationError in place of the errors of models, selection and tables."""
    try:
        yield
    except (ValidationError, InputError) as error:
        faults = tuple((pointer(location) or "/", text, code) for location, text, code in faults_of(error))
        lines = [f"{place}: {text}" for place, text, _ in faults[:MOST_LINES]]
        more = [f"and {len(faults) - MOST_LINES} more"] if len(faults) > MOST_LINES else []
        raise ApplicationError("\n".join([*lines, *more]), faults) from None
    except MendableError as error:
        raise ApplicationError(str(error)) from None
