"""Reader of the request under way, and address of their page."""

from contextvars import ContextVar
from typing import NamedTuple

from starlette.requests import Request

from hpn.words.reader import DEFAULT, Reader


class Visit(NamedTuple):
    """Reader, and path and query of their page."""

    reader: Reader = DEFAULT
    address: str = "/"


NOBODY = Visit()

# Set per request: templates find it without each route passing it on.
VISIT: ContextVar[Visit] = ContextVar("visit", default=NOBODY)


def absolute(request: Request, path: str) -> str:
    """Absolute address of a path of this service."""
    return str(request.base_url).rstrip("/") + path


def current() -> Reader:
    """Reader of the request under way."""
    return VISIT.get().reader


def address() -> str:
    """Path and query of the request under way; after a posted form that of its page, or `/`."""
    return VISIT.get().address
