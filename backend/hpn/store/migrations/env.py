"""Environment that Alembic runs: migrates over the connection, and inside the transaction, that `upgrade.py` has
opened."""

from alembic import context

from hpn.store.tables import metadata

context.configure(connection=context.config.attributes["connection"], target_metadata=metadata)
context.run_migrations()
