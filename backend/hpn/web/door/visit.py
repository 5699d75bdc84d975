"""The request under way: its reader, and the address of the page that they look at."""

from contextvars import ContextVar
from typing import NamedTuple

from starlette.requests import Request

from hpn.words.reader import DEFAULT, Reader


class Visit(NamedTuple):
    """A reader, and the path and query of the page that they look at."""

    reader: Reader = DEFAULT
    address: str = "/"


NOBODY = Visit()

# Per request, not per process: templates of every page find it without each route handing it on.
VISIT: ContextVar[Visit] = ContextVar("visit", default=NOBODY)


def absolute(request: Request, path: str) -> str:
    """Address of this service with a path."""
    return str(request.base_url).rstrip("/") + path


def current() -> Reader:
    """Reader of the request under way."""
    return VISIT.get().reader


def address() -> str:
    """Path and query of the request under way, or of the form's page where it was posted."""
    return VISIT.get().address
