"""A package that is wrong gives one clear sentence and harms no other."""

import os

import pytest
from strangers import built, cityx, failed_checks, put_package, run_python

HEAD = """
from cityx.city import MeshBatch
from cityx.protocol.plugged import generator
from cityx.protocol.solid_blocks import block
from cityx.protocol.values import Footprint

@generator("building/{name}-v1")
def {name}(footprint{kind}) -> MeshBatch:
    '''Raise it.

    Parameters
    ----------
    footprint
        Outline.
    '''
"""
UNTYPED = HEAD.format(name="untyped", kind="")
WIDE = (
    HEAD.format(name="wide", kind=": Footprint")
    + """
    grow = 3.0 if footprint.polygon.area > 400 else 0.0
    ring = footprint.polygon.buffer(grow, join_style="mitre").exterior.coords[:-1]
    return block(ring, 9.0)
"""
)
TWICE = """
from cityx.outputs.format import Format
glb = Format('glb', 'my.glb', print)
not_one = 7
"""
# What is wrong, and what is said of it.
SENTENCES = (
    "Action building/untyped-v1 of package cityx-untyped cannot be loaded from untyped:untyped: "
    "Action building/untyped-v1: parameter footprint has no annotation.",
    "Action building/broken-v1 of package cityx-broken cannot be loaded from broken:broken: "
    "RuntimeError: no licence",
    "Action building/church-v1 is registered twice, by cityx and cityx-twice.",
)


def generator_package(folder, name, text):
    entries = {"cityx.actions": {f"building/{name}-v1": f"{name}:{name}"}}
    return put_package(folder, f"cityx-{name}", {f"{name}.py": text}, entries)


@pytest.fixture(scope="module")
def troubled(tmp_path_factory):
    folder = tmp_path_factory.mktemp("troubled")
    generator_package(folder, "untyped", UNTYPED)
    generator_package(folder, "broken", "raise RuntimeError('no licence')")
    entries = {
        "cityx.formats": {"glb": "twice:glb", "not_one": "twice:not_one"},
        "cityx.actions": {"building/church-v1": "twice:church"},
    }
    return put_package(folder, "cityx-twice", {"twice.py": TWICE}, entries)


def test_a_city_is_built_as_without_them_and_the_report_says_why(troubled, nobody, town, tmp_path):
    report = built(troubled, town, tmp_path / "bad", "--lod", 1)
    assert report["hash"] == built(nobody, town, tmp_path / "good", "--lod", 1)["hash"]
    said = [note for note in report["notes"] if "building/" in note]
    assert sorted(said) == sorted(SENTENCES)


def test_an_unknown_format_names_what_is_wrong_with_those_of_packages(troubled, town, tmp_path):
    words = ("build", town, "-o", tmp_path / "out", "--formats", "gltf")
    code, _, wrong = run_python(troubled, "-m", "cityx.cli", *words)
    assert code == 2
    assert 'There is no format "gltf"' in wrong
    assert 'the name "glb" is taken by CityX' in wrong
    assert "it is no cityx.outputs.format.Format" in wrong
    assert "Traceback" not in wrong


def test_an_action_that_cannot_be_loaded_says_so_when_asked_for(troubled, town, tmp_path):
    words = ("build", town, "-o", tmp_path / "out", "--do", "building/broken-v1")
    code, _, wrong = run_python(troubled, "-m", "cityx.cli", *words)
    assert code == 2
    assert wrong.count("no licence") == 1
    assert "Traceback" not in wrong


def test_a_mesh_that_does_not_fit_leaves_the_building_to_another(town, tmp_path):
    site = tmp_path / "site"
    site.mkdir()
    folder = generator_package(site, "wide", WIDE)
    report = built(folder, town, tmp_path / "out", "--lod", 1, "--do", "building/wide-v1")
    assert [failure["action"] for failure in report["failures"]] == ["building/wide-v1"] * 2
    assert "beyond its footprint" in report["failures"][0]["error"]
    assert report["generators"]["wide"]["buildings"] == 2
    assert failed_checks(report) == {}


def test_help_imports_no_package(troubled):
    code = """
import sys
from cityx.cli.main import main
sys.argv = ["cityx", "--help"]
try:
    main()
except SystemExit:
    print("imported:", sorted({"twice", "broken", "untyped"} & set(sys.modules)))
"""
    assert run_python(troubled, "-c", code)[1].rstrip().endswith("imported: []")


def test_a_listing_names_them_and_shows_the_good_ones(troubled, tmp_path, monkeypatch):
    monkeypatch.setenv("COLUMNS", "240")
    generator_package(tmp_path, "wide", WIDE)
    listed = cityx(os.pathsep.join([str(troubled), str(tmp_path)]), "plugins", "list")
    lines = [" ".join(line.split()) for line in listed.splitlines()]
    for name in ("untyped", "broken"):
        assert f"building/{name}-v1 cannot be loaded, see below; from cityx-{name}" in lines
    assert "building/wide-v1 from cityx-wide. Raise it." in lines
    assert sorted(line for line in lines if line in SENTENCES) == sorted(SENTENCES)


def test_a_module_that_ends_the_program_ends_no_listing(tmp_path):
    generator_package(tmp_path, "quitter", "raise SystemExit(5)")
    listed = cityx(tmp_path, "plugins", "list")
    assert "cannot be loaded from quitter:quitter: SystemExit: 5" in " ".join(listed.split())
