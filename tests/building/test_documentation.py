"""The tables in docs/buildings.md are those that the code makes."""

from __future__ import annotations

import runpy
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_the_tables_of_the_generators_are_current():
    table = runpy.run_path(str(ROOT / "examples" / "buildings" / "table.py"))
    page = (ROOT / "docs" / "buildings.md").read_text()
    assert table["written"](page) == page, (
        "renew them: python examples/buildings/table.py --write docs/buildings.md"
    )
