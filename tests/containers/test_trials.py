"""The command without an engine, and its count. The trials themselves are no part of `make test`."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.containers.trials import Trials

ROOT = Path(__file__).parents[2]


def test_without_an_engine_it_says_so_and_ends_with_3(tmp_path: Path) -> None:
    environment = os.environ | {"PATH": str(tmp_path), "XDG_CACHE_HOME": str(tmp_path)}
    command = [sys.executable, "-m", "tests.containers"]

    tried = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=60)

    assert tried.returncode == 3, tried.stderr
    assert tried.stdout.startswith("NOT TRIED: "), tried.stdout
    assert "missing" in tried.stdout


def test_a_trial_that_fails_is_told_and_counted(capsys: pytest.CaptureFixture[str]) -> None:
    trials = Trials()

    def fails() -> str:
        raise AssertionError("the spool is still full")

    trials.try_one("a full spool empties", fails)
    trials.try_one("a page answers", lambda: "200")

    output = capsys.readouterr().out
    assert (trials.failed, trials.passed) == (["a full spool empties"], ["a page answers"])
    assert "FAILED" in output and "the spool is still full" in output
    assert output.rstrip().endswith("a page answers: 200")
