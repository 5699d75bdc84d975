"""Work in a process beside the service that may take only so much memory and time, as reading a file does."""

import asyncio
import io
import logging
import os
import pickle
import resource
import signal
import sys
import time
import warnings
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from hpn.tables.cells import Figure
from hpn.tables.reading import Reading, reading_of
from hpn.web.door.beside import Bounds, CallResult
from hpn.web.door.pools import TOO_LARGE, Places, Pool
from hpn.web.door.problems import Problem
from hpn.web.pages.paste import BOUNDS
from tests.operations.service import is_gone

SMALL = Bounds(400_000_000, 0.5)


@pytest.fixture
def free() -> Iterator[Pool]:
    """A pool whose process has no bounds."""
    pool = Pool(Places(1, 3))
    yield pool
    pool.beside.close()


@pytest.fixture
def bounded() -> Iterator[Pool]:
    """A pool whose process may take little."""
    pool = Pool(Places(1, 3), SMALL)
    yield pool
    pool.beside.close()


@pytest.fixture
def roomy() -> Iterator[Pool]:
    """A pool whose process may take little memory, and as much time as a busy machine wants for it."""
    pool = Pool(Places(1, 3), SMALL._replace(seconds=60))
    yield pool
    pool.beside.close()


@pytest.mark.anyio
@pytest.mark.parametrize(
    "work",
    [
        pytest.param(partial(bytearray, 500_000_000), id="memory"),
        pytest.param(partial(sum, range(10**12)), id="processor, in one call of a library"),
        pytest.param(partial(time.sleep, 60), id="time"),
        pytest.param(os.abort, id="a library that aborts"),
    ],
)
async def test_work_that_meets_a_bound_is_a_413_and_the_next_is_done(bounded: Pool, work: Any) -> None:
    first = await bounded.run_beside(os.getpid)

    start = time.monotonic()
    with pytest.raises(Problem) as ended:
        await bounded.run_beside(work)

    assert ended.value.status_code == 413
    assert [sentence.template for sentence in ended.value.sentences] == [TOO_LARGE]
    assert time.monotonic() - start < 10
    assert is_gone(first)
    assert await bounded.run_beside(partial(sum, [1, 2])) == 3


@pytest.mark.anyio
async def test_a_bounded_process_that_the_system_kills_is_a_503(bounded: Pool) -> None:
    with pytest.raises(Problem) as ended:
        await bounded.run_beside(partial(signal.raise_signal, signal.SIGKILL))
    assert ended.value.status_code == 503


def speak() -> str:
    """Say something in every way that a library has, and what kind of text a cell may be."""
    warnings.warn("4711 of a stranger's file", stacklevel=1)
    print("4711", file=sys.stderr)
    logging.getLogger("openpyxl").error("4711")
    return Figure("40 Nm")


@pytest.mark.anyio
async def test_nothing_of_a_strangers_file_gets_into_the_log_and_a_text_comes_back_as_one(
    roomy: Pool, capfd: pytest.CaptureFixture[str]
) -> None:
    result = await roomy.run_beside(speak)

    assert (result, type(result)) == ("40 Nm", str)
    assert capfd.readouterr() == ("", "")


def read_table() -> Reading:
    """A reading with everything in it that one may have."""
    return reading_of("T [Nm];n;t\n1.234;100;1\nSumme;;\n2.5;200;1", BOUNDS)


@pytest.mark.anyio
async def test_a_reading_comes_back_as_it_was(roomy: Pool) -> None:
    result = await roomy.run_beside(read_table)
    assert result == read_table() and result.table and result.table.choices and result.table.shown


class Trap:
    """Content that runs something where it is unpickled."""

    def __reduce__(self) -> tuple[Any, ...]:
        return os.mkdir, ("trapped",)


@pytest.mark.parametrize("head", [b"", b"\x40" + bytes(7)], ids=["alone", "with its length"])
def test_an_answer_is_never_run(head: bytes, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises((EOFError, ValueError)):
        CallResult.from_pipe(io.BytesIO(head + pickle.dumps(Trap())))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.anyio
async def test_a_bound_of_time_counts_for_each_call_alone(bounded: Pool) -> None:
    own = await bounded.run_beside(os.getpid)
    for _ in range(4):
        await bounded.run_beside(partial(time.sleep, 0.2))
    await asyncio.sleep(SMALL.seconds)
    assert await bounded.run_beside(os.getpid) == own


@pytest.mark.anyio
async def test_a_bounded_process_stands_back_and_others_have_no_bounds(free: Pool, bounded: Pool) -> None:
    own = await bounded.run_beside(os.getpid)
    assert os.getpriority(os.PRIO_PROCESS, own) >= 10
    assert resource.prlimit(own, resource.RLIMIT_CORE)[0] == 0
    assert resource.prlimit(own, resource.RLIMIT_DATA)[0] == SMALL.memory_bytes
    assert resource.prlimit(await free.run_beside(os.getpid), resource.RLIMIT_DATA)[0] != SMALL.memory_bytes


@pytest.mark.anyio
async def test_a_process_beside_is_the_first_to_go_where_memory_runs_out_and_no_terminal_interrupts_it(
    free: Pool,
) -> None:
    own = await free.run_beside(os.getpid)
    assert Path(f"/proc/{own}/oom_score_adj").read_text(encoding="ascii").strip() == "1000"
    assert os.getpgid(own) != os.getpgid(0)  # Ctrl+C reaches the group of the service, which finishes what runs


@pytest.mark.anyio
async def test_a_bounded_process_that_has_grown_is_not_kept(roomy: Pool) -> None:
    own = await roomy.run_beside(os.getpid)
    assert await roomy.run_beside(partial(len, bytearray(1000))) == 1000
    assert await roomy.run_beside(os.getpid) == own
    assert await roomy.run_beside(partial(eval, "len(bytes(100_000_000).hex())")) == 200_000_000
    assert is_gone(own)
    assert await roomy.run_beside(os.getpid) != own
