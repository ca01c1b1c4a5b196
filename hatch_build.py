"""Build hook: generate the records of all actions, by which the first start imports none."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class RecordsHook(BuildHookInterface[Any]):
    """Run `cityx.protocol.records` where the package's dependencies are installed."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:  # noqa: ARG002
        """Write records.json; a build without the dependencies leaves it to the first start."""
        command = [sys.executable, "-m", "cityx.protocol.records"]
        done = subprocess.run(command, cwd=self.root, capture_output=True, text=True, check=False)
        if done.returncode and version != "editable":
            self.app.display_warning(
                "records.json is not generated, since CityX's dependencies are not installed in "
                "the build environment: the first start will read the actions themselves. "
                "Build with `make wheel` to include it."
            )
