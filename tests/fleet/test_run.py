"""A run that is stopped, killed or resumed: its files appear whole or not at all, with the same bytes in any case."""

import os
import random
import resource
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from hpn.catalogue import Catalogue
from hpn.cli import main
from hpn.fleet import grouping
from hpn.fleet.errors import FleetError
from hpn.fleet.grouping import Part
from hpn.fleet.job import Job
from hpn.fleet.run import Engine, Order, interrupts_held, processes, size_fleet
from tests.fleet.tables import here, quiet, row_of, write
from tests.operations.service import until
from tests.property.draw import at_random
from tests.reliability.faults import as_user, full, small_disk


@pytest.fixture(scope="module")
def many(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A table of many parts."""
    rows = [row_of(number, at_random(random.Random(number))) for number in range(400)]
    return write(tmp_path_factory.mktemp("many") / "in.parquet", rows, unit_rows=10)


@pytest.fixture
def small_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    """Parts of 10 axes."""
    monkeypatch.setattr(grouping, "PART_AXES", 10)


def files(folder: Path) -> list[str]:
    """What lies in a folder."""
    return sorted(path.name for path in folder.iterdir())


class StoppedError(Exception):
    """The run ends here."""


def up_to(count: int) -> Engine:
    """Engine that is stopped after so many parts."""

    def run(job: Job, parts: Mapping[int, Part]) -> Iterator[int]:
        yield from here(job, dict(list(parts.items())[:count]))
        raise StoppedError

    return run


def test_the_same_input_gives_the_same_bytes_whatever_the_workers(
    many: Path, small_parts: None, tmp_path: Path, catalogue: Catalogue
) -> None:
    for name, engine in (("one", processes(1)), ("two", processes(2)), ("here", here)):
        size_fleet(
            Order(many, tmp_path / f"{name}.parquet", rejected=tmp_path / f"{name}.csv"), catalogue, engine, quiet
        )
    for suffix in ("parquet", "csv"):
        one, two, alone = ((tmp_path / f"{name}.{suffix}").read_bytes() for name in ("one", "two", "here"))
        assert one == two == alone
    assert len(files(tmp_path)) == 6


def test_a_stopped_run_is_gone_on_with(many: Path, small_parts: None, tmp_path: Path, catalogue: Catalogue) -> None:
    size_fleet(Order(many, tmp_path / "whole.parquet"), catalogue, here, quiet)
    order = Order(many, tmp_path / "out.parquet", resume=True)
    done: list[int] = []

    def counted(job: Job, parts: Mapping[int, Part]) -> Iterator[int]:
        for number in here(job, parts):
            done.append(number)
            yield number

    for count in (3, 0, 10):
        with pytest.raises(StoppedError):
            size_fleet(order, catalogue, up_to(count), quiet)
        assert not order.answers.exists()
    size_fleet(order, catalogue, counted, quiet)

    assert done == list(range(13, 40))
    assert order.answers.read_bytes() == (tmp_path / "whole.parquet").read_bytes()
    assert files(tmp_path) == ["out.parquet", "whole.parquet"]


def test_parts_of_another_input_are_refused_and_dropped_without_resume(
    many: Path, small_parts: None, tmp_path: Path, catalogue: Catalogue
) -> None:
    own = tmp_path / "in.parquet"
    own.write_bytes(many.read_bytes())
    order = Order(own, tmp_path / "out.parquet", resume=True)
    with pytest.raises(StoppedError):
        size_fleet(order, catalogue, up_to(3), quiet)
    rows = [row_of(number, at_random(random.Random(number + 1))) for number in range(400)]
    write(own, rows, unit_rows=10)

    with pytest.raises(FleetError, match="a table has changed; run without --resume"):
        size_fleet(order, catalogue, here, quiet)
    size_fleet(Order(own, order.answers), catalogue, here, quiet)
    size_fleet(Order(own, tmp_path / "whole.parquet"), catalogue, here, quiet)
    assert order.answers.read_bytes() == (tmp_path / "whole.parquet").read_bytes()


def test_parts_of_other_options_or_another_catalogue_are_refused(
    many: Path, small_parts: None, tmp_path: Path, catalogue: Catalogue
) -> None:
    with pytest.raises(StoppedError):
        size_fleet(Order(many, tmp_path / "out.parquet"), catalogue, up_to(1), quiet)
    with pytest.raises(FleetError, match="of other options"):
        wider = Order(many, tmp_path / "out.parquet", candidates=tmp_path / "all.csv", resume=True)
        size_fleet(wider, catalogue, here, quiet)


def test_two_runs_never_write_one_file(many: Path, small_parts: None, tmp_path: Path, catalogue: Catalogue) -> None:
    order = Order(many, tmp_path / "out.parquet")

    def meanwhile(job: Job, parts: Mapping[int, Part]) -> Iterator[int]:
        with pytest.raises(FleetError, match="another run is writing it"):
            size_fleet(order, catalogue, here, quiet)
        yield from here(job, parts)

    size_fleet(order, catalogue, meanwhile, quiet)
    assert files(tmp_path) == ["out.parquet"]


@pytest.mark.parametrize("other", ["mine.txt", "sub/mine.txt", "0.answers"])
@pytest.mark.parametrize("resume", [False, True])
def test_a_folder_that_is_not_its_own_is_left_alone(
    resume: bool, other: str, many: Path, tmp_path: Path, catalogue: Catalogue
) -> None:
    order = Order(many, tmp_path / "out.parquet", resume=resume)
    mine = order.folder / other
    mine.parent.mkdir(parents=True)
    mine.write_text("mine", encoding="utf-8")

    with pytest.raises(FleetError, match=str(order.folder / other.split("/")[0])):
        size_fleet(order, catalogue, here, quiet)
    assert files(order.folder) == [other.split("/")[0]]
    assert mine.read_text(encoding="utf-8") == "mine"
    mine.unlink()
    if mine.parent != order.folder:
        mine.parent.rmdir()
    size_fleet(order, catalogue, here, quiet)
    assert files(tmp_path) == ["out.parquet"]


@pytest.mark.parametrize("resume", [False, True])
def test_a_file_where_the_parts_belong_is_named_and_left_alone(resume: bool, many: Path, tmp_path: Path) -> None:
    mine = tmp_path / "out.parquet.parts"
    mine.write_text("mine", encoding="utf-8")
    with started(many, tmp_path / "out.parquet", *["--resume"] * resume) as run:
        said = run.communicate()[1]

    assert run.returncode == 2
    assert said == f"{mine}: is no folder, where the parts of the run belong; move it away\n"
    assert mine.read_text(encoding="utf-8") == "mine"


# --- The command ------------------------------------------------------------------------------------------------------


SMALL = """
import signal
from hpn.cli import main
from hpn.fleet import grouping

signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell in the background has it ignored
grouping.PART_AXES = 10
if __name__ == "__main__":
    raise SystemExit(main())
"""
COMMAND = [sys.executable, "-c", SMALL, "fleet"]
"""The command, with parts of 10 axes."""

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


def parts_done(folder: Path) -> int:
    """How many parts of a run are whole."""
    return len(list(folder.glob("*.answers")))


def wait_for_parts(run: subprocess.Popen[str], folder: Path) -> None:
    """Wait until the first part of a run is whole."""
    while not parts_done(folder):
        assert run.poll() is None, run.communicate()[1]
        time.sleep(0.01)


def test_the_command_sizes_a_table_and_is_quiet(many: Path, tmp_path: Path) -> None:
    run = ended(many, tmp_path / "out.csv", "--workers", 2)
    assert (run.stdout, run.stderr, run.returncode) == ("", "", 0)
    assert len((tmp_path / "out.csv").read_text().splitlines()) == 401


@pytest.mark.parametrize(
    ("source", "workers", "said"),
    [
        ("none.csv", "2", "none.csv: there is no such file"),
        ("none.txt", "2", "none.txt: the suffix must be one of .parquet, .arrow"),
        ("none.csv", "0", "must be from 1 to 1024"),
    ],
)
def test_an_unusable_input_ends_with_2_and_its_name(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], source: str, workers: str, said: str
) -> None:
    try:
        ended_with = main(["fleet", str(tmp_path / source), str(tmp_path / "out.csv"), "--workers", workers])
    except SystemExit as end:  # of argparse
        ended_with = int(end.code or 0)
    assert ended_with == 2
    assert said in capsys.readouterr().err


@pytest.mark.parametrize(
    ("option", "given", "said"),
    [
        ("--scheduler", "tcp://here:8786", "--scheduler: belongs to --engine dask"),
        ("--lang", "de", "--lang: belongs to --report"),
        ("--lang", "en", "--lang: belongs to --report"),
        ("--service", "https://gears.example", "--service: belongs to --report"),
    ],
)
def test_an_option_that_says_nothing_without_another_is_refused(
    many: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], option: str, given: str, said: str
) -> None:
    assert main(["fleet", str(many), str(tmp_path / "out.csv"), option, given]) == 2
    assert said in capsys.readouterr().err
    assert not files(tmp_path)


@pytest.mark.parametrize(
    ("source", "output", "said"),
    [
        ("secret.csv", "open/out.csv", "secret.csv: this user may not read it"),
        ("closed/in.csv", "open/out.csv", "closed/in.csv: this user may not read it"),
        ("in.csv", "out.csv", "out.csv: this user may not write into "),
        ("in.csv", "closed/out.csv", "closed/out.csv: this user may not write into "),
        ("in.csv", "closed/deeper/out.csv", "closed/deeper: this user may not read it"),
    ],
)
@pytest.mark.parametrize("python", ["this", "3.14"])
def test_what_permissions_forbid_ends_with_2_and_its_name(
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    source: str,
    output: str,
    said: str,
    python: str,
) -> None:
    if python == "3.14":  # whose paths say that nothing is there where this user may not look
        monkeypatch.setattr(Path, "exists", lambda path: os.path.exists(path))
        monkeypatch.setattr(Path, "is_file", lambda path: os.path.isfile(path))
        monkeypatch.setattr(Path, "is_dir", lambda path: os.path.isdir(path))
    with TemporaryDirectory() as name:
        folder = Path(name)
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

    assert said in (error := capsys.readouterr().err)
    assert "--resume" not in error


def test_what_is_stopped_before_it_has_begun_is_not_to_be_resumed(
    many: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, limits[1]))  # as on a full disk, the plan can't be written
    try:
        assert main(["fleet", str(many), str(tmp_path / "out.csv")]) == 1
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    said = capsys.readouterr().err
    assert said.startswith("stopped: ") and "--resume" not in said


def test_an_interrupt_keeps_the_parts_and_ends_with_1(many: Path, tmp_path: Path) -> None:
    folder = tmp_path / "out.parquet.parts"
    with started(many, tmp_path / "out.parquet", *SLOWLY, tmp_path / "all.csv") as run:
        wait_for_parts(run, folder)
        os.killpg(run.pid, signal.SIGINT)
        said = run.communicate()[1]

    assert run.returncode == 1
    assert said == f"stopped; hpn fleet … --resume goes on with the parts in {folder}\n"
    assert parts_done(folder) > 0
    assert files(tmp_path) == ["out.parquet.parts"]


def test_an_interrupt_while_the_workers_start_says_the_same(many: Path, tmp_path: Path) -> None:
    folder = tmp_path / "out.parquet.parts"
    with started(many, tmp_path / "out.parquet", "--workers", 6) as run:
        until(lambda: len(members(run.pid)) > 6 or run.poll() is not None)
        os.killpg(run.pid, signal.SIGINT)
        assert run.communicate()[1] == f"stopped; hpn fleet … --resume goes on with the parts in {folder}\n"
    assert run.returncode == 1


def test_an_interrupt_that_another_thread_takes_waits_until_the_workers_have_started() -> None:
    over, reached = threading.Event(), False
    told, tells = socket.socketpair()
    tells.setblocking(False)
    other = threading.Thread(target=over.wait)
    other.start()
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background has it ignored
    awake = signal.set_wakeup_fd(tells.fileno())
    try:
        with told, tells, pytest.raises(KeyboardInterrupt), interrupts_held():
            signal.pthread_kill(other.ident or 0, signal.SIGINT)
            told.recv(1)  # once the other thread has taken it
            reached = True
    finally:
        signal.set_wakeup_fd(awake)
        signal.signal(signal.SIGINT, before)
        over.set()
        other.join()
    assert reached


def test_a_run_killed_at_random_moments_is_resumed_to_the_same_bytes(many: Path, tmp_path: Path, soak: bool) -> None:
    assert ended(many, tmp_path / "whole.parquet", *SLOWLY, tmp_path / "whole.csv").returncode == 0
    out, parts = tmp_path / "out.parquet", tmp_path / "out.parquet.parts"
    options = [*SLOWLY, tmp_path / "all.csv", "--resume", "--rejected", tmp_path / "bad.csv"]
    chance, kills = random.Random(17), 20 if soak else 2
    for _ in range(10 * kills):
        before = parts_done(parts)
        with started(many, out, *options) as run:
            while parts_done(parts) == before and run.poll() is None:
                time.sleep(0.01)
            with suppress(subprocess.TimeoutExpired):
                run.wait(chance.uniform(0, 0.3))
            run.kill()  # its workers end with it
        kills -= run.returncode == -signal.SIGKILL
        if not kills:
            break
        if run.returncode == 0:
            out.unlink()  # it was done before: once more
    assert not kills, f"{kills} more were to be killed, but were done before"

    assert ended(many, out, *options).returncode == 0
    assert out.read_bytes() == (tmp_path / "whole.parquet").read_bytes()
    assert (tmp_path / "all.csv").read_bytes() == (tmp_path / "whole.csv").read_bytes()
    assert files(tmp_path) == ["all.csv", "bad.csv", "out.parquet", "whole.csv", "whole.parquet"]


def test_workers_end_with_the_command(many: Path, tmp_path: Path) -> None:
    with started(many, tmp_path / "out.parquet", *SLOWLY, tmp_path / "all.csv") as run:
        wait_for_parts(run, tmp_path / "out.parquet.parts")
        os.kill(run.pid, signal.SIGKILL)
        run.wait()
        for _ in range(600):
            if not members(run.pid):
                return
            time.sleep(0.1)
    raise AssertionError(f"processes {members(run.pid)} still run")


def members(group: int) -> list[int]:
    """Processes of a group that run."""
    found = []
    for entry in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = entry.read_text().rpartition(")")[2].split()
        except OSError:
            continue
        if int(fields[2]) == group and fields[0] != "Z":
            found.append(int(entry.parent.name))
    return found


def test_a_worker_that_is_killed_stops_the_run_with_its_parts(many: Path, tmp_path: Path) -> None:
    with started(many, tmp_path / "out.parquet", *SLOWLY, tmp_path / "all.csv") as run:
        wait_for_parts(run, tmp_path / "out.parquet.parts")
        worker = next(pid for pid in members(run.pid) if b"spawn_main" in Path(f"/proc/{pid}/cmdline").read_bytes())
        os.kill(worker, signal.SIGKILL)
        said = run.communicate()[1]
    assert run.returncode == 1
    assert "a worker has died" in said
    assert ended(many, tmp_path / "out.parquet", *SLOWLY, tmp_path / "all.csv", "--resume").returncode == 0


def test_a_full_disk_is_said_and_the_run_can_go_on(many: Path, tmp_path: Path) -> None:
    disk = tmp_path / "disk"
    disk.mkdir()
    output = disk / "out.ndjson"
    with small_disk(disk):
        with full(disk):
            run = ended(many, output, "--workers", 1, "--resume")
            assert run.returncode == 1
            assert "No space left on device" in run.stderr
            assert not output.exists()
        assert ended(many, output, "--resume").returncode == 0
        assert len(output.read_text().splitlines()) == 400
