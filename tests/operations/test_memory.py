"""The heap in huge pages: where the system has them, and at no cost in memory."""

import mmap
import os
import platform
import re
import subprocess
import sys
from pathlib import Path

import pytest

from hpn.web.door.memory import into_huge_pages

OFFERED = Path("/sys/kernel/mm/transparent_hugepage/enabled")

PROGRAM = """
import mmap, re, zlib
from pathlib import Path
from hpn.web.door.memory import into_huge_pages

def kilobytes(name):
    return int(re.search(rf"^{name}: +([0-9]+)", Path("/proc/self/smaps_rollup").read_text(), re.MULTILINE)[1])

heap = [bytes([n % 256]) * 500 for n in range(100_000)]
sparse = mmap.mmap(-1, 1 << 26, mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS)
for place in range(0, len(sparse), 1 << 20):
    sparse[place] = 1
content, before = zlib.crc32(b"".join(heap)), kilobytes("Rss")
into_huge_pages()
print(kilobytes("AnonHugePages"), kilobytes("Rss") / before, zlib.crc32(b"".join(heap)) == content)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux has them")
def test_a_filled_heap_comes_into_huge_pages_and_takes_no_more_memory() -> None:
    run = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=True, timeout=120)
    huge_kB, growth, kept = run.stdout.split()

    assert kept == "True"
    assert float(growth) < 1.1
    at_once = [int(part) for part in re.findall("[0-9]+", platform.release())[:2]] >= [6, 1]  # others take their time
    if at_once and OFFERED.exists() and "[never]" not in OFFERED.read_text():
        assert int(huge_kB) > 20_000


def test_an_area_of_a_file_whose_name_is_no_text_keeps_nothing_from_starting(tmp_path: Path) -> None:
    path = os.fsencode(tmp_path) + b"/caf\xe9"
    with open(path, "wb+") as file:
        file.write(bytes(4096))
        file.flush()
        with mmap.mmap(file.fileno(), 4096):
            into_huge_pages()


def test_a_system_that_does_not_tell_its_areas_keeps_nothing_from_starting(monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(path: Path, **_: str) -> str:
        raise PermissionError(path)

    monkeypatch.setattr(Path, "read_text", refused)

    into_huge_pages()
