"""The Khronos validator on many files at once; `make validator` brings it."""

import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest

SCRIPT = """
const validator = require(process.argv[1]);
const read = (path) => new Uint8Array(require('fs').readFileSync(path));
(async () => {
  const found = [];
  for (const path of process.argv.slice(2)) {
    const report = await validator.validateBytes(read(path));
    const errors = report.issues.messages.filter((item) => item.severity === 0);
    for (const item of errors) found.push([path, item.code, item.pointer]);
  }
  console.log(JSON.stringify(found));
})();
"""


def errors_of(paths):
    """Every error in some GLBs: file, code and place."""
    root = Path(__file__).parents[2] / "node_modules" / "gltf-validator"
    folder = Path(os.environ.get("GLTF_VALIDATOR_DIR", root))
    if shutil.which("node") is None or not (folder / "package.json").is_file():
        pytest.skip("node or its package gltf-validator is missing; run: make validator")
    command = ["node", "-e", SCRIPT, str(folder), *map(str, paths)]
    answer = subprocess.run(command, capture_output=True, text=True, timeout=300, check=True)
    return json.loads(answer.stdout)
