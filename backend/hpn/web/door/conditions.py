"""Request headers that make a request conditional, repeatable or brief (RFC 9110, RFC 7240, Idempotency-Key)."""

import hashlib
import re

from starlette.requests import Request
from starlette.responses import Response

from hpn.web.door.problems import Problem

IDEMPOTENCY_KEY = re.compile(r'"?([\x21\x23-\x7e]{1,200})"?')
"""Key of visible ASCII, with or without the quotes of a structured field."""

REPLAYED = "Idempotency-Replayed"
"""Header that marks the repeated reply to an earlier request with the same key."""

REPRESENTATION = re.compile(r"(?:^|[,;\s])return\s*=\s*\"?representation\b", re.I)


def etag_of(body: bytes) -> str:
    """Strong entity tag of a body."""
    return f'"{hashlib.sha256(body).hexdigest()[:32]}"'


def conditional(request: Request, body: bytes, etag: str = "") -> Response:
    """Response of JSON with its entity tag, or 304 if the client has this state; caches must revalidate it."""
    etag = etag or etag_of(body)
    headers = {"ETag": etag, "Cache-Control": "no-cache"}
    if has_already(request, etag):
        return Response(status_code=304, headers=headers)
    return Response(body, headers=headers, media_type="application/json")


def has_already(request: Request, etag: str) -> bool:
    """True if the client has this state already (`If-None-Match`)."""
    return _lists(request.headers.get("if-none-match", ""), etag, weakly=True)


def require_match(request: Request, etag: str) -> None:
    """Raise Problem 412 if `If-Match` names another state."""
    tags = request.headers.get("if-match")
    if tags is not None and not _lists(tags, etag, weakly=False):
        raise other_state()


def other_state() -> Problem:
    """Problem 412 for an `If-Match` that names another state than the current one."""
    return Problem(412, "If-Match names an earlier or other state; read this address again")


def require_done(is_done: bool, version: int | None, missing: Problem, overtaken: Problem | None = None) -> None:
    """Raise the reason of a write that failed: `gone` if any version was acceptable, else `overtaken` or 412."""
    if not is_done:
        raise missing if version is None else overtaken or other_state()


def _lists(header: str, etag: str, *, weakly: bool) -> bool:
    tags = re.findall(r'(?:W/)?"[^"]*"|\*', header)
    return "*" in tags or etag in tags or (weakly and f"W/{etag}" in tags)


def idempotency_key(request: Request) -> str | None:
    """Key that identifies a caller's repeated request, or None; Problem 400 for a malformed key."""
    key = request.headers.get("idempotency-key")
    if key is None:
        return None
    match = IDEMPOTENCY_KEY.fullmatch(key.strip())
    if match is None:
        raise Problem(400, "Idempotency-Key must be 1 to 200 visible ASCII characters, such as a UUID")
    name, caller = request.state.api_key, request.state.caller
    # An address is only stored hashed; the blank distinguishes it from the names of keys.
    return f"{name}:{match[1]}" if name else f"address {hashlib.sha256(f'{caller} {match[1]}'.encode()).hexdigest()}"


def prefers_representation(request: Request) -> bool:
    """True for `Prefer: return=representation`; any other preference is ignored, as RFC 7240 permits."""
    return REPRESENTATION.search(request.headers.get("prefer", "")) is not None
