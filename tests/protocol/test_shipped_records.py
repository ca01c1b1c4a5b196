import os
import subprocess
import sys

import pytest

from cityx.protocol import registry, shipped
from cityx.protocol.records import written_records
from cityx.protocol.shipped import face, fresh_records
from cityx.system import tables

PLUGIN = '''from words import WORDS

MOST = 4

@action("road/two-v1", limits=["x"])
def two(
    city: City,
    *,
    count: Annotated[int, Range(1, MOST)] = 2,
) -> City:
    """Make two roads."""
    made = count * 2

    return city


def helper() -> int:
    return 7


LAST = 1
'''


def test_generated_records_are_those_of_the_actions_and_fresh(tmp_path, monkeypatch):
    text = written_records()
    assert text == written_records()
    monkeypatch.setattr(shipped, "HELD", tmp_path / "records.json")
    (tmp_path / "records.json").write_text(text)
    shipped.fresh_records.cache_clear()
    held = {record["id"] for records in fresh_records().values() for record in records}
    shipped.fresh_records.cache_clear()
    assert held == set(registry(outside=False))


def test_a_face_keeps_what_records_are_read_from():
    seen = face(PLUGIN)
    for part in ("MOST = 4", "Range(1, MOST)", '"""Make two roads."""', "limits", "LAST = 1"):
        assert part in seen
    assert "count * 2" not in seen
    assert "return 7" not in seen


@pytest.mark.parametrize(
    ("was", "becomes", "same"),
    [
        ("count * 2", "count * 3", True),
        ("return 7", "return 8", True),
        ("MOST = 4", "MOST = 5", False),
        ("two roads", "three roads", False),
        ("= 2,", "= 3,", False),
        ("LAST = 1", "LAST = 2", False),
    ],
)
def test_only_what_stands_outside_of_bodies_changes_a_face(was, becomes, same):
    assert (face(PLUGIN) == face(PLUGIN.replace(was, becomes))) is same


@pytest.fixture
def package(tmp_path, monkeypatch):
    """A copy of the package's sources that a test may change."""
    for path in [*shipped.PACKAGE.rglob("*.py"), *tables.files_of()]:
        copy = tmp_path / "cityx" / path.relative_to(shipped.PACKAGE)
        copy.parent.mkdir(parents=True, exist_ok=True)
        copy.write_bytes(path.read_bytes())
    monkeypatch.setattr(shipped, "PACKAGE", tmp_path / "cityx")
    monkeypatch.setattr(tables, "DATA", tmp_path / "cityx" / "data")
    caches = (fresh_records, shipped.form, shipped._face_of)
    for held in caches:
        held.cache_clear()
    yield tmp_path / "cityx"
    for held in caches:
        held.cache_clear()


def test_a_plugin_whose_face_changed_is_read_anew_and_no_other(package):
    path = package / "edit" / "air.py"
    path.write_text(path.read_text() + "\nMORE = 1\n")
    held = shipped.fresh_records()
    assert "cityx.edit.air" not in held
    assert "cityx.edit.moment" in held


def test_a_table_of_words_elsewhere_makes_the_plugins_that_use_it_be_read_anew(package):
    path = package / "assets" / "styles" / "palette_tables.py"
    path.write_text(path.read_text() + "\nMORE = 1\n")
    held = shipped.fresh_records()
    assert "cityx.edit.buildings.set_material" not in held
    assert "cityx.edit.moment" in held


def test_another_form_of_records_makes_all_be_read_anew(package):
    path = package / "protocol" / "parameters.py"
    path.write_text(path.read_text() + "\n")
    assert not shipped.fresh_records()


@pytest.mark.parametrize(
    "place", ["data/generators/church.toml", "building/generators/__init__.py"]
)
def test_the_record_of_a_generator_follows_its_table_and_how_it_is_derived(package, place):
    assert "cityx.building.generators.civic.church" in shipped.fresh_records()
    fresh_records.cache_clear()
    path = package / place
    path.write_text(path.read_text() + "\n")
    assert "cityx.building.generators.civic.church" not in shipped.fresh_records()
    assert "cityx.building.design" in shipped.fresh_records()


def test_a_first_start_plans_without_importing_the_generators():
    code = (
        "import sys; from cityx.agents.explain import explain; explain('A modern town.');"
        "print([m for m in ('geopandas', 'pandas', 'scipy', 'cityx.building.shell')"
        " if m in sys.modules])"
    )
    run = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True,
        env={**os.environ, "CITYX_CACHE": ""},
    )  # fmt: skip
    assert run.stdout.strip() == "[]"
