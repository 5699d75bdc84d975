"""Pages made of templates, and the page with the reason where a route has nothing to show."""

from collections.abc import Awaitable, Callable
from functools import wraps
from typing import Any

from starlette.requests import Request
from starlette.responses import HTMLResponse, Response

from hpn.store import StoreUnavailableError
from hpn.web.door.problems import Problem
from hpn.web.pages.templates import environment

Route = Callable[[Request], Awaitable[Response]]


def page(request: Request, template: str, status: int = 200, **shown: Any) -> Response:
    """A page, to be asked for anew each time."""
    content = environment(request.app.state).get_template(template)
    rendered = content.render(catalogue=request.app.state.catalogue, status=status, **shown)
    return HTMLResponse(rendered, status, {"Cache-Control": "no-cache"})


def reason(request: Request, template: str, error: Problem | StoreUnavailableError, **shown: Any) -> Response:
    """The page with the reason for a refusal, under its status."""
    problem = error if isinstance(error, Problem) else Problem.of(error)
    response = page(request, template, problem.status_code, problem=problem, **shown)
    response.headers.update(problem.headers or {})
    return response


def or_reason(template: str) -> Callable[[Route], Route]:
    """Have a route answer with the page of the reason where it raises Problem or the store is out of reach."""

    def guarded(route: Route) -> Route:
        @wraps(route)
        async def answer(request: Request) -> Response:
            try:
                return await route(request)
            except (Problem, StoreUnavailableError) as error:
                return reason(request, template, error)

        return answer

    return guarded
