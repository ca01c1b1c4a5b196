import json
from dataclasses import replace

import numpy as np
import pytest

from cityx.assets.styles.materials import MATERIALS
from cityx.city import Frame
from cityx.city.levels import ground_levels
from cityx.convert.layouts import (
    geographic_to_layout_conversion,
    layout_to_geographic_conversion,
)
from cityx.convert.retrieval import (
    asset_material_retrieval,
    asset_mesh_retrieval,
    asset_placement,
    osm_file_retrieval,
    scene_object_information_extraction,
    texture_information_extraction,
)
from cityx.edit.objects.scale_object import scale_object
from cityx.errors import ActionFailed
from cityx.protocol import InputFiles, registry
from cityx.protocol.example_city import example_city
from cityx.protocol.running import Call, run_step

MAP = """<osm version="0.6">
<node id="1" lat="60.1700" lon="24.9400"/><node id="2" lat="60.1700" lon="24.9404"/>
<node id="3" lat="60.1702" lon="24.9404"/><node id="4" lat="60.1702" lon="24.9400"/>
<node id="5" lat="60.1698" lon="24.9395"/><node id="6" lat="60.1698" lon="24.9410"/>
<way id="7"><nd ref="1"/><nd ref="2"/><nd ref="3"/><nd ref="4"/><nd ref="1"/>
<tag k="building" v="yes"/><tag k="height" v="12"/></way>
<way id="8"><nd ref="5"/><nd ref="6"/><tag k="highway" v="residential"/></way>
</osm>"""


@pytest.mark.parametrize(
    ("words", "name"),
    [("red brick", "brick"), ("roof tiles", "roof_tiles"), ("asphalt", "asphalt"),
     ("Grass", "grass"), ("concret", "concrete"), ("curtain wall of glass", "glass_wall")],
)  # fmt: skip
def test_words_find_their_material(words, name):
    assert asset_material_retrieval(words).name == name


def test_words_for_no_material_are_refused():
    with pytest.raises(ActionFailed, match=r'No material is like "xyzzy"\.'):
        asset_material_retrieval("xyzzy")


def test_texture_information_holds_every_number_of_the_material():
    told = json.loads(texture_information_extraction(MATERIALS["brick"]))
    assert (told["name"], told["tile"], told["texture"]) == ("brick", 2.0, "brick")


def test_a_prototype_is_found_by_name_and_another_refused():
    city = example_city(built=True)
    assert asset_mesh_retrieval(city, "tree_cone") is city.scene.prototypes[0].mesh
    with pytest.raises(ActionFailed) as caught:
        asset_mesh_retrieval(city, "tree_con")
    assert str(caught.value) == ('The scene has no prototype "tree_con". Did you mean "tree_cone"?')


def test_a_placed_asset_stands_on_the_ground_and_changes_nothing_else():
    city = example_city(built=True)
    after = asset_placement(city, asset="tree_cone", x=10.0, y=-70.0, scale=2.0)
    after = asset_placement(after, asset="tree_cone", x=12.0, y=-70.0)
    rows = after.scene.instances["placed"]
    assert rows.count == 2
    assert sorted(rows.scale[:, 0]) == [1.0, 2.0]
    ground = after.terrain.height_at(rows.position[:, :2])
    assert rows.position[:, 2] == pytest.approx(ground + 0.12)
    assert after.scene.meshes is city.scene.meshes
    assert after.scene.instances["trees"] is city.scene.instances["trees"]
    with pytest.raises(ActionFailed, match="tree_cone stands at 12, -70 already"):
        asset_placement(after, asset="tree_cone", x=12.0, y=-70.0)


def test_object_information_tells_place_and_attributes():
    told = json.loads(scene_object_information_extraction(example_city(built=True), "The Tower"))
    assert told["buildings"]["use"] == "office"
    assert told["buildings"]["bounds"] == [18.0, 14.0, 48.0, 34.0]
    mesh = told["mesh buildings"]
    assert mesh["high"][2] - mesh["low"][2] == pytest.approx(30.0)


def test_a_map_is_read_by_its_name_among_the_inputs(tmp_path):
    path = tmp_path / "town.osm"
    path.write_text(MAP)
    files = InputFiles((path,))
    data = osm_file_retrieval(files, "town.osm")
    assert {tags.get("building") for tags in data.tags} >= {"yes"}
    assert "OpenStreetMap" in data.attribution
    city = replace(example_city(), frame=Frame(60.17, 24.94))
    layout = geographic_to_layout_conversion(city, data)
    (house,) = layout.buildings.geometry
    assert (house.centroid.x, house.centroid.y) == pytest.approx((11.1, 11.1), abs=0.1)
    assert layout.buildings["height"].tolist() == [12.0]
    assert layout.roads["kind"].tolist() == ["residential"]
    assert len(osm_file_retrieval(files, "0").geometry) == len(data.geometry)
    with pytest.raises(ActionFailed) as caught:
        osm_file_retrieval(files, "../town.osm")
    assert str(caught.value) == ('No input file is called "../town.osm". Did you mean "town.osm"?')


def test_a_layout_survives_the_way_around_the_earth():
    city = replace(example_city(), frame=Frame(60.17, 24.94))
    data = layout_to_geographic_conversion(city, city.layout)
    again = geographic_to_layout_conversion(city, data)
    for name in ("buildings", "roads", "areas", "lines", "points"):
        before, after = getattr(city.layout, name), getattr(again, name)
        assert len(before) == len(after), name
        assert after.geometry.area.sum() == pytest.approx(before.geometry.area.sum(), rel=1e-3)
        assert after.geometry.length.sum() == pytest.approx(before.geometry.length.sum(), rel=1e-3)
    assert sorted(again.areas["kind"]) == ["park", "water"]
    assert sorted(again.buildings["height"]) == sorted(city.layout.buildings["height"])


def test_a_scaled_object_keeps_its_place_and_all_others_their_bytes():
    city = example_city(built=True)
    args = {"scale_factor": [1, 1, 2], "scaled_obj_name": "The Tower"}
    after = run_step(city, Call("scale_object", args), registry(outside=False))
    old, new = city.scene.meshes["buildings"], after.scene.meshes["buildings"]
    tower = int(city.layout.buildings.query("name == 'The Tower'")["id"].iloc[0])
    row = int(np.flatnonzero(old.object_id == np.uint64(tower))[0])
    first, second = old.take([row]).vertices, new.take([row]).vertices
    mine = (city.layout.parts["building"] == tower).to_numpy()
    ground = ground_levels(city.layout, city.terrain)[mine][0]
    assert second[:, 2].max() - ground == pytest.approx(2 * (first[:, 2].max() - ground))
    assert np.array_equal(first[:, :2], second[:, :2])
    assert first[:, 2].min() == second[:, 2].min()  # what stands in the ground stays
    top = after.layout.parts["top"].to_numpy()[mine][0]
    assert top == pytest.approx(2 * city.layout.parts["top"].to_numpy()[mine][0])
    assert after.layout.buildings.set_index("id").loc[tower, "height"] == pytest.approx(top)
    others = [i for i in range(old.count) if i != row]
    assert np.array_equal(old.take(others).vertices, new.take(others).vertices)
    assert after.scene.instances["trees"].count == city.scene.instances["trees"].count


def test_scaling_a_road_without_a_mesh_is_refused():
    with pytest.raises(ActionFailed, match="has no mesh and no instance in the scene yet"):
        scale_object(example_city(), scale_factor=(1, 1, 2), scaled_obj_name="Long Street")
