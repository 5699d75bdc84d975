"""Backups on a schedule: the compose file's script writes one when the newest is too old, and keeps the newest."""

import os
import subprocess
import time
from pathlib import Path

import pytest

from tests.databases import postgresql
from tests.operations.stack import ROOT, SERVICES, Stack, found, saved

__all__ = ["postgresql"]


def scheduled(stack: Stack, action: str, **settings: str) -> "subprocess.Popen[str]":
    """The compose file's script at work in the folder of backups."""
    own = {"BACKUP_HOURS": "24", "BACKUP_KEEP": "3", "BACKUP_SECONDS": "1", **settings}
    return subprocess.Popen(
        ["sh", str(ROOT / "backend/backup.sh"), action],
        cwd=stack.folder / "backups",
        env=stack.environment | own,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def aged(stack: Stack, name: str, hours: float) -> Path:
    """A backup of so many hours ago."""
    file = stack.folder / "backups" / name
    file.touch()
    os.utime(file, (time.time() - 3600 * hours,) * 2)
    return file


def test_a_backup_is_written_when_the_newest_is_too_old_and_the_newest_are_kept(stack: Stack) -> None:
    assert SERVICES["backups"]["command"] == ["sh", "/backup.sh", "schedule"]
    environment = SERVICES["backups"]["environment"]
    assert (environment["BACKUP_HOURS"], environment["BACKUP_KEEP"]) == (
        "${BACKUP_HOURS:-24}",
        "${BACKUP_KEEP:-14}",
    )
    old = [aged(stack, f"hpn-2026010{day}T020000Z.dump", 24 * (9 - day)) for day in range(1, 6)]
    torn = aged(stack, "hpn-20260101T020000Z.dump.part", 48)
    other = aged(stack, "notes.txt", 999)
    id = saved(stack)

    with scheduled(stack, "schedule") as process:
        assert process.stdout is not None
        name = process.stdout.readline().strip()
        removed = {process.stdout.readline().strip() for _ in range(3)}
        time.sleep(2)  # it looks again, and finds a new one
        process.terminate()
        assert process.stdout.read() == ""

    assert process.returncode == 0
    assert removed == {f"removed {file.name}" for file in old[:3]}
    assert {file.name for file in (stack.folder / "backups").iterdir()} == {
        name,
        *(f.name for f in old[3:]),
        other.name,
    }
    assert not torn.exists()
    saved(stack)
    assert stack.restore(name).returncode == 0
    assert found(stack) == [id]


def test_without_a_database_no_backup_is_removed_and_the_service_is_unhealthy_after_a_missed_one(stack: Stack) -> None:
    values = [aged(stack, f"hpn-2026010{day}T020000Z.dump", 24 * (9 - day)) for day in range(1, 6)]

    with scheduled(stack, "schedule", PGHOST="127.0.0.1", PGPORT="9") as process:
        assert process.stderr is not None
        message = next(line for line in process.stderr if line.startswith("no backup"))
        process.terminate()

    assert message == "no backup could be written; the next try is in 1 s\n"
    assert all(file.exists() for file in values)
    missed = scheduled(stack, "has_recent")
    assert (missed.communicate()[1], missed.returncode) == ("no backup of the last 24 hours\n", 1)
    aged(stack, "hpn-20260109T020000Z.dump", 24.5)
    recent = scheduled(stack, "has_recent")
    assert (recent.communicate()[1], recent.returncode) == ("", 0)


@pytest.mark.parametrize("setting", [{"BACKUP_HOURS": "0"}, {"BACKUP_KEEP": "0"}, {"BACKUP_KEEP": "x"}])
def test_a_schedule_without_numbers_says_which_ones(stack: Stack, setting: dict[str, str]) -> None:
    process = scheduled(stack, "schedule", **setting)

    assert "BACKUP_HOURS and BACKUP_KEEP must be whole numbers from 1" in process.communicate(timeout=20)[1]
    assert process.returncode == 1
