"""Check of hatchling's build: a package without the page's files would serve pages without styles."""

from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class BuiltAssets(BuildHookInterface):  # type: ignore[misc]  # hatchling stands beside the environment
    """Ends a build that lacks what `make assets` writes; an editable install reads the folders of its checkout."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """End with a sentence where the manifest is missing."""
        if version != "editable" and not (Path(self.root) / "frontend/dist/manifest.json").is_file():
            raise SystemExit("frontend/dist has no assets of the page to put into the package: run `make assets` first")
