"""Trial of a mutant: a forked process imports it in place of the module, and runs tests until one fails."""

import os
import resource
import sys
import time
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import CodeType
from typing import Any

import hypothesis
import pytest

CPU_SECONDS = 120
"""Processor time in seconds after which a mutant counts as hanging, which a test would notice."""


class _FewExamples:
    """Plugin: few examples of the property tests, enough to find plain errors."""

    def pytest_collection(self) -> None:
        """Load the profile after that of `tests/conftest.py`, before test modules are imported."""
        settings = hypothesis.settings
        settings.register_profile("mutants", parent=settings.get_profile("hpn"), max_examples=10)
        settings.load_profile("mutants")


def survives(path: Path, source: str, tests: list[str]) -> bool:
    """True where all tests pass with the module at `path` made of `source`."""
    child = os.fork()
    if child == 0:
        code = 1
        try:
            code = _tried(path, source, tests)
        finally:
            os._exit(code)
    _, status = os.waitpid(child, 0)
    return status == 0


def _tried(path: Path, source: str, tests: list[str]) -> int:
    resource.setrlimit(resource.RLIMIT_CPU, (CPU_SECONDS, CPU_SECONDS))
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    os.dup2(nowhere, 2)
    sys.dont_write_bytecode = True
    original: Any = SourceFileLoader.get_code

    def get_code(self: SourceFileLoader, name: str) -> CodeType | None:
        if Path(self.path) == path:
            return compile(source, self.path, "exec", dont_inherit=True)
        code: CodeType | None = original(self, name)
        return code

    SourceFileLoader.get_code = get_code  # type: ignore[assignment, method-assign]
    options = ["-x", "-q", "--no-header", "--assert=plain", "-p", "no:cacheprovider"]
    return int(pytest.main([*options, *tests], plugins=[_FewExamples()]))


def timed(path: Path, source: str, tests: list[str]) -> tuple[bool, float]:
    """Outcome of `survives`, and its duration in seconds."""
    start = time.monotonic()
    return survives(path, source, tests), time.monotonic() - start
