"""Empty blocks of a map are built on; what a map has stays as it is."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.city import City, Frame, Layout
from cityx.errors import ActionFailed
from cityx.sources.features.tagged import Owner
from cityx.town.rebuilding import street_blocks, with_area
from cityx.town.town import town
from cityx.town.wishes.infill import infill


def made(**plan):
    city = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=3)
    return town(
        city,
        width=360.0,
        depth=360.0,
        pattern="grid",
        zone="midrise",
        parks=0.0,
        plazas=0.0,
        **plan,
    )


def streets_alone(city, kept=None):
    """A layout as a map has it that tells of streets, and of the buildings of one block alone."""
    layout = city.layout
    own = np.zeros(len(layout.buildings), bool)
    if kept is not None:
        own = shapely.intersects(layout.buildings.geometry.to_numpy(), kept)
    buildings = layout.buildings[own].reset_index(drop=True)
    buildings["source"] = [f"osm/way/{n}" for n in range(len(buildings))]
    parts = layout.parts[layout.parts["building"].isin(buildings["id"])].reset_index(drop=True)
    empty = {name: getattr(layout, name).iloc[:0] for name in ("areas", "lines", "points")}
    return replace(city, layout=replace(layout, buildings=buildings, parts=parts, **empty))


def test_streets_without_buildings_become_a_town(check_goals):
    city = infill(streets_alone(made()))
    houses = city.layout.buildings.geometry.to_numpy()
    assert len(houses) > 20
    assert shapely.area(houses).sum() - shapely.union_all(houses).area < 0.05
    roads = city.layout.roads
    wide = shapely.buffer(roads.geometry.to_numpy(), roads["width"].to_numpy() / 2)
    assert shapely.intersection(shapely.union_all(houses), shapely.union_all(wide)).area < 0.5
    assert "are invented" in city.notes[-1]
    check_goals(city)
    again = infill(streets_alone(made()))
    assert again.layout.buildings.equals(city.layout.buildings)


def test_a_block_with_buildings_stays_as_it_is():
    whole = made()
    block = street_blocks(whole.layout)[0]
    city = streets_alone(whole, kept=block)
    mapped = city.layout.buildings
    assert len(mapped) > 0
    filled = infill(city).layout.buildings
    assert set(mapped["id"]) <= set(filled["id"])
    new = filled[~filled["id"].isin(mapped["id"])]
    assert len(new) > 0
    assert not shapely.intersects(shapely.union_all(new.geometry.to_numpy()), block)


@pytest.mark.parametrize("kind", ["park", "wood", "water"])
def test_parks_woods_and_water_stay_open(kind):
    city = streets_alone(made())
    block = street_blocks(city.layout)[0]
    layout = with_area(city.layout, kind, block, Owner(("osm", "way", 1), {}))
    built = infill(replace(city, layout=layout)).layout.buildings.geometry.to_numpy()
    assert shapely.intersection(shapely.union_all(built), block).area < 1.0


def test_what_is_built_follows_the_zone():
    floors = {
        zone: infill(streets_alone(made()), zone=zone).layout.buildings["levels"].median()
        for zone in ("suburb", "midrise")
    }
    assert floors["suburb"] <= 2 < floors["midrise"]


def test_storeys_are_those_of_the_invented_buildings():
    whole = made()
    city = streets_alone(whole, kept=street_blocks(whole.layout)[0])
    mapped = city.layout.buildings.set_index("id")["levels"]
    levels = infill(city, most_floors=2).layout.buildings.set_index("id")["levels"]
    assert (levels[mapped.index] == mapped).all()
    assert levels.drop(mapped.index).max() == 2


def test_a_map_without_an_empty_block_is_refused():
    with pytest.raises(ActionFailed, match="blocks between the streets is empty and of 400 m2"):
        infill(made(), largest=400.0)
