"""Templates compiled once per process: every application compiles its own, which takes longer than most tests of it."""

from collections.abc import Iterator
from functools import partial

import pytest
from jinja2 import BytecodeCache, Environment
from jinja2.bccache import Bucket


class Compiled(BytecodeCache):
    """Compiled templates in memory; Jinja compares the checksum of a template's source."""

    def __init__(self) -> None:
        self._code: dict[str, bytes] = {}

    def load_bytecode(self, bucket: Bucket) -> None:
        """Take what another application has compiled."""
        if bucket.key in self._code:
            bucket.bytecode_from_string(self._code[bucket.key])

    def dump_bytecode(self, bucket: Bucket) -> None:
        """Keep what is compiled for the next application."""
        self._code[bucket.key] = bucket.bytecode_to_string()


@pytest.fixture(scope="package", autouse=True)
def compiled_templates() -> Iterator[None]:
    """All applications of this process share their compiled templates."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("hpn.web.pages.templates.Environment", partial(Environment, bytecode_cache=Compiled()))
        yield
