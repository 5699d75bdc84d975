"""Errors of the store."""

from hpn.words.wording import N_, MendableError

FULL = N_(
    "The disk of the database (HPN_DATABASE_URL) is full: make some megabytes of room on it, then try again. "
    "Deleting may need room, too."
)


class StoreError(MendableError):
    """Base of the store's errors; its text is for people."""


class StoreUnavailableError(StoreError):
    """The database can't be reached, is too slow, or is refused for now; the same call may work later."""


class StoreFullError(StoreUnavailableError):
    """The disk of the database is full; SQLite writes a deletion into its log, too, before it frees anything."""

    def __init__(self) -> None:
        super().__init__(FULL)


class NewerDatabaseError(StoreError):
    """A newer version of this program has changed the database in a way that this one does not know."""


class ShareSpentError(StoreError):
    """A caller has as many unsaved machines as one may have."""


class NoRoomError(StoreError):
    """The unsaved machines take as much room as all of them may."""


class KeySpentError(StoreError):
    """The selection saved under an idempotency key has been deleted since."""


class KeyReusedError(StoreError):
    """An idempotency key that was used before comes with other content."""


class LabelTakenError(StoreError):
    """A document has a revision with this label already."""


class NameTakenError(StoreError):
    """Its owner has a list of motors with this name already."""


class ListsSpentError(StoreError):
    """Its owner has as many lists of motors as one may have."""


class ExcessError(StoreError):
    """A document would have more of something than one may have: `axes`, `phases` or `revisions`."""

    def __init__(self, what: str, most: int) -> None:
        self.what, self.most = what, most
        super().__init__(f"a document may have {most} {what} at most")
