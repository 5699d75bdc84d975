"""State of a service, behind a client of it."""

from fastapi import FastAPI
from starlette.datastructures import State
from starlette.testclient import TestClient


def state_of(client: TestClient) -> State:
    """State of the application that a client talks to."""
    assert isinstance(client.app, FastAPI)
    return client.app.state
