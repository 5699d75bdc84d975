"""`hpn serve`: page and API."""

import argparse
import asyncio
import errno
import socket
from contextlib import suppress

from hpn.catalogue import load_catalogue
from hpn.store import Store, StoreUnavailableError
from hpn.web import serve
from hpn.web.settings import Settings


def run(options: argparse.Namespace) -> int:
    """Serve until a signal ends it; a faulty catalogue or database ends it at the start, with the place of the
    fault."""
    values = {name: getattr(options, name) for name in ("host", "port", "workers")}
    settings = Settings(**{name: value for name, value in values.items() if value is not None})
    load_catalogue(settings.catalogue_folder, settings.catalogue_supplement)
    _require_free(settings.host, settings.port)  # first: while another service runs, its database must stay as it is
    asyncio.run(_migrate(Store(**settings.database())))
    return serve.run(settings)


def _require_free(host: str, port: int) -> None:
    """Raise OSError, with the reason, where the address can't be listened on; the server would only log it."""
    place = f"{host} port {port} (HPN_HOST, HPN_PORT)"
    try:
        for family, kind, protocol, _, address in socket.getaddrinfo(host, port, type=socket.SOCK_STREAM):
            with socket.socket(family, kind, protocol) as probe:
                probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
                if family == socket.AF_INET6:
                    probe.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 1)
                probe.bind(address)
    except OSError as error:
        if error.errno == errno.EADDRINUSE:
            raise OSError(error.errno, "another program listens there; choose another port", place) from None
        raise OSError(error.errno, f"can’t be listened on: {error.strerror}", place) from None


async def _migrate(store: Store) -> None:
    """Upgrade the database before any worker starts, so that a refusal is a text and not a trace."""
    with suppress(StoreUnavailableError):  # the calculator works without a database
        await store.open()
    await store.close()
