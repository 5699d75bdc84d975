"""Errors of input in the form that Python expects."""

from collections.abc import Iterator
from contextlib import contextmanager

from pydantic import ValidationError

from hpn.application.faults import InputError, faults_of, lines_of, pointer
from hpn.words.wording import MendableError, shortened

MOST_LINES = 20
"""Most faults in the text; `faults` has all of them."""


class ApplicationError(ValueError):
    """Error of an unusable application or table; the text names each fault with the accepted form.

    `faults` are (JSON pointer, sentence, code), as in the problems of REST.
    """

    def __init__(self, text: str, faults: tuple[tuple[str, str, str], ...] = ()) -> None:
        self.faults = faults
        super().__init__(text)


@contextmanager
def with_application_errors() -> Iterator[None]:
    """Raise ApplicationError in place of the errors of models, selection and tables."""
    try:
        yield
    except (ValidationError, InputError) as error:
        faults = tuple((pointer(location) or "/", text, code) for location, text, code in faults_of(error))
        raise ApplicationError("\n".join(shortened(lines_of(error), MOST_LINES)), faults) from None
    except MendableError as error:
        raise ApplicationError(str(error)) from None
