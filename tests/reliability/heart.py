"""The service with a heartbeat on its event loop: `python -m tests.reliability.heart --port PORT`.

`GET /held` answers for how long the loop was held since it was last asked, in seconds.
"""

import argparse
import asyncio
import json
import time

import uvicorn
from starlette.types import ASGIApp, Receive, Scope, Send

from hpn.web.serve import options, served_app
from hpn.web.settings import Settings

BEAT_S = 0.005


class Heart:
    """Beats while the service runs, and remembers its longest pause.

    Counted is time in which the process computed: in the rest of a pause the machine did something else.
    """

    def __init__(self, app: ASGIApp) -> None:
        self.app = app
        self._held = 0.0
        self._last = (0.0, 0.0)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Start to beat, tell what was seen, or pass a request on."""
        if scope["type"] == "lifespan":
            self._last = (time.perf_counter(), time.process_time())
            self._beat()
        elif scope["path"] == "/held":
            body, self._held = json.dumps(self._held).encode(), 0.0
            await send({"type": "http.response.start", "status": 200, "headers": []})
            await send({"type": "http.response.body", "body": body})
            return
        await self.app(scope, receive, send)

    def _beat(self) -> None:
        now = (time.perf_counter(), time.process_time())
        passed = min(now[0] - self._last[0], now[1] - self._last[1])
        self._held, self._last = max(self._held, passed), now
        asyncio.get_running_loop().call_later(BEAT_S, self._beat)


def app() -> ASGIApp:
    """The service as it is served, with its heart."""
    return Heart(served_app())


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--port", type=int)
    settings = Settings(port=parser.parse_args().port)
    uvicorn.run("tests.reliability.heart:app", **options(settings))
