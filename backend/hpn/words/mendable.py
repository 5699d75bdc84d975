"""The base of errors whose text is for people."""


class MendableError(Exception):
    """Something that the caller or the operator can mend; the text names it and says what would be right."""
