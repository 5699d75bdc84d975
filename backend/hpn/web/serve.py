"""Running the service: processes, limits of the server, logs, and an end that lets running requests finish."""

import gc
import os
import tempfile
from typing import Any

import uvicorn
from fastapi import FastAPI
from uvicorn.supervisors import Multiprocess

from hpn.web.app import create_app
from hpn.web.door import logs, metrics
from hpn.web.pages import templates
from hpn.web.settings import Settings

WORKER_ANSWER_SECONDS = 30


def served_app() -> FastAPI:
    """The application in a process of its own, whose logs are all the service's."""
    settings = Settings()
    logs.configure(settings.log_level)
    app = create_app(settings)
    templates.prepare(app.state)
    gc.collect()
    gc.freeze()  # catalogue, templates and modules are never garbage; to search them takes 90 ms each time
    return app


def options(settings: Settings) -> dict[str, Any]:
    """Options of the server."""
    return {
        "factory": True,
        "host": settings.host,
        "port": settings.port,
        "workers": settings.workers,
        "http": "hpn.web.door.protocol:BoundedProtocol",
        "ws": "none",
        "log_config": None,
        "access_log": False,
        "proxy_headers": False,  # who is trusted is a setting, and nobody is by default
        "server_header": False,
        "limit_concurrency": settings.maximum_connections,
        "timeout_graceful_shutdown": settings.shutdown_seconds,
        "timeout_worker_healthcheck": WORKER_ANSWER_SECONDS,
    }


def run(settings: Settings) -> None:
    """Serve until a signal says otherwise."""
    logs.configure(settings.log_level)
    if settings.workers == 1:
        uvicorn.run("hpn.web.serve:served_app", **options(settings))
        return
    with tempfile.TemporaryDirectory(prefix="hpn-metrics-") as folder:
        os.environ[metrics.FOLDER] = folder
        config = uvicorn.Config("hpn.web.serve:served_app", **options(settings))
        Workers(config, sockets=[config.bind_socket()]).run()


class Workers(Multiprocess):
    """uvicorn's workers; at the end new connections are refused at once, as by a single process."""

    def terminate_all(self) -> None:
        """Have the workers finish what runs."""
        for listening in self.sockets:  # else the system would go on accepting, and nobody would answer
            listening.close()
        super().terminate_all()
