import importlib
import json

import pytest
from rich.console import Console

from cityx.cli import plugins as commands
from cityx.errors import UsageError
from cityx.protocol.registry import registry, scan
from cityx.protocol.scaffold import write_scaffold


def test_the_list_fits_eighty_columns_and_names_every_action():
    console = Console(width=80)
    with console.capture() as capture:
        console.print(commands.list_actions(), markup=False)
    lines = capture.get().splitlines()
    assert max(map(len, lines)) <= 80
    named = {line.split()[0] for line in lines if line}
    assert set(registry(outside=False)) <= named


def test_all_records_come_as_json(capsys):
    commands.list_(as_json=True)
    records = {record["id"]: record for record in json.loads(capsys.readouterr().out)}
    assert set(records) >= set(registry(outside=False))
    assert records["road/network-v1"] == registry()["road/network-v1"].document()


def test_list_shows_the_number_of_actions_per_stage():
    console = Console(width=200)
    with console.capture() as capture:
        console.print(commands.list_actions())
    assert "convert/point_to_face_conversion-v1" in capture.get()
    assert "convert (" in capture.get()


def test_show_scale_object_is_the_papers_document_as_valid_json():
    record = registry()["scale_object"].document()
    assert record["name"] == "scale_object"
    assert record["description"] == "Scale an object."
    factor, name = (record["parameters"][p] for p in ("scale_factor", "scaled_obj_name"))
    assert (factor["type"], factor["minItems"], factor["maxItems"]) == ("array", 3, 3)
    assert factor["items"]["type"] == "number"
    assert factor["description"] == "scale factor"
    assert (name["type"], name["description"]) == ("string", "scaled object name")
    assert record["run"] == "cityx.edit.objects.scale_object:scale_object"
    assert record["limitation"].startswith("The object keeps its place")
    assert record["input_formats"] == {"object": "complex_geometry"}
    assert record["output_formats"] == {"object": "complex_geometry"}


def test_check_reports_one_line_per_action():
    text, passed = commands.check_actions("Cube_generation")
    assert passed
    assert text.startswith("ok   convert/cube_generation-v1\n")


def test_statistics_show_ours_beside_the_papers():
    console = Console(width=160)
    with console.capture() as capture:
        console.print(commands.format_statistics())
    assert "36.04" in capture.get()
    assert "Geographic Information Data" in capture.get()


@pytest.mark.parametrize(
    "action_id", ["building/bell_tower-v1", "nature/moss-v1", "convert/shrink-v2"]
)
def test_the_scaffold_passes_its_own_test(tmp_path, monkeypatch, action_id):
    module, project, test = write_scaffold(action_id, tmp_path)
    assert project.name == "pyproject.toml"
    monkeypatch.syspath_prepend(str(tmp_path))
    checks = importlib.import_module(test.stem)
    getattr(checks, f"{test.stem}_conforms")()
    entry = next(scan(module, tmp_path))
    assert entry.id == action_id
    assert f'"{entry.id}" = "{entry.run}"' in project.read_text()


def test_the_scaffold_overwrites_nothing(tmp_path):
    write_scaffold("nature/moss-v1", tmp_path)
    with pytest.raises(UsageError, match=r"holds moss\.py, pyproject\.toml, test_moss\.py already"):
        write_scaffold("nature/moss-v1", tmp_path)


def test_a_bad_id_is_refused(tmp_path):
    with pytest.raises(UsageError) as caught:
        write_scaffold("Tower", tmp_path)
    assert str(caught.value) == (
        '"Tower" is not of the form "stage/name-vN", such as "building/bell_tower-v1".'
    )
