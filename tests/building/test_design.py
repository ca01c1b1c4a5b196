import json
from dataclasses import replace

import numpy as np
import pytest
import shapely
from shapely import affinity

from cityx.building.catalogue import generators
from cityx.building.design import design
from cityx.building.generators.towers.setback_skyscraper import setback_skyscraper
from cityx.building.samples import sample_city, sheet_of
from cityx.building.selection import designs_of_parts
from cityx.errors import ActionFailed
from cityx.protocol.example_city import example_city
from cityx.sources.osm import read_osm
from tests.town import Town


def towers(**options):
    return design(sample_city(sheet_of(["setback_skyscraper"], (1, 2, 3)), **options))


def test_volumes_of_a_generator_replace_the_plain_part():
    city = towers()
    parts = city.layout.parts
    assert len(parts) > 6
    assert parts["id"].is_unique
    assert set(parts["zone"]) >= {"", "tower"}
    assert not city.failures
    top = parts.groupby("building")["top"].max()
    assert np.allclose(top.to_numpy(), city.layout.buildings["height"].to_numpy())


def test_a_mapped_footprint_stays_covered():
    city = towers()
    assert len(city.layout.buildings)
    for row in city.layout.buildings.itertuples():
        own = city.layout.parts[city.layout.parts["building"] == row.id]
        ground = shapely.union_all(own.geometry[own["base"] < 0.05].to_numpy())
        assert ground.area > 0.97 * row.geometry.area


def test_design_is_the_same_twice_and_differs_by_seed():
    first, again, other = towers(), towers(), towers(seed=4)
    assert first.layout.parts.equals(again.layout.parts)
    assert not first.layout.parts["top"].equals(other.layout.parts["top"])


def test_mapped_parts_keep_their_volumes():
    city = sample_city(sheet_of(["setback_skyscraper"], (1,)))
    parts = city.layout.parts
    import pandas as pd

    second = parts.copy()
    second["id"] = second["id"] + np.uint64(1)
    second["base"], second["top"] = 30.0, 60.0
    both = pd.concat([parts, second], ignore_index=True).sort_values("id", ignore_index=True)
    city = replace(city, layout=replace(city.layout, parts=both))
    assert len(design(city).layout.parts) == 2


def test_the_low_part_under_a_mapped_tower_is_its_podium():
    import pandas as pd

    city = sample_city(sheet_of(["panel_slab"], (1,)))
    low = city.layout.parts.assign(levels=[2], top=[6.6])
    high = low.assign(id=low["id"] + np.uint64(1), levels=[16], top=[50.0])
    both = pd.concat([low, high], ignore_index=True)
    made = design(replace(city, layout=replace(city.layout, parts=both)))
    assert designs_of_parts(made).tolist() == ["panel_slab/podium", "panel_slab"]
    alone = design(replace(city, layout=replace(city.layout, parts=low)))
    assert "podium" not in set(alone.layout.parts["zone"])


def test_one_building_becomes_another_kind():
    city = example_city()
    made = setback_skyscraper(city, building="The Tower", floors=20, noise=0.0)
    kinds = made.layout.buildings["generator"]
    assert (kinds == "setback_skyscraper").sum() == 1
    assert made.layout.buildings["height"].max() == pytest.approx(74.0)
    assert "buildings" in made.scene.meshes
    flat = setback_skyscraper(city, building="The Tower", floors=20, depth=0)
    assert len(flat.layout.parts) < len(made.layout.parts)


def test_a_city_without_room_for_it_is_told_so():
    with pytest.raises(ActionFailed, match="Setback skyscraper"):
        setback_skyscraper(example_city(), share=0.0)


@pytest.mark.parametrize("height", [11.0, 26.0])
def test_buildings_are_as_high_as_the_map_says(height):
    names = [name for name, kind in generators().items() if kind.mass]
    city = sample_city(sheet_of(names, (1, 2)))
    layout = city.layout
    tags = json.dumps({"height": str(height)})
    buildings = layout.buildings.assign(tags=tags, height=height)
    parts = layout.parts.assign(top=height)
    built = design(replace(city, layout=replace(layout, buildings=buildings, parts=parts)))
    assert np.allclose(built.layout.buildings["height"], height, rtol=2e-3)
    top = built.layout.parts.groupby("building")["top"].max()
    assert np.allclose(top, height, rtol=2e-3)


@pytest.mark.parametrize("turn", [7.3, 33.1, 61.7])
@pytest.mark.parametrize("size", [(180.0, 200.0), (150.0, 260.0)])
def test_a_house_that_fills_the_court_of_another_shares_no_ground_with_it(tmp_path, turn, size):
    town = Town()
    town.way([town.node(-200, -190), town.node(200, -190)], highway="residential")
    outer = shapely.box(-size[0] / 2, -size[1] / 2, size[0] / 2, size[1] / 2)
    court = shapely.box(-size[0] / 2 + 9, -size[1] / 2 + 9, size[0] / 2 - 9, size[1] / 2 - 9)
    # Walls that are not quite straight, as drawn ones are.
    court = shapely.transform(
        shapely.segmentize(court, 37.0), lambda xy: xy + 0.4 * np.sin(xy[:, ::-1])
    )
    rings = [
        [town.node(x, y) for x, y in affinity.rotate(one, turn, origin=(0, 0)).exterior.coords[:-1]]
        for one in (outer, court)
    ]
    ways = [town.way([*ring, ring[0]]) for ring in rings]
    members = "".join(
        f'<member type="way" ref="{way}" role="{role}"/>'
        for way, role in zip(ways, ("outer", "inner"), strict=True)
    )
    town.elements.append(
        f'<relation id="9001">{members}<tag k="type" v="multipolygon"/>'
        '<tag k="building" v="retail"/></relation>'
    )
    town.way([*rings[1], rings[1][0]], building="retail")
    parts = design(read_osm(town.write(tmp_path / "court.osm"))).layout.parts
    owners = parts["building"].unique()
    assert len(owners) == 2
    one, other = (
        shapely.union_all(parts.geometry[parts["building"] == k].to_numpy()) for k in owners
    )
    assert one.intersection(other).area < 0.5
