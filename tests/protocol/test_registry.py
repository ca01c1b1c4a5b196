import subprocess
import sys
import time

import pytest

from cityx.errors import UsageError
from cityx.protocol import Registry, action, registry
from cityx.protocol.registry import Entry, outside_entries, scan

TWO = '''
from cityx.protocol import action
ID = "road/two-v2"

@action(ID, limits=["x"], classname="Two_roads")
def two(city):
    """Make
    two roads.

    And more.
    """

@action("road/two-v1", limits=["x"])
def older(city):
    """Make two."""
raise RuntimeError("a listed plugin is never run")
'''


def test_actions_are_found_in_source_without_running_it(tmp_path):
    path = tmp_path / "two.py"
    path.write_text(TWO)
    assert list(scan(path, tmp_path)) == [
        Entry("road/two-v2", "two:two", "Two_roads", "Make two roads."),
        Entry("road/two-v1", "two:older", "two", "Make two."),
    ]


def test_the_action_of_a_generator_is_found_by_the_docstring_of_its_volumes(tmp_path):
    path = tmp_path / "kiosk.py"
    path.write_text(
        'def masses(plot):\n    """Build kiosks."""\n\n'
        'GENERATOR = generator(masses)\nkiosk = action_of("building/kiosk-v1", GENERATOR, masses)\n'
    )
    assert list(scan(path, tmp_path)) == [
        Entry("building/kiosk-v1", "kiosk:kiosk", "kiosk", "Build kiosks."),
    ]


def test_listing_imports_no_plugin():
    code = (
        "import sys; from cityx.cli.plugins import list_actions; list_actions();"
        "print([m for m in sys.modules if m.startswith('cityx.road.')"
        " or m in ('shapely', 'pandas', 'bpy')])"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"


def test_the_version_may_be_left_out_and_the_newest_is_meant():
    made = Registry()
    for number in (2, 10, 9):
        made.put(Entry(f"road/two-v{number}", "m:f", "two"))
    assert made.resolve("road/two") == "road/two-v10"
    assert made.resolve("two") == "road/two-v10"
    assert made.resolve("road/two-v2") == "road/two-v2"


def test_a_name_that_may_be_two_actions_is_refused():
    made = Registry()
    made.put(Entry("road/wall-v1", "m:f", "wall"))
    made.put(Entry("building/wall-v1", "m:g", "wall"))
    with pytest.raises(UsageError) as caught:
        made.resolve("wall")
    assert str(caught.value) == '"wall" may be building/wall-v1 or road/wall-v1; write the id.'


def test_an_unknown_name_shows_the_near_ones():
    with pytest.raises(UsageError) as caught:
        registry(outside=False).resolve("Point_to_face_convertion")
    assert str(caught.value).startswith(
        'There is no action "Point_to_face_convertion". Did you mean "Point_to_face_conversion"'
    )


def test_one_id_cannot_come_from_two_packages():
    made = Registry()
    made.put(Entry("road/two-v1", "a:f", "two"))
    with pytest.raises(UsageError) as caught:
        made.put(Entry("road/two-v1", "b:f", "two", "", "other"))
    assert str(caught.value) == "Action road/two-v1 is registered twice, by cityx and other."


def test_an_entry_that_leads_nowhere_is_named():
    made = Registry()
    made.put(Entry("road/two-v1", "no_such_module:f", "two", "", "other"))
    with pytest.raises(UsageError, match=r"Action road/two-v1 of package other cannot be loaded"):
        made.function("road/two-v1")


def test_counts_are_per_stage():
    made = Registry()
    made.put(Entry("road/two-v1", "a:f", "two"))
    made.put(Entry("road/three-v1", "a:g", "three"))
    made.put(Entry("nature/moss-v1", "a:h", "moss"))
    assert made.counts() == {"nature": 1, "road": 2}


def _install(folder, package, lines):
    info = folder / f"{package}-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[cityx.actions]\n" + "\n".join(lines) + "\n")


def test_ten_thousand_plugins_are_listed_within_five_seconds(tmp_path, monkeypatch):
    for package in range(1000):
        lines = [f"building/dummy_{package}_{i}-v1 = dummy_{package}:f{i}" for i in range(10)]
        _install(tmp_path, f"dummy{package}", lines)
    monkeypatch.syspath_prepend(str(tmp_path))
    begin = time.process_time()
    made = registry()
    from cityx.cli.plugins import list_actions

    tables = [part for part in list_actions(made).renderables if not isinstance(part, str)]
    assert time.process_time() - begin < 5
    assert len([i for i in made if "/dummy_" in i]) == 10_000
    assert sum(table.row_count for table in tables) == len(made)
    assert made.entry("building/dummy_7_3-v1").package == "dummy7"


def test_a_package_with_a_bad_id_is_named(tmp_path, monkeypatch):
    _install(tmp_path, "careless", ["Tower = tower:tower"])
    monkeypatch.syspath_prepend(str(tmp_path))
    assert "Tower" in [entry.id for entry in outside_entries()]
    made = registry()
    assert made.refused == [
        'Package careless registers "Tower", which is not of the form "stage/name-vN".'
    ]
    assert "Cube_generation" in made


def test_an_action_of_another_package_that_cannot_be_loaded_stops_no_other(tmp_path, monkeypatch):
    _install(tmp_path, "broken", ["convert/broken-v1 = no_such_module:f"])
    monkeypatch.syspath_prepend(str(tmp_path))
    made = registry()
    names = [record.classname for record in made.records("convert")]
    assert "Cube_generation" in names
    assert "broken" not in names
    assert made.refused[0].startswith("Action convert/broken-v1 of package broken cannot be loaded")


def test_functions_can_be_registered_by_hand():
    @action("edit/nothing-v1", limits=["Does nothing."])
    def nothing(city: "City") -> "City":  # noqa: F821
        """Do nothing."""
        return city

    made = Registry.of([nothing])
    assert made.function("nothing") is nothing
    assert "edit/nothing-v1" in made
    assert len(made) == 1
