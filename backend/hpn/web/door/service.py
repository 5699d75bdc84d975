"""The application object: FastAPI, behind what every request passes, with shortcuts past it for the busiest routes."""

from collections.abc import Awaitable, Callable, Mapping, Sequence
from typing import Any

from fastapi import FastAPI
from pydantic import BaseModel
from starlette.requests import Request
from starlette.responses import Response
from starlette.types import ASGIApp, Receive, Scope, Send

from hpn.web.api import openapi

Endpoint = Callable[[Request], Awaitable[Response]]


class Service(FastAPI):
    """FastAPI documents every route and runs most. Its layers and Starlette's cost as much as a selection.

    So `shortcuts`, by method and exact path, run behind `front` alone, and are refused by the same handlers.
    """

    front: ASGIApp
    shortcuts: Mapping[tuple[str, str], Endpoint]
    bodies: Sequence[type[BaseModel]]
    """Models of request bodies that routes read themselves, for the document."""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Run the application."""
        await self.front(scope, receive, send)

    def openapi(self) -> dict[str, Any]:
        """The OpenAPI document, with the bodies that FastAPI does not see."""
        return openapi.complete(super().openapi(), self.state.catalogue, self.state.settings, *self.bodies)

    async def routed(self, scope: Scope, receive: Receive, send: Send) -> None:
        """What lies behind the front: a shortcut where there is one, FastAPI otherwise."""
        endpoint = self.shortcuts.get((scope["method"], scope["path"])) if scope["type"] == "http" else None
        if endpoint is None:
            await super().__call__(scope, receive, send)
            return
        scope["app"], scope["endpoint"] = self, endpoint
        request = Request(scope, receive)
        try:
            response = await endpoint(request)
        except Exception as error:
            response = await self._refused(request, error)
        await response(scope, receive, send)

    async def _refused(self, request: Request, error: Exception) -> Response:
        for kind in type(error).__mro__:
            handler: Any = self.exception_handlers.get(kind)
            if handler is not None and kind is not Exception:  # what is a mistake of ours is not to be hidden
                response: Response = await handler(request, error)
                return response
        raise error
