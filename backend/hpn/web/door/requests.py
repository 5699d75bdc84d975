"""Proof that a form must bring before it changes anything."""

from starlette.requests import Request

from hpn.web.door.problems import Problem
from hpn.words.wording import N_


def require_same_origin(request: Request, *permitted: str) -> None:
    """Raise Problem 403 for a form that a page of another site has sent, unless its origin is permitted, or any by `*`.

    Programs send neither header.
    """
    site = request.headers.get("sec-fetch-site")
    origin = request.headers.get("origin")
    if site is not None:
        same = site in ("same-origin", "none")
    else:
        same = origin is None or origin.partition("://")[2] == request.headers.get("host")
    if not same and origin not in permitted and "*" not in permitted:
        raise Problem(403, N_("this form was sent by a page of another site"))
