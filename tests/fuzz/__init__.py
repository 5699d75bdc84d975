"""Broken inputs by the hundred thousand through every door: never a server error, none over a second."""
