"""Queries of the API's routes: only parameters that the route declares, each once except lists."""

from collections import Counter
from typing import get_origin

from fastapi.dependencies.utils import get_flat_params
from starlette.requests import Request

from hpn.application.faults import Fault
from hpn.web.door.problems import Problem

MOST_PARAMETERS = 100
MOST_NAMED = 60
"""Characters of an unknown name that an error quotes."""


def require_declared(request: Request) -> None:
    """Raise Problem 422 for a parameter that the matched route does not declare, or that is repeated and not a list.

    Raises Problem 414 for so many parameters that an error for each would take long.
    """
    query: bytes = request.scope["query_string"]
    if query.count(b"&") > MOST_PARAMETERS:
        raise Problem(414, f"the address may have {MOST_PARAMETERS} parameters at most")
    if not query:
        return
    declared = {field.alias: field for field in get_flat_params(request.scope["route"].dependant)}
    known = [name for name in declared if name not in request.path_params]
    lists = {name for name in known if get_origin(declared[name].field_info.annotation) is list}
    right = f"there are {', '.join(known)}" if known else "it takes none"
    counts = Counter(name for name, _ in request.query_params.multi_items())
    unknown = [
        Fault((name[:MOST_NAMED],), f"is no parameter of this address; {right}", "unknown")
        for name in counts
        if name not in known
    ]
    repeated = [name for name in known if counts[name] > 1 and name not in lists]
    twice = [Fault((name,), "must be given once", "repeated") for name in repeated]
    if unknown or twice:
        raise Problem.at(unknown + twice)
