"""`hpn database`: upgrades a database, and checks that the service can save in it."""

import argparse
import asyncio

from hpn.store import Store
from hpn.web.settings import Settings


def run(options: argparse.Namespace) -> int:
    """Upgrade the database of the settings; raises StoreError, with the reason, where the service could not use it."""
    asyncio.run(_prepare(Store(**Settings().database())))
    print("the database is up to date, and selections can be saved in it")
    return 0


async def _prepare(store: Store) -> None:
    try:
        await store.open()
        await store.require_complete()
        await store.check()
    finally:
        await store.close()
