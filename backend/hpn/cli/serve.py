"""`hpn serve`: page and API."""

import argparse
import asyncio
from contextlib import suppress

from hpn.catalogue import load_catalogue
from hpn.store import Store, StoreUnavailableError
from hpn.web import serve
from hpn.web.settings import Settings


def run(options: argparse.Namespace) -> int:
    """Serve until a signal says otherwise; a wrong catalogue or database stops here, with its place."""
    given = {name: getattr(options, name) for name in ("host", "port", "workers")}
    settings = Settings(**{name: value for name, value in given.items() if value is not None})
    load_catalogue(settings.catalogue_folder, settings.catalogue_supplement)
    asyncio.run(_migrate(Store(settings.database_url.get_secret_value(), seconds=settings.database_seconds)))
    serve.run(settings)
    return 0


async def _migrate(store: Store) -> None:
    """Bring the database up to date before any worker starts, so that a refusal is a text and not a trace."""
    with suppress(StoreUnavailableError):  # the calculator works without
        await store.open()
    await store.close()
