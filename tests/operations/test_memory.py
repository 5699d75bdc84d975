"""The heap in huge pages: where the system has them, and at no cost in memory."""

import platform
import subprocess
import sys
from pathlib import Path

import pytest

from hpn.web.memory import into_huge_pages

OFFERED = Path("/sys/kernel/mm/transparent_hugepage/enabled")

PROGRAM = """
import mmap, re
from pathlib import Path
from hpn.web.memory import into_huge_pages

def kilobytes(name):
    return int(re.search(rf"^{name}: +([0-9]+)", Path("/proc/self/smaps_rollup").read_text(), re.MULTILINE)[1])

heap, sparse = [bytes(500) for _ in range(100_000)], mmap.mmap(-1, 1 << 26, mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS)
for place in range(0, len(sparse), 1 << 20):
    sparse[place] = 1
before = kilobytes("Rss")
into_huge_pages()
print(kilobytes("AnonHugePages"), kilobytes("Rss") / before, sum(map(len, heap)))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux has them")
def test_a_filled_heap_comes_into_huge_pages_and_takes_no_more_memory() -> None:
    run = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=True, timeout=120)
    huge_kB, growth, kept = run.stdout.split()

    assert kept == str(500 * 100_000)
    assert float(growth) < 1.1
    at_once = tuple(map(int, platform.release().split(".")[:2])) >= (6, 1)  # an older system takes its time
    if at_once and OFFERED.exists() and "[never]" not in OFFERED.read_text():
        assert int(huge_kB) > 20_000


def test_a_system_that_does_not_tell_its_areas_keeps_nothing_from_starting(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(path: Path) -> str:
        raise PermissionError(path)

    monkeypatch.setattr(Path, "read_text", refused)

    into_huge_pages()
