import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
REMOTE = re.compile(r'<(?:script|link|img)[^>]+(?:src|href)="(?:https?:)?//[^"]+"')


@pytest.mark.slow
def test_the_pages_are_built_and_load_nothing_from_the_network(tmp_path):
    pytest.importorskip("mkdocstrings_handlers.python")
    command = [sys.executable, "-m", "mkdocs", "build", "-q", "-d", tmp_path / "site"]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    pages = {page: page.read_text() for page in (tmp_path / "site").rglob("*.html")}
    assert not [found for text in pages.values() for found in REMOTE.findall(text)]
    reference = pages[tmp_path / "site" / "api" / "index.html"]
    for name in ("cityx.api.front.build", "cityx.api.project.Project.edit",
                 "cityx.api.tables.Tables.buildings", "cityx.options.BuildOptions"):  # fmt: skip
        assert f'id="{name}"' in reference
