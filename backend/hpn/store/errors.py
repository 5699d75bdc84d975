"""Errors of the store."""

from hpn.words.wording import N_, MendableError

FULL = N_(
    "The disk of the database (HPN_DATABASE_URL) is full: make some megabytes of room on it, then try again. "
    "Deleting may need room, too."
)


class StoreError(MendableError):
    """Base of the store's errors; its text is for people."""


class StoreUnavailableError(StoreError):
    """The database can't be reached, is too slow, or refuses for now; the same call may work later."""


class StoreFullError(StoreUnavailableError):
    """The disk of the database is full; SQLite needs room for a deletion, too: it enters the log before room is
    freed."""

    def __init__(self) -> None:
        super().__init__(FULL)


class NewerDatabaseError(StoreError):
    """A newer version of this program has changed the database; this version does not know the change."""


class ShareSpentError(StoreError):
    """A caller has reached the limit of unsaved machines."""


class NoRoomError(StoreError):
    """All unsaved machines together have reached the limit of room."""


class KeySpentError(StoreError):
    """The selection saved under this idempotency key has been deleted since."""


class KeyReusedError(StoreError):
    """An idempotency key comes a second time, with other content."""


class LabelTakenError(StoreError):
    """The document already has a revision with this label."""


class NameTakenError(StoreError):
    """The owner already has a list of motors with this name."""


class ListsSpentError(StoreError):
    """The owner has reached the limit of lists of motors."""


class ExcessError(StoreError):
    """A document would exceed a limit: of `axes`, `phases` or `revisions`."""

    def __init__(self, what: str, most: int) -> None:
        self.what, self.most = what, most
        super().__init__(f"a document may have {most} {what} at most")
