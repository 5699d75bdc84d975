"""Running the service: processes, limits of the server, logs, and an end that lets running requests finish."""

import asyncio
import gc
import logging
import os
import sys
import tempfile
import threading
import time
import traceback
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import Any

import uvicorn
from fastapi import FastAPI
from uvicorn.config import STARTUP_FAILURE
from uvicorn.supervisors import Multiprocess

from hpn import ENGINE_VERSION
from hpn.catalogue import CatalogueError
from hpn.store import StoreError
from hpn.web.app import create_app
from hpn.web.door import logs, metrics
from hpn.web.door.hosts import is_loopback
from hpn.web.door.upgrades import Protocol
from hpn.web.pages import templates
from hpn.web.settings import GONE, Settings

logger = logging.getLogger(__name__)
RETRY_SECONDS = 2
"""Time after which a worker that could not start is tried again."""

WORKER_BYTES = 768 << 20
LIMITS = (Path("/sys/fs/cgroup/memory.max"), Path("/sys/fs/cgroup/memory/memory.limit_in_bytes"))
"""Files with the limit of this container: of the second version of control groups, and of the first."""


def served_app() -> FastAPI:
    """The application in a process of its own, whose logs are all the service's."""
    settings = Settings()
    logs.configure(settings.log_level)
    app = create_app(settings)
    versions = {"engine_version": ENGINE_VERSION, "catalogue_version": app.state.catalogue.version}
    logs.make_logger(settings.log_level).info("start", **versions)
    templates.prepare(templates.environment(app.state))
    gc.collect()
    gc.freeze()  # catalogue, templates and modules are never garbage; to search them takes 90 ms each time
    return app


def worker_app() -> FastAPI:
    """Application for one of several worker processes; the others go on when it ends.

    An error that keeps a new one from starting, such as a catalogue damaged since, is a line of the log.
    """
    try:
        app = served_app()
    except (CatalogueError, StoreError, OSError) as error:
        logger.error("a worker can’t start, and is tried again: %s", error)
        time.sleep(RETRY_SECONDS)
        sys.exit(1)
    _end_when_stuck(app.state.settings.worker_seconds)
    return app


def _end_when_stuck(seconds: float) -> None:
    """End this process, saying where it stands, once its event loop has not turned for so long.

    The parent can't tell: a thread of its own answers it.
    """
    loop, main, turned = asyncio.get_running_loop(), threading.get_ident(), threading.Event()

    def watch() -> None:
        while not loop.is_closed():
            turned.clear()
            with suppress(RuntimeError):  # closed a moment ago
                loop.call_soon_threadsafe(turned.set)
            if not turned.wait(seconds) and not loop.is_closed():
                stack = "".join(traceback.format_stack(sys._current_frames()[main]))
                logger.error(
                    "the event loop has stood still for %s s, so this worker ends; it was at\n%s", seconds, stack
                )
                os._exit(1)
            time.sleep(1)

    threading.Thread(target=watch, daemon=True).start()


def options(settings: Settings) -> dict[str, Any]:
    """Options of the server."""
    return {
        "factory": True,
        "host": settings.host,
        "port": settings.port,
        "workers": settings.workers,
        "http": Protocol,
        "ws": "none",
        "log_config": None,
        "access_log": False,
        "proxy_headers": False,  # who is trusted is a setting, and nobody is by default
        "server_header": False,
        "timeout_graceful_shutdown": settings.shutdown_seconds,
        "timeout_worker_healthcheck": settings.worker_seconds,
    }


def _say_what_is_missed(settings: Settings) -> None:
    """Log in a line each which variables do nothing any more, and that a proxy belongs before what others reach."""
    for name in sorted(os.environ):
        if (instead := GONE.get(name.upper())) and os.environ[name]:
            logger.warning("%s is no setting any more and does nothing; nginx has %s in its place", name, instead)
    if not is_loopback(settings.host) and not settings.trusted_proxies:
        logger.warning(
            "the service listens on %s, and HPN_TRUSTED_PROXIES names no proxy: one belongs before what others reach "
            "(docs/deployment.md)",
            settings.host,
        )


def run(settings: Settings) -> int:
    """Serve until a signal says otherwise; 1 where the workers could not start."""
    logs.configure(settings.log_level)
    if short := shortage(settings.workers, settings.fleet_processes * settings.fleet_memory_bytes):
        logger.warning(short)
    _say_what_is_missed(settings)
    if settings.workers == 1:
        uvicorn.run("hpn.web.serve:served_app", **options(settings))
        return 0
    with tempfile.TemporaryDirectory(prefix="hpn-metrics-") as folder:
        os.environ[metrics.FOLDER] = folder
        config = uvicorn.Config("hpn.web.serve:worker_app", **options(settings))
        workers = Workers(config, sockets=[config.bind_socket()])
        workers.run()
        return int(any(process.exitcode == STARTUP_FAILURE for process in workers.processes))


class Workers(Multiprocess):
    """uvicorn's workers; at the end new connections are refused at once, as by a single process."""

    def terminate_all(self) -> None:
        """Have the workers finish what runs."""
        for listening in self.sockets:  # else the system would go on accepting, and nobody would answer
            listening.close()
        super().terminate_all()


def shortage(workers: int, beside_bytes: int, limits: Iterable[Path] = LIMITS) -> str | None:
    """Sentence for workers, each with so much beside it, that may take more than there is; None where it is enough."""
    needed, limit = workers * (WORKER_BYTES + beside_bytes), _limit(limits)
    if limit is None or needed <= limit:
        return None
    return (
        f"HPN_WORKERS is {workers}, which with fleets may take {needed / 1e9:.1f} GB, and this container has "
        f"{limit / 1e9:.1f} GB: give it more (WEB_MEMORY under compose), or fewer workers"
    )


def _limit(limits: Iterable[Path]) -> int | None:
    """Smallest limit in bytes, None where there is none."""
    texts = [file.read_text().strip() for file in limits if file.is_file()]
    return min((int(text) for text in texts if text.isdigit()), default=None)
