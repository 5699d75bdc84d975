"""API keys: each has a name; only its hash is stored, and compared in constant time."""

import base64
import binascii
import hashlib
import hmac
import secrets
from collections.abc import Iterable, Sequence

from hpn.web.settings import KEY_PAIR, ApiKey

KEY_PREFIX = "hpn_"

Headers = Iterable[tuple[bytes, bytes]]


def new_key(name: str) -> tuple[str, str]:
    """New key, and its pair of name and hash for the settings; ValueError for a malformed name."""
    key = KEY_PREFIX + secrets.token_urlsafe(24)
    pair = f"{name}:{hashlib.sha256(key.encode()).hexdigest()}"
    if KEY_PAIR.fullmatch(pair) is None:
        raise ValueError("a key’s name has 1 to 64 letters, digits, dots, dashes or underscores")
    return key, pair


def holder(presented: bytes, keys: Sequence[ApiKey]) -> str | None:
    """Name of the presented key, or None. Takes the same time for every answer."""
    digest, name = hashlib.sha256(presented).digest(), None
    for key in keys:
        if hmac.compare_digest(key.digest, digest):
            name = key.name
    return name


def presented_key(headers: Headers) -> bytes | None:
    """Key of a request: `X-API-Key`, `Authorization: Bearer`, or the password of `Basic`, which browsers ask for."""
    for name, value in headers:
        if name == b"x-api-key":
            return value.strip()
        if name == b"authorization":
            scheme, _, credentials = value.strip().partition(b" ")
            if scheme.lower() == b"bearer":
                return credentials.strip()
            if scheme.lower() == b"basic":
                return _password(credentials.strip())
    return None


def _password(credentials: bytes) -> bytes:
    try:
        return base64.b64decode(credentials, validate=True).partition(b":")[2]
    except binascii.Error:
        return b""
