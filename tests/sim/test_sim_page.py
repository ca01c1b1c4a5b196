"""The tables of the simulator's pages are those that the code makes."""

from dataclasses import fields
from pathlib import Path

import pytest

from cityx.sim.reference import renewed, world_table
from cityx.sim.world import World

DOCS = Path(__file__).parents[2] / "docs"


@pytest.mark.parametrize("name", ["simulator", "simulator_tasks", "simulator_sensors"])
def test_the_page_has_the_tables_of_the_code(name):
    page = (DOCS / f"{name}.md").read_text()
    # Renew it by writing renewed(page).
    assert "<!-- begin" in page
    assert renewed(page) == page


def test_every_array_of_a_world_is_in_the_table():
    table = world_table()
    assert [each.name for each in fields(World) if f"| `{each.name}` |" not in table] == []
