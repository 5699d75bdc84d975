"""Errors as RFC 9457 problem details: the fault, its place and the correction."""

from collections.abc import Callable, Iterable
from typing import Any

import orjson
from fastapi import Depends, FastAPI
from fastapi.exceptions import RequestValidationError
from pydantic import ValidationError
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Match
from starlette.types import Scope

from hpn.application import InputError
from hpn.application.faults import Fault, Location, faults_of, plain_faults, pointer, unreadable
from hpn.installed import ExtraMissingError, require
from hpn.store import StoreFullError, StoreUnavailableError
from hpn.web.door.kinds import KINDS, OF_STATUS, PATH
from hpn.words.wording import Sentence

MEDIA_TYPE = "application/problem+json"

MAXIMUM_ERRORS = 20
"""Maximum number of errors in an answer."""

STORE_SECONDS = 5
"""Time to wait before a store that is out of reach is tried again."""

TITLES = {status: KINDS[name].title for status, name in OF_STATUS.items()}


class Problem(HTTPException):
    """Refusal with its status, a text for people, and the faulty fields.

    `kind` is a name of KINDS, by default that of the status. An error without a code gets `invalid`. Sentences give the
    text in any language; without them a page shows the English text. `ways` are alternative addresses for a page to
    offer, with their names.
    """

    def __init__(
        self,
        status: int,
        detail: str | Sentence | Iterable[Sentence],
        errors: Iterable[tuple[Location, str] | Fault] = (),
        headers: dict[str, str] | None = None,
        kind: str = "",
        ways: Iterable[tuple[str, str]] = (),
    ) -> None:
        self.sentences = () if isinstance(detail, str) else (detail,) if isinstance(detail, Sentence) else tuple(detail)
        detail = detail if isinstance(detail, str) else "; ".join(sentence.text for sentence in self.sentences)
        self.kind = kind or OF_STATUS.get(status, "")
        self.ways = tuple(ways)
        self.errors = [Fault(*error) for error in errors]
        if len(self.errors) > MAXIMUM_ERRORS:
            detail += f"; {len(self.errors)} errors were found, of which the first {MAXIMUM_ERRORS} are named"
            del self.errors[MAXIMUM_ERRORS:]
        super().__init__(status, detail, headers)

    @classmethod
    def later(cls, detail: str | Sentence, seconds: int, status: int = 503) -> "Problem":
        """Problem for a request that may be repeated after some seconds."""
        return cls(status, detail, headers={"Retry-After": str(seconds)})

    @classmethod
    def of(cls, error: ValidationError | InputError | StoreUnavailableError) -> "Problem":
        """Problem for input that the models or the selection refuse, and for a store that is full or out of reach."""
        if isinstance(error, StoreUnavailableError):
            is_full = isinstance(error, StoreFullError)
            return cls.later(Sentence(str(error)) if is_full else str(error), STORE_SECONDS)
        if isinstance(error, InputError):
            return cls(422, (sentence for _, sentence in error.sentences), faults_of(error))
        if text := unreadable(error):
            return cls(400, f"the body {text}")
        return cls.at(faults_of(error))

    @classmethod
    def at(cls, errors: list[Fault]) -> "Problem":
        """Problem for faults of an input; its text has the first three."""
        detail = "; ".join(": ".join(filter(None, (pointer(at), text))) for at, text, _ in errors[:3])
        return cls(422, detail, errors)

    @classmethod
    def below(cls, error: ValidationError | InputError, *place: str) -> "Problem":
        """Problem for input at a place of the body."""
        whole = cls.of(error)
        faults = [fault._replace(location=(*place, *fault.location)) for fault in whole.errors]
        return cls(422, whole.detail, faults) if isinstance(error, InputError) else cls.at(faults)

    def body(self) -> dict[str, Any]:
        """Problem as a JSON object."""
        body: dict[str, Any] = {
            "type": f"{PATH}{self.kind}" if self.kind else "about:blank",
            "title": KINDS[self.kind].title if self.kind else "Error",
            "status": self.status_code,
            "detail": self.detail,
        }
        if self.errors:
            body["errors"] = [
                {"pointer": pointer(fault.location), "code": fault.code, "detail": fault.text} for fault in self.errors
            ]
        return body

    def response(self) -> Response:
        """Problem as a response."""
        return Response(orjson.dumps(self.body()), self.status_code, self.headers, MEDIA_TYPE)


def needs(extra: str) -> Any:
    """Dependency of routes that need an extra: Problem 501 if it is not installed."""

    async def check() -> None:
        try:
            require(extra)
        except ExtraMissingError as error:
            raise Problem(501, error.sentence) from None

    return Depends(check)


def mistake() -> Problem:
    """Problem 500 for an error of the service itself."""
    return Problem(500, "the service made a mistake; it is in the log")


def _methods_at(app: FastAPI, scope: Scope) -> list[str]:
    """Methods that the path of a request has."""
    tried = [(method, {**scope, "method": method}) for method in ("GET", "POST", "PATCH", "DELETE")]
    methods = [
        method for method, scope in tried if any(route.matches(scope)[0] is Match.FULL for route in app.router.routes)
    ]
    return methods + ["HEAD"] * ("GET" in methods)


def install(app: FastAPI, page_of: Callable[[Request, HTTPException], Response | None]) -> None:
    """Answer every refusal of `app` as a problem; `observation.py` answers unexpected errors.

    `page_of` gives the page for a reader, or None where the problem itself is the answer.
    """

    async def refused(request: Request, error: Exception) -> Response:
        if isinstance(error, ValidationError | InputError | StoreUnavailableError):
            return Problem.of(error).response()
        if isinstance(error, RequestValidationError):
            faults = plain_faults(error.errors())  # each begins with the part of the request
            return Problem.at([fault._replace(location=fault.location[1:]) for fault in faults]).response()
        assert isinstance(error, HTTPException)
        page = page_of(request, error)
        if page is not None:
            return page
        if isinstance(error, Problem):
            return error.response()
        text = {404: f"there is nothing at {request.scope['path']}", 405: f"{request.method} is not possible here"}
        headers = dict(error.headers) if error.headers else None
        if error.status_code == 405:  # several routes may share a path, each with a method of its own
            headers = {"Allow": ", ".join(_methods_at(app, request.scope))}
        return Problem(error.status_code, text.get(error.status_code, error.detail), headers=headers).response()

    for kind in (ValidationError, RequestValidationError, InputError, StoreUnavailableError, HTTPException):
        app.add_exception_handler(kind, refused)
