"""Build hook: generate the records of all actions and the page of `cityx view`."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class GeneratedHook(BuildHookInterface[Any]):
    """Run `cityx.protocol.records` and `cityx.viewer.page`, each where it can be."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:  # noqa: ARG002
        """Write records.json and the page; what cannot be made is left to the first start."""
        if version == "editable":
            self._run("cityx.protocol.records")
            return
        if self._run("cityx.protocol.records").returncode:
            self.app.display_warning(
                "records.json is not generated, since CityX's dependencies are not installed in "
                "the build environment: the first start will read the actions themselves. "
                "Build with `make wheel` to include it."
            )
        done = self._run("cityx.viewer.page")
        if done.returncode:
            self.app.display_warning(
                f"The page of cityx view is not in this wheel: {done.stderr.strip()[-400:]}"
            )

    def _run(self, module: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", module]
        return subprocess.run(command, cwd=self.root, capture_output=True, text=True, check=False)
