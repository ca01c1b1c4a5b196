"""Doors that a map draws at houses, found among what stands."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.building.design import design
from cityx.building.facade.facade import faced
from cityx.building.shell import shell
from cityx.sources.osm import read_osm
from tests.town import Town

PLANS = {
    "oblong": [(0, 0), (24, 0), (24, 12), (0, 12)],
    "ell": [(0, 0), (24, 0), (24, 10), (10, 10), (10, 24), (0, 24)],
    "turned": [(0, 0), (20, 7), (16, 19), (-4, 12)],
}


def built(folder, plan, doors, lod=2, **tags):
    """Build a house with nodes on its edges: the share from the start of the edge, and tags."""
    town = Town()
    town.way([town.node(-60, -9), town.node(90, -9)], highway="residential")
    ring, places = [], []
    for number, (x, y) in enumerate(plan):
        ring.append(town.node(x, y))
        (x2, y2) = plan[(number + 1) % len(plan)]
        for share, own in sorted(doors.get(number, ())):
            places.append((town.node(x + share * (x2 - x), y + share * (y2 - y), **dict(own)), own))
            ring.append(places[-1][0])
    town.way([*ring, ring[0]], **{"building": "apartments", "building__levels": "3", **tags})
    city = replace(read_osm(town.write(folder / "house.osm")), lod=lod)
    city = faced(shell(design(city)))
    points = city.layout.points
    at = dict(zip(points["source"], points.geometry, strict=True))
    found = []
    for node, own in places:
        spot = at[f"osm/node/{node}"]
        place = np.array([spot.x, spot.y])
        rows = city.scene.instances["doors"]
        far = np.hypot(*(rows.position[:, :2] - place).T)
        names = [city.scene.prototypes[k].name for k in rows.prototype[far < 1.0]]
        found.append((dict(own), names, far.min(initial=np.inf)))
    return city, found


def tagged(**tags):
    return tuple(tags.items())


@pytest.mark.parametrize("plan", PLANS)
@pytest.mark.parametrize("lod", [2, 3])
def test_every_mapped_entrance_has_a_door(tmp_path, plan, lod):
    doors = {
        0: [(0.2, tagged(entrance="main")), (0.8, tagged(entrance="yes"))],
        1: [(0.5, tagged(entrance="service"))],
        2: [(0.5, tagged(entrance="emergency"))],
        3: [(0.5, tagged(door="yes"))],
    }
    city, found = built(tmp_path, PLANS[plan], doors, lod=lod)
    assert [far < 1.0 for *_, far in found] == [True] * 5
    assert len(city.scene.instances["doors"].position) == 5
    assert not [note for note in city.notes if "entrances" in note]


def test_doors_are_of_the_kind_that_the_map_says(tmp_path):
    doors = {
        0: [(0.2, tagged(entrance="main"))],
        1: [(0.5, tagged(entrance="garage"))],
        2: [(0.3, tagged(entrance="service")), (0.7, tagged(entrance="emergency"))],
    }
    _, found = built(tmp_path, PLANS["oblong"], doors)
    kinds = {own["entrance"]: names[0] for own, names, _ in found}
    assert "garage" in kinds["garage"]
    assert "service" in kinds["service"]
    assert "service" in kinds["emergency"]
    assert "service" not in kinds["main"]


@pytest.mark.parametrize("tags", [{"entrance": "no"}, {"door": "no"}, {"entrance": "disused"}])
@pytest.mark.parametrize("plan", PLANS)
def test_no_door_where_the_map_has_none(tmp_path, plan, tags):
    own = tuple(tags.items())
    doors = {edge: [(share, own) for share in (0.3, 0.5, 0.7)] for edge in range(2)}
    city, found = built(tmp_path, PLANS[plan], doors)
    assert min(far for *_, far in found) > 1.0
    assert len(city.scene.instances["doors"].position) >= 1


def test_what_is_on_another_floor_is_named(tmp_path):
    doors = {0: [(0.2, tagged(entrance="main"))], 2: [(0.5, tagged(entrance="yes", level="2"))]}
    city, found = built(tmp_path, PLANS["oblong"], doors)
    assert [names != [] for _, names, _ in found] == [True, False]
    (note,) = (note for note in city.notes if "entrances" in note)
    assert note.startswith("map: 1 entrances have no door")


def test_a_part_above_the_ground_has_no_door_of_its_own(tmp_path):
    doors = {0: [(0.5, tagged(entrance="yes"))]}
    city, _ = built(tmp_path, PLANS["oblong"], doors, building__min_level="1")
    assert [note for note in city.notes if "entrances have no door" in note]


def test_doors_hide_no_window(tmp_path):
    doors = {0: [(share, tagged(entrance="yes")) for share in (0.2, 0.5, 0.8)]}
    city, _ = built(tmp_path, PLANS["oblong"], doors)
    windows, rows = (city.scene.instances[name].position for name in ("windows", "doors"))
    near = shapely.STRtree(shapely.points(windows[:, :2])).query(
        shapely.points(rows[:, :2]), "dwithin", distance=0.5
    )
    assert not (np.abs(windows[near[1], 2] - rows[near[0], 2]) < 1.5).any()
