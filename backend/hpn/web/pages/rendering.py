"""Pages rendered from templates, and the page with the reason if a route has nothing to show."""

from collections.abc import Awaitable, Callable
from functools import wraps
from typing import Any

from starlette.requests import Request
from starlette.responses import HTMLResponse, Response

from hpn.store import StoreUnavailableError
from hpn.web.door.problems import Problem
from hpn.web.pages.templates import environment

Route = Callable[[Request], Awaitable[Response]]


def page(request: Request, template: str, status: int = 200, **values: Any) -> Response:
    """Rendered page, which caches must revalidate."""
    content = environment(request.app.state).get_template(template)
    rendered = content.render(catalogue=request.app.state.catalogue, status=status, **values)
    return HTMLResponse(rendered, status, {"Cache-Control": "no-cache"})


def reason(request: Request, template: str, error: Problem | StoreUnavailableError, **values: Any) -> Response:
    """Page with the reason for a refusal, with its status and headers."""
    problem = error if isinstance(error, Problem) else Problem.of(error)
    response = page(request, template, problem.status_code, problem=problem, **values)
    response.headers.update(problem.headers or {})
    return response


def or_reason(template: str) -> Callable[[Route], Route]:
    """Decorator of a route: answers with the page of the reason if it raises Problem or StoreUnavailableError."""

    def guarded(route: Route) -> Route:
        @wraps(route)
        async def answer(request: Request) -> Response:
            try:
                return await route(request)
            except (Problem, StoreUnavailableError) as error:
                return reason(request, template, error)

        return answer

    return guarded
