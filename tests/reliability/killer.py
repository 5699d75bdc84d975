"""Serves with worker processes, and kills them at random moments: `python -m tests.reliability.killer FD KILLS SEED`.

The application is built once, and each worker is a fork of it, so that a new one serves at once and hundreds can be
killed in a minute. Writes a line when all the killing is done and serves on; ends when its standard input closes.
"""

import os
import random
import select
import signal
import socket
import sys
import time
from dataclasses import dataclass

import uvicorn
from fastapi import FastAPI

from hpn.web.app import create_app

WORKERS = 2
LONGEST_LIFE_S = 0.2
"""Of a worker that serves; the odd one does not live to that."""

KILLED_AT_START = 0.2
"""Part of the workers that are not given the time to start."""


class Server(uvicorn.Server):
    """A server that says when it serves."""

    def __init__(self, app: FastAPI, serves: int) -> None:
        super().__init__(uvicorn.Config(app, log_level="error", timeout_graceful_shutdown=2))
        self._serves = serves

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Start, and say so."""
        await super().startup(sockets)
        os.write(self._serves, b"1")


@dataclass(frozen=True)
class Worker:
    """A process that serves, and the pipe on which it says so."""

    process: int
    serves: int

    def end(self, number: int) -> None:
        """Send a signal, and take leave."""
        os.kill(self.process, number)
        _, status = os.waitpid(self.process, 0)
        os.close(self.serves)
        if number == signal.SIGKILL and not os.WIFSIGNALED(status):
            raise RuntimeError(f"a worker had ended by itself, with status {status}")


def main(descriptor: int, kills: int, seed: int) -> None:
    """Serve on a listening socket; kill and replace workers, then serve on until standard input closes."""
    listener = socket.socket(fileno=descriptor)
    chance = random.Random(seed)
    app = create_app()  # connects to nothing before it serves
    workers = [_fork(app, listener) for _ in range(WORKERS)]
    try:
        for _ in range(kills):
            victim = chance.randrange(WORKERS)
            if chance.random() > KILLED_AT_START:
                select.select([workers[victim].serves], [], [], 20)
            time.sleep(chance.uniform(0, LONGEST_LIFE_S))
            if _input_closed(0):
                return
            workers[victim].end(signal.SIGKILL)
            workers[victim] = _fork(app, listener)
        print("done", flush=True)
        while not _input_closed(1.0):
            pass
    finally:
        for worker in workers:
            worker.end(signal.SIGTERM)


def _fork(app: FastAPI, listener: socket.socket) -> Worker:
    reading, writing = os.pipe()
    process = os.fork()
    if process:
        os.close(writing)
        return Worker(process, reading)
    try:
        os.close(0)
        Server(app, writing).run(sockets=[listener])
    finally:
        os._exit(1)


def _input_closed(wait_s: float) -> bool:
    """True where standard input closes within this time."""
    return bool(select.select([sys.stdin], [], [], wait_s)[0])


if __name__ == "__main__":
    main(*(int(argument) for argument in sys.argv[1:]))
