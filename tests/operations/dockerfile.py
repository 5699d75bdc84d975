"""Runs the steps of `backend/Dockerfile` in an empty folder, for want of an engine.

The base images are this machine: what they would bring (Python, a C library, make) is taken from here, and steps that
change the system itself, such as adding a user, are left out. Each stage is built at the same place and then moved
aside, so that paths written into files stay true, as they do in an image.
"""

import json
import os
import re
import shlex
import shutil
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass, field
from fnmatch import fnmatch
from pathlib import Path

CHANGES_THE_SYSTEM = ("useradd ", "groupadd ", "/usr/local/")
OF_THE_ENGINE = ("LABEL", "USER", "EXPOSE", "VOLUME", "HEALTHCHECK", "CMD")


@dataclass
class Image:
    """Result of the build."""

    root: Path
    environment: dict[str, str] = field(default_factory=dict)
    folder: str = "/"
    settings: dict[str, str] = field(default_factory=dict)
    skipped: list[str] = field(default_factory=list)

    def place(self, path: str) -> Path:
        """Place of a path of the image on this machine."""
        return self.root / os.path.join(self.folder, path).lstrip("/")

    def command(self, instruction: str) -> list[str]:
        """Words of CMD or HEALTHCHECK."""
        text = self.settings[instruction]
        words: list[str] = json.loads(text[text.index("[") :])
        return words

    def run(self, words: list[str], **environment: str) -> "subprocess.Popen[bytes]":
        """Start a command as a container would."""
        variables = machine() | self.environment | environment
        program = shutil.which(words[0], path=variables["PATH"])
        assert program is not None, words[0]
        return subprocess.Popen([program, *words[1:]], cwd=self.place("."), env=variables)


def machine() -> dict[str, str]:
    """Environment of this machine, without what belongs to this run of the tests."""
    own = re.compile("HPN_|PYTEST|VIRTUAL_ENV|MAKE|MFLAGS|PYTHONPATH|FOR$")
    return {name: value for name, value in os.environ.items() if not own.match(name)}


def instructions(dockerfile: Path) -> Iterator[tuple[str, str]]:
    """Instructions and their arguments."""
    text = re.sub(r"^#.*\n", "", dockerfile.read_text(), flags=re.M).replace("\\\n", " ")
    for line in text.splitlines():
        if line.strip():
            name, _, rest = line.strip().partition(" ")
            yield name, rest.strip()


def build(dockerfile: Path, context: Path, folder: Path) -> Image:
    """Build the last stage in `folder`."""
    stages: dict[str, Image] = {}
    image, name = Image(folder / "root"), ""
    for instruction, rest in instructions(dockerfile):
        if instruction == "FROM":
            if name:
                stages[name] = image
                image.root = image.root.rename(folder / name)
            image, name = Image(folder / "root"), rest.partition(" AS ")[2] or "final"
            image.root.mkdir()
        elif instruction == "WORKDIR":
            image.folder = rest
            image.place(".").mkdir(parents=True, exist_ok=True)
        elif instruction == "COPY":
            _copy(image, rest, stages, context)
        elif instruction == "RUN":
            _run(image, rest)
        elif instruction == "ENV":
            _set(image, rest)
        elif instruction in OF_THE_ENGINE:
            image.settings[instruction] = rest
        else:
            raise ValueError(f"no such step is known here: {instruction}")
    return image


def _set(image: Image, rest: str) -> None:
    for word in shlex.split(rest):
        name, _, value = word.partition("=")
        inherited = image.environment.get(name, os.environ.get(name, ""))
        here = re.sub(r"/(app|data)\b", lambda path: f"{image.root}{path[0]}", value)
        image.environment[name] = here.replace(f"${name}", inherited)


def _run(image: Image, command: str) -> None:
    if any(change in command for change in CHANGES_THE_SYSTEM):
        image.skipped.append(command)
        return
    environment = machine() | image.environment
    subprocess.run(["sh", "-c", command], cwd=image.place("."), env=environment, check=True)


def _copy(image: Image, rest: str, stages: dict[str, Image], context: Path) -> None:
    words = rest.split()
    *sources, target = [word for word in words if not word.startswith("--from=")]
    stage = next((stages[word.removeprefix("--from=")] for word in words if word.startswith("--from=")), None)
    goal = image.place(target)
    for source in sources:
        if stage is not None:
            shutil.copytree(stage.place(source), goal, symlinks=True, copy_function=os.link, dirs_exist_ok=True)
            continue
        result = sorted(path for path in context.glob(source) if not _ignored(path, context))
        assert result, f"the context has no {source}"
        for path in result:
            _copy_from_context(path, goal / path.name if target.endswith("/") else goal, context)


def _copy_from_context(source: Path, goal: Path, context: Path) -> None:
    if source.is_file():
        goal.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(source, goal)
        return
    for path in source.iterdir():
        if not _ignored(path, context):
            _copy_from_context(path, goal / path.name, context)


def _ignored(path: Path, context: Path) -> bool:
    """True where .dockerignore keeps a file from the engine: its last matching line decides."""
    relative = path.relative_to(context)
    parents = [str(relative), *map(str, relative.parents)][:-1]
    ignored = False
    for line in (context / ".dockerignore").read_text().split():
        pattern = line.removeprefix("!")
        names = relative.parts if pattern.startswith("**/") else parents
        if any(fnmatch(name, pattern.removeprefix("**/")) for name in names):
            ignored = not line.startswith("!")
    return ignored
