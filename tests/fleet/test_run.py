"""A run that is stopped or killed: its files appear whole or not at all, with the same bytes in any case."""

import os
import random
import resource
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from hpn.catalogue import Catalogue
from hpn.cli import main
from hpn.fleet import run as fleet_run
from hpn.fleet.cluster import interrupts_held
from hpn.fleet.order import FleetError, Order
from hpn.fleet.run import Outcome, Size, here, size_fleet, threads
from hpn.fleet.tables import Progress, RowBatch
from tests.fleet.tables import row_of, write
from tests.property.draw import at_random
from tests.reliability.faults import as_user, catalogue_for_all, full, small_disk


@pytest.fixture(scope="module")
def many(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A table of many row groups."""
    rows = [row_of(number, at_random(random.Random(number))) for number in range(400)]
    return write(tmp_path_factory.mktemp("many") / "in.parquet", rows, unit_rows=10)


def files(folder: Path) -> list[str]:
    """Names in a folder."""
    return sorted(path.name for path in folder.iterdir())


def test_the_same_input_gives_the_same_bytes_whatever_the_workers(
    many: Path, tmp_path: Path, catalogue: Catalogue
) -> None:
    for name, engine in (("one", threads(1)), ("three", threads(3)), ("here", here)):
        size_fleet(Order(many, tmp_path / f"{name}.parquet", rejected=tmp_path / f"{name}.csv"), catalogue, engine)
    for suffix in ("parquet", "csv"):
        one, three, alone = ((tmp_path / f"{name}.{suffix}").read_bytes() for name in ("one", "three", "here"))
        assert one == three == alone
    assert len(files(tmp_path)) == 6


@pytest.mark.parametrize("workers", [1, 3])
def test_few_axes_are_read_ahead_of_what_is_written(
    workers: int, many: Path, tmp_path: Path, catalogue: Catalogue, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(fleet_run, "SLICE_AXES", 10)
    noted: list[int] = []

    def note(progress: Progress) -> None:
        noted.append(progress.done)

    size_fleet(Order(many, tmp_path / "out.parquet"), catalogue, threads(workers), note)
    assert len(noted) == 40
    assert all(read <= 10 * (place + 2 * workers) for place, read in enumerate(noted, start=1))


def test_two_runs_never_write_one_file(many: Path, tmp_path: Path, catalogue: Catalogue) -> None:
    order = Order(many, tmp_path / "out.parquet")

    def meanwhile(size: Size, batches: Iterator[RowBatch]) -> Iterator[Outcome]:
        with pytest.raises(FleetError, match="another run is writing it"):
            size_fleet(order, catalogue)
        yield from here(size, batches)

    assert size_fleet(order, catalogue, meanwhile) == {"answers": 400}
    assert files(tmp_path) == ["out.parquet"]


def test_an_error_midway_leaves_no_file(many: Path, tmp_path: Path, catalogue: Catalogue) -> None:
    def fails(size: Size, batches: Iterator[RowBatch]) -> Iterator[Outcome]:
        yield size(next(batches))
        raise MemoryError

    order = Order(many, tmp_path / "out.csv", candidates=tmp_path / "all.csv", rejected=tmp_path / "bad.csv")
    with pytest.raises(MemoryError):
        size_fleet(order, catalogue, fails)
    assert files(tmp_path) == []


# --- The command ------------------------------------------------------------------------------------------------------


SMALL = """
import signal
from hpn.cli import main
from hpn.fleet import run

signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell in the background has it ignored
run.SLICE_AXES = run.SLICE_WITH_CANDIDATES = 10
if __name__ == "__main__":
    raise SystemExit(main())
"""
COMMAND = [sys.executable, "-c", SMALL, "fleet"]
"""The command, with 10 axes at a time."""

SLOWLY = ("--workers", 2, "--candidates")
"""Options with which a run takes a while: every candidate of every axis is written."""


def ended(*arguments: object) -> subprocess.CompletedProcess[str]:
    """The command, when it has ended."""
    return subprocess.run([*COMMAND, *map(str, arguments)], capture_output=True, text=True)


@contextmanager
def started(*arguments: object) -> Iterator[subprocess.Popen[str]]:
    """The command while it runs, in a group of its own as on a terminal."""
    command = [*COMMAND, *map(str, arguments)]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, start_new_session=True) as run:
        yield run


def wait_until_begun(run: subprocess.Popen[str], output: Path) -> None:
    """Wait until the first candidates are set aside, or the command has ended."""
    aside = output.with_name(f".unfinished.{output.name}.candidates")
    while run.poll() is None and not (aside.exists() and aside.stat().st_size > 10_000):
        time.sleep(0.005)


def test_the_command_sizes_a_table_and_is_quiet(many: Path, tmp_path: Path) -> None:
    run = ended(many, tmp_path / "out.csv", "--workers", 2)
    assert (run.stdout, run.stderr, run.returncode) == ("", "", 0)
    assert len((tmp_path / "out.csv").read_text().splitlines()) == 401


@pytest.mark.parametrize(
    ("source", "workers", "message"),
    [
        ("none.csv", "2", "none.csv: there is no such file"),
        ("none.txt", "2", "none.txt: the suffix must be one of .parquet, .arrow"),
        ("none.csv", "0", "must be from 1 to 1024"),
    ],
)
def test_an_unusable_input_ends_with_2_and_its_name(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], source: str, workers: str, message: str
) -> None:
    try:
        ended_with = main(["fleet", str(tmp_path / source), str(tmp_path / "out.csv"), "--workers", workers])
    except SystemExit as end:  # of argparse
        ended_with = int(end.code or 0)
    assert ended_with == 2
    assert message in capsys.readouterr().err


@pytest.mark.parametrize(
    ("option", "value", "message"),
    [
        ("--scheduler", "tcp://here:8786", "--scheduler: belongs to --engine dask"),
        ("--lang", "de", "--lang: belongs to --report"),
        ("--lang", "en", "--lang: belongs to --report"),
        ("--service", "https://gears.example", "--service: belongs to --report"),
    ],
)
def test_an_option_that_says_nothing_without_another_is_refused(
    many: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], option: str, value: str, message: str
) -> None:
    assert main(["fleet", str(many), str(tmp_path / "out.csv"), option, value]) == 2
    assert message in capsys.readouterr().err
    assert not files(tmp_path)


@pytest.mark.parametrize(
    ("source", "output", "message"),
    [
        ("secret.csv", "open/out.csv", "secret.csv: this user may not read it"),
        ("closed/in.csv", "open/out.csv", "closed/in.csv: this user may not read it"),
        ("in.csv", "out.csv", "out.csv: this user may not write into "),
        ("in.csv", "closed/out.csv", "closed/out.csv: this user may not write into "),
        ("in.csv", "closed/deeper/out.csv", "closed/deeper: this user may not read it"),
    ],
)
@pytest.mark.parametrize("python", ["this", "3.14"])
def test_a_file_that_permissions_forbid_ends_with_2_and_its_name(
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    source: str,
    output: str,
    message: str,
    python: str,
) -> None:
    if python == "3.14":  # whose paths say that nothing is there where this user may not look
        monkeypatch.setattr(Path, "exists", lambda path: os.path.exists(path))
        monkeypatch.setattr(Path, "is_file", lambda path: os.path.isfile(path))
        monkeypatch.setattr(Path, "is_dir", lambda path: os.path.isdir(path))
    with TemporaryDirectory() as name:
        folder = Path(name)
        catalogue_for_all(folder, monkeypatch)
        (folder / "closed").mkdir()
        (folder / "open").mkdir()
        for path in ("in.csv", "secret.csv", "closed/in.csv"):
            write(folder / path, [row_of("a", at_random(random.Random(1)))])
        assert main(["fleet", str(folder / "in.csv"), str(folder / "before.csv")]) == 0  # loads all modules
        for path, mode in (("", 0o755), ("secret.csv", 0o000), ("closed", 0o000), ("open", 0o777)):
            (folder / path).chmod(mode)
        with as_user(65534):
            assert main(["fleet", str(folder / source), str(folder / output)]) == 2
        (folder / "closed").chmod(0o755)
        assert not list((folder / "open").iterdir())

    assert message in capsys.readouterr().err


def test_a_file_that_can_not_be_written_stops_the_run(
    many: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, limits[1]))
    try:
        assert main(["fleet", str(many), str(tmp_path / "out.csv")]) == 1
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert capsys.readouterr().err.startswith("stopped: ")
    assert files(tmp_path) == []


def test_an_interrupt_leaves_nothing_and_ends_with_1(many: Path, tmp_path: Path) -> None:
    with started(many, tmp_path / "out.parquet", *SLOWLY, tmp_path / "all.csv") as run:
        wait_until_begun(run, tmp_path / "out.parquet")
        os.killpg(run.pid, signal.SIGINT)
        message = run.communicate()[1]

    assert (run.returncode, message) == (1, "stopped\n")
    assert files(tmp_path) == []


def test_an_interrupt_that_another_thread_takes_waits_until_the_workers_have_started() -> None:
    over, reached = threading.Event(), False
    notice, tells = socket.socketpair()
    tells.setblocking(False)
    other = threading.Thread(target=over.wait)
    other.start()
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background has it ignored
    awake = signal.set_wakeup_fd(tells.fileno())
    try:
        with notice, tells, pytest.raises(KeyboardInterrupt), interrupts_held():
            signal.pthread_kill(other.ident or 0, signal.SIGINT)
            notice.recv(1)  # once the other thread has taken it
            reached = True
    finally:
        signal.set_wakeup_fd(awake)
        signal.signal(signal.SIGINT, before)
        over.set()
        other.join()
    assert reached


def test_after_a_kill_at_any_moment_the_next_run_gives_the_same_bytes(many: Path, tmp_path: Path, soak: bool) -> None:
    whole, out = tmp_path / "whole", tmp_path / "out"
    for folder in (whole, out):
        folder.mkdir()
    assert ended(many, whole / "a.parquet", *SLOWLY, whole / "all.csv").returncode == 0
    chance = random.Random(17)
    for _ in range(20 if soak else 2):
        with started(many, out / "a.parquet", *SLOWLY, out / "all.csv") as run:
            wait_until_begun(run, out / "a.parquet")
            with suppress(subprocess.TimeoutExpired):
                run.wait(chance.uniform(0, 0.3))
            run.kill()
        assert run.returncode == 0 or not {"a.parquet", "all.csv"} & set(files(out))
        assert ended(many, out / "a.parquet", *SLOWLY, out / "all.csv").returncode == 0
        assert files(out) == files(whole) == ["a.parquet", "all.csv"]
        for name in files(whole):
            assert (out / name).read_bytes() == (whole / name).read_bytes()
            (out / name).unlink()


def test_a_full_disk_is_said_and_leaves_nothing(many: Path, tmp_path: Path) -> None:
    disk = tmp_path / "disk"
    disk.mkdir()
    output = disk / "out.csv"
    with small_disk(disk):
        with full(disk):
            before = files(disk)
            run = ended(many, output, "--workers", 1)
            assert run.returncode == 1
            assert "No space left on device" in run.stderr
            assert files(disk) == before
        assert ended(many, output).returncode == 0
        assert len(output.read_text().splitlines()) == 401
