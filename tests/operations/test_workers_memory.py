"""More workers than the container has memory for are named at the start."""

from pathlib import Path

import pytest

from hpn.web.serve import LIMITS, shortage


@pytest.mark.parametrize(
    ("workers", "limit", "enough"),
    [
        (2, f"{4608 << 20}\n", True),  # the compose file's own
        (4, f"{4608 << 20}\n", False),
        (4, f"{8192 << 20}\n", True),
        (64, "max\n", True),
        (64, f"{2**63 - 4096}\n", True),  # no limit in the first version of control groups
    ],
)
def test_workers_that_may_take_more_than_there_is_are_named(
    workers: int, limit: str, enough: bool, tmp_path: Path
) -> None:
    file = tmp_path / "memory.max"
    file.write_text(limit)

    message = shortage(workers, 1_000_000_000, [file, tmp_path / "none"])

    assert (message is None) is enough
    if message is not None:
        assert message.startswith("HPN_WORKERS is 4, which with fleets may take 7.2 GB, and this container has 4.8 GB")
        assert "WEB_MEMORY" in message


def test_a_machine_without_limits_says_nothing(tmp_path: Path) -> None:
    assert shortage(64, 1_000_000_000, [tmp_path / "none"]) is None
    assert all(file.is_absolute() for file in LIMITS)
