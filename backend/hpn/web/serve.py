"""Running of the service: processes, limits of the server, logs, and a shutdown that lets running requests finish."""

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
"""Time after which a worker that could not start is restarted."""

WORKER_BYTES = 768 << 20
LIMITS = (Path("/sys/fs/cgroup/memory.max"), Path("/sys/fs/cgroup/memory/memory.limit_in_bytes"))
"""Files with the memory limit of this container: in version 2 of control groups, and in version 1."""


def served_app() -> FastAPI:
    """Application for a process of its own; all logs of the process are the service's."""
    settings = Settings()
    logs.configure(settings.log_level)
    app = create_app(settings)
    versions = {"engine_version": ENGINE_VERSION, "catalogue_version": app.state.catalogue.version}
    logs.make_logger(settings.log_level).info("start", **versions)
    templates.prepare(templates.environment(app.state))
    gc.collect()
    gc.freeze()  # catalogue, templates and modules are never garbage; each search of them takes 90 ms
    return app


def worker_app() -> FastAPI:
    """Application for one of several worker processes; the others continue when it ends.

    An error that prevents a new worker's start, such as a catalogue damaged meanwhile, is logged in one line.
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
    """End this process, and log its stack, once its event loop has stood still for `seconds`.

    The parent can't detect this: a separate thread answers it.
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
        "proxy_headers": False,  # trusted proxies are a setting, by default none
        "server_header": False,
        "timeout_graceful_shutdown": settings.shutdown_seconds,
        "timeout_worker_healthcheck": settings.worker_seconds,
    }


def _say_what_is_missed(settings: Settings) -> None:
    """Warn of each variable that has no effect any more, and of an address that others reach without a proxy."""
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
    """Serve until a signal; exit code, 1 if the workers could not start."""
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
    """uvicorn's workers; at shutdown new connections are refused at once, as by a single process."""

    def terminate_all(self) -> None:
        """Stop listening, and let the workers finish running requests."""
        for listening in self.sockets:  # otherwise the system would accept connections that nobody answers
            listening.close()
        super().terminate_all()


def shortage(workers: int, beside_bytes: int, limits: Iterable[Path] = LIMITS) -> str | None:
    """Warning if workers, each with `beside_bytes` for fleets, may exceed the memory limit; None if they fit."""
    needed, limit = workers * (WORKER_BYTES + beside_bytes), _limit(limits)
    if limit is None or needed <= limit:
        return None
    return (
        f"HPN_WORKERS is {workers}, which with fleets may take {needed / 1e9:.1f} GB, and this container has "
        f"{limit / 1e9:.1f} GB: give it more (WEB_MEMORY under compose), or fewer workers"
    )


def _limit(limits: Iterable[Path]) -> int | None:
    """Smallest limit in bytes, None without a limit."""
    texts = [file.read_text().strip() for file in limits if file.is_file()]
    return min((int(text) for text in texts if text.isdigit()), default=None)
