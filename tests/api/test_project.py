import gc
import inspect
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import cityx

TALL = "make the two tallest buildings 40 m tall"


def test_the_package_imports_nothing_heavy():
    code = (
        "import sys, os; import cityx; cityx.UsageError, cityx.BuildOptions; used = os.times();"
        "print(used.user + used.system, [m for m in ('bpy', 'numpy', 'typer') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    seconds, modules = done.stdout.split(" ", 1)
    assert float(seconds) < 0.3
    assert modules.strip() == "[]"


def test_signatures_name_every_option():
    shown = inspect.signature(cityx.build).parameters
    assert {"inputs", "out", "lod", "size", "pixel", "planner", "settings"} <= set(shown)
    assert (shown["lod"].default, shown["render"].default) == (2, False)
    assert list(inspect.signature(cityx.Project.render).parameters)[:4] == [
        "self", "camera", "progress", "samples",
    ]  # fmt: skip


def test_every_exported_name_leads_somewhere():
    assert set(cityx.__all__) <= set(dir(cityx))
    assert all(getattr(cityx, name) is not None for name in cityx.__all__)
    with pytest.raises(AttributeError, match="'cityx' has no attribute 'bulid'"):
        cityx.bulid  # noqa: B018


def test_five_lines_build_edit_measure_plot_and_export(town_map, tmp_path):
    pyplot = pytest.importorskip("matplotlib.pyplot")
    pyplot.switch_backend("Agg")
    city = cityx.build(town_map, "in heavy rain", lod=0)
    revision = city.edit(TALL)
    assert city.measure("n(building, height >= 39) == 2").met
    assert city.buildings.to_crs(4326).plot().has_data()
    path = city.export("glb", tmp_path / "town.glb")
    assert path.read_bytes()[:4] == b"glTF"
    assert (city.folder, revision.number, city.revision) == (None, 2, 2)
    assert city.city.environment.weather == "rain"


def test_in_memory_and_on_disk_the_city_is_the_same(held, town_map, tmp_path):
    there = cityx.build(town_map, lod=1, seed=5, out=tmp_path / "town")
    assert there.hash == held.hash
    assert there.folder == tmp_path / "town"
    assert cityx.open(tmp_path / "town").hash == held.hash
    assert not list((tmp_path / "town").glob("city.*"))


def test_what_is_held_in_memory_goes_with_the_project(town_map):
    project = cityx.build(town_map, lod=0)
    folder, city = project._folder, project.city
    assert folder.exists()
    del project
    gc.collect()
    assert not folder.parent.exists()
    assert len(city.layout.buildings) == 11
    assert city.ground.vertices.sum() == city.ground.vertices.sum()


def test_a_build_that_fails_leaves_nothing(monkeypatch, tmp_path):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    with pytest.raises(cityx.InputError, match=r"lost\.osm does not exist"):
        cityx.build("lost.osm")
    assert not list(tmp_path.iterdir())


def test_saving_puts_the_city_with_its_past_into_a_folder(town_map, tmp_path):
    project = cityx.build(town_map, lod=0)
    private, first = project._folder, project.hash
    project.edit(TALL)
    assert project.save(tmp_path / "kept") == project.folder == tmp_path / "kept"
    assert not private.parent.exists()
    assert project.undo().content == first
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "letter.txt").write_text("mine")
    with pytest.raises(cityx.UsageError, match="full holds other files; give a new folder"):
        project.save(tmp_path / "full")


def test_every_change_is_a_revision_that_can_be_undone(own):
    first = own.hash
    changed = own.edit(TALL)
    done = own.do("edit/remove", objects=own.buildings.index[:1])
    assert [item.number for item in own.revisions] == [1, 2, 3]
    assert (changed.text, done.actions) == (TALL, ("edit/remove-v1",))
    assert len(own.buildings) == 10
    assert own.undo().content == changed.content == own.hash
    assert own.redo().content == done.content
    assert own.undo(1).content == first
    assert len(own.buildings) == 11


def test_ids_of_tables_name_things_as_they_are(own):
    house = own.buildings.index[0]
    own.do("edit/set_height", objects=[house], height=np.float64(31.0))
    assert own.buildings["height"][house] == 31.0
    assert own.city.layout.buildings["height"].max() == 31.0


def test_an_edit_tells_whether_all_else_is_the_same(own):
    own.edit(TALL)
    goals = {goal["goal"]: goal for goal in own.report["goals_of_change"]}
    assert goals["nothing else changes"]["met"] is True
    assert goals["nothing else changes"]["evidence"] == "0 other objects changed"


def test_the_tallest_building_is_the_one_that_was_tallest_when_it_was_named(own):
    own.edit("make the tallest building 4 m tall")
    assert [goal["met"] for goal in own.report["goals_of_change"]] == [True, True]
    assert own.buildings["height"].max() > 4.4


def test_what_no_word_selects_is_measured_by_the_objects_that_were_meant(own):
    own.edit("delete three buildings")
    assert len(own.buildings) == 8
    assert all(goal["met"] for goal in own.report["goals_of_change"])


def test_another_state_is_compared_with_by_its_number(own):
    own.do("edit/remove", objects=own.buildings.index[:1])
    assert own.measure("gained(building) == -1", since=1).met
    assert own.measure("gained(building) == 0", since=2).met
    assert own.measure("gained(building) == 0").met is None
    with pytest.raises(cityx.UsageError, match="There is no revision 9; they are 1, 2"):
        own.measure("gained(building) == 0", since=9)


def test_another_process_is_seen(own):
    other = cityx.open(own.folder)
    assert own.measure("n(building, height >= 39) == 0").met
    other.edit(TALL)
    assert own.measure("n(building, height >= 39) == 2").met


def test_what_is_left_open_is_a_question_and_changes_nothing(own):
    first = own.hash
    with pytest.raises(cityx.Clarify, match="What should"):
        own.edit("make the buildings")
    assert (own.hash, own.revision) == (first, 1)


def test_checks_come_as_a_table(own):
    checks = own.check()
    assert set(own.report["checks"]) == set(checks.index)
    assert checks["ok"].tolist() == [item["ok"] for item in own.report["checks"].values()]


def test_a_camera_and_options_reach_blender(own, monkeypatch):
    from cityx.projects import views

    asked = []

    def rendered(folder, options, **_):
        asked.append(options)
        return [folder / "a.png"]

    monkeypatch.setattr(views, "render_views", rendered)
    pictures = own.render("aerial", size="320x200", samples=4, weather="fog")
    assert asked == [cityx.RenderOptions("aerial", 4, (320, 200), weather="fog")]
    assert pictures.path == own.folder / "a.png"
    pictures.path.write_bytes(b"\x89PNG")
    assert "data:image/png;base64,iVBORw==" in pictures._repr_html_()


@pytest.mark.parametrize(("name", "file"), [("glb", "city.glb"), ("bodies", "city_bodies.npz")])
def test_exports_go_to_a_file_a_folder_or_the_project(own, tmp_path, name, file):
    assert own.export(name) == own.folder / file
    assert own.export(name, tmp_path) == tmp_path / file
    assert own.export(name, tmp_path / "new" / f"mine{Path(file).suffix}").is_file()


@pytest.mark.slow
def test_a_dataset_of_the_city_is_made(own, tmp_path):
    told = []
    summary = own.dataset(tmp_path / "shots", views=1, size=(32, 24), channels=["depth"],
                          formats=["raw"], progress=told.append)  # fmt: skip
    assert summary.total == 1
    assert told
    record = json.loads((tmp_path / "shots" / "dataset.json").read_text())
    assert record["order"]["size"] == [32, 24]


def test_explaining_runs_nothing_and_prints_lines():
    found = cityx.explain("a small town in fog")
    assert ["weather", "fog"] in found["asked"]
    assert repr(found).splitlines()[0] == "asked for"


def test_sentences_and_files_are_told_apart(town_map):
    from cityx.projects.inputs import files_and_text

    words = [str(town_map), "in heavy rain", Path("no suffix"), "at dusk", "map.osm"]
    assert files_and_text(words) == (
        [town_map, Path("no suffix"), Path("map.osm")], "in heavy rain at dusk",
    )  # fmt: skip


def test_a_dozen_lines_and_a_plan_say_what_it_is(held):
    lines = repr(held).splitlines()
    assert len(lines) <= 14
    assert max(map(len, lines)) < 100
    assert "buildings   11, up to " in repr(held)
    assert len(repr(held.city).splitlines()) <= 12
    page = held._repr_html_()
    assert "<svg" in page
    assert "data:image/jpeg;base64," in page
    assert "Project in memory" in page


@pytest.mark.parametrize(
    ("call", "error", "said"),
    [
        (lambda p: cityx.open(p.folder.parent / "twn"), cityx.InputError,
         'twn is no folder. Did you mean "town"?'),
        (lambda p: cityx.open(p.folder.parent), cityx.InputError, "holds no city"),
        (lambda p: p.render("stret"), cityx.UsageError, 'Did you mean "street"?'),
        (lambda p: p.export("gbl"), cityx.UsageError,
         'There is no format "gbl". Did you mean "glb"'),
        (lambda p: p.do("edit/set_hight"), cityx.UsageError, 'Did you mean "edit/set_height"'),
        (lambda p: p.do("edit/remove", objcts=[1]), cityx.UsageError,
         'edit/remove-v1 has no parameter "objcts". Did you mean "objects"?'),
        (lambda p: p.edit(TALL, plannr="x"), cityx.UsageError, 'Did you mean "planner"'),
        (lambda p: p.measure("n(bilding) == 3"), cityx.UsageError, 'Did you mean "building"'),
        (lambda p: p.layer("tres"), cityx.UsageError, 'There is no layer "tres". Did you mean'),
        (lambda p: p.dataset(p.folder / "d", plan="stret"), cityx.UsageError,
         'there is no plan "stret"'),
        (lambda p: p.render(size=(1, 1)), cityx.UsageError,
         "size (1, 1) is outside 16x16 to 16384x16384."),
        (lambda _: cityx.build(lod=7), cityx.UsageError, "lod is 7; it takes 0 to 3."),
        (lambda _: cityx.build(lod="2"), cityx.UsageError,
         "lod is '2'; it takes a whole number."),
        (lambda _: cityx.build(siez=(1, 2)), cityx.UsageError,
         'There is no option "siez". Did you mean "size"'),
        (lambda _: cityx.build(size=(300,)), cityx.UsageError,
         "size is (300,); write numbers such as (800.0, 600.0)."),
        (lambda _: cityx.build(formats=("obj",)), cityx.UsageError,
         'There is no format "obj". Known are'),
    ],
)  # fmt: skip
def test_bad_input_is_told_in_a_sentence(own, call, error, said):
    first = own.hash
    with pytest.raises(error) as caught:
        call(own)
    assert said in str(caught.value)
    assert own.hash == first


def test_without_the_libraries_of_notebooks_the_extra_is_named(held, monkeypatch):
    for name in ("folium", "matplotlib"):
        monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(cityx.MissingDependency, match=r'pip install "cityx\[notebook\]"'):
        held.plot()
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    with pytest.raises(cityx.MissingDependency, match="needs folium"):
        held.explore()
