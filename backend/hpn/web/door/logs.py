"""Structured logs: one JSON object per line, with the request's id and without the request's content."""

import logging
import re
import secrets
import sys
from contextvars import ContextVar
from typing import Any

import orjson
import structlog
from starlette.datastructures import Headers
from structlog.typing import EventDict, FilteringBoundLogger

LEVELS = {"debug": logging.DEBUG, "info": logging.INFO, "warning": logging.WARNING, "error": logging.ERROR}
QUIET = ("alembic", "aiosqlite", "sqlalchemy", "psycopg")
"""Libraries that log SQL with its parameters, or too much; only their warnings are kept."""
MUTE = ("mcp",)
"""Libraries whose lines quote requests; their errors are raised, and logged by the service."""
REQUEST_ID = re.compile("[A-Za-z0-9._-]{1,64}")

REQUEST: ContextVar[str | None] = ContextVar("request", default=None)
"""Id of the request under way."""


def _add_request_id(logger: Any, method: str, event: EventDict) -> EventDict:
    if id := REQUEST.get():
        event["request_id"] = id
    return event


SHARED: list[Any] = [
    _add_request_id,
    structlog.processors.add_log_level,
    structlog.processors.TimeStamper(fmt="iso", utc=True),
    structlog.processors.format_exc_info,
]


class Lines:
    """Writes whole lines to the current standard output."""

    def msg(self, line: bytes) -> None:
        """Write one line."""
        sys.stdout.buffer.write(line + b"\n")
        sys.stdout.buffer.flush()

    debug = info = warning = error = critical = exception = msg


def make_logger(level: str) -> FilteringBoundLogger:
    """Logger of the service itself."""
    logger: FilteringBoundLogger = structlog.wrap_logger(
        Lines(),
        processors=[*SHARED, _json],
        wrapper_class=structlog.make_filtering_bound_logger(LEVELS[level]),
    ).bind()
    return logger


def configure(level: str) -> None:
    """Have libraries (server, database, store) log in the same format. Called once in a process that serves."""
    handler = logging.StreamHandler(sys.stdout)
    handler.setFormatter(
        structlog.stdlib.ProcessorFormatter(
            foreign_pre_chain=[*SHARED[:3], structlog.stdlib.add_logger_name],
            processors=[
                structlog.stdlib.ProcessorFormatter.remove_processors_meta,
                structlog.processors.format_exc_info,
                lambda *arguments: _json(*arguments).decode(),
            ],
        )
    )
    root = logging.getLogger()
    root.handlers[:] = [handler]
    root.setLevel(LEVELS[level])
    for name in QUIET:
        logging.getLogger(name).setLevel(logging.WARNING)
    for name in MUTE:
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)


def _json(logger: Any, method: str, event: EventDict) -> bytes:
    return orjson.dumps(event, default=str)


def request_id(headers: Headers) -> str:
    """Id that the caller sent if well-formed, else a random one."""
    id = headers.get("x-request-id", "")
    return id if REQUEST_ID.fullmatch(id) else secrets.token_hex(16)
