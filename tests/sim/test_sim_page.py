"""The tables of docs/simulator.md are those that the code makes."""

from dataclasses import fields
from pathlib import Path

from cityx.sim.reference import renewed, world_table
from cityx.sim.world import World

PAGE = Path(__file__).parents[2] / "docs" / "simulator.md"


def test_the_page_has_the_tables_of_the_code():
    page = PAGE.read_text()
    # Renew it by: PAGE.write_text(renewed(page))
    assert renewed(page) == page


def test_every_array_of_a_world_is_in_the_table():
    table = world_table()
    assert [each.name for each in fields(World) if f"| `{each.name}` |" not in table] == []
