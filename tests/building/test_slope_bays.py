"""Houses on slopes: their heights above the ground that stands, measured on the meshes."""

from dataclasses import replace

import numpy as np
import pytest
import shapely

from cityx.building.design import design
from cityx.building.facade.facade import faced
from cityx.building.shell import prism, shell
from cityx.checks.report import run_checks
from cityx.city import Terrain
from cityx.city.mesh_measures import check_closed, plan_area
from cityx.geometry.solids import area_vectors
from cityx.sources.osm import read_osm
from tests.town import Town

ROOM = 2.0  # metres of wall that stays free at the back
TOLERANCE = 0.6  # metres, with the kerb
PLANS = {
    "row": [(0, 0), (70, 0), (70, 11), (0, 11)],
    "ell": [(0, 0), (50, 0), (50, 12), (12, 12), (12, 40), (0, 40)],
    "square": [(0, 0), (14, 0), (14, 14), (0, 14)],
    "court": [(0, 0), (60, 0), (60, 40), (0, 40)],
}


def hillside(folder, *houses, east=0.0, north=0.0):
    """Read houses, a plan and tags each, 90 m apart, onto an even slope."""
    town = Town()
    town.way([town.node(-40, -20), town.node(90 * len(houses), -20)], highway="residential")
    for number, (plan, tags) in enumerate(houses):
        nodes = [town.node(90 * number + x, y) for x, y in plan]
        town.way([*nodes, nodes[0]], **{"building": "yes", **tags})
    city = read_osm(town.write(folder / "hill.osm"))
    x = np.arange(-500.0, 1500.0, 10.0)
    return replace(
        city, terrain=Terrain((-500.0, -500.0), 10.0, east * x[None] + north * x[:, None])
    )


def tops_over_ground(city, row=0):
    """Return how high a building rises over the ground along its walls, (k,) metres."""
    outline = city.layout.buildings.geometry.iloc[row]
    batch = city.scene.meshes["buildings"]
    at = batch.object_id.tolist().index(city.layout.buildings["id"].iloc[row])
    faces = batch.faces[batch.face_start[at] : batch.face_start[at + 1]]
    up = faces[area_vectors(batch.vertices, faces)[:, 2] > 0.05]
    corners = [batch.vertices[face[face >= 0]] for face in up]
    roofs = shapely.STRtree([shapely.Polygon(corner[:, :2]) for corner in corners])
    inner = shapely.buffer(outline, -0.4, join_style="mitre")
    ring = shapely.get_exterior_ring(inner)
    places = shapely.line_interpolate_point(ring, np.arange(0.5, ring.length))
    place, roof = roofs.query(places, predicate="intersects")
    found = np.full(len(places), -np.inf)
    for k, face in zip(place.tolist(), roof.tolist(), strict=True):
        (a, b, c), at = corners[face][:3], shapely.get_coordinates(places[k])[0]
        normal = np.cross(b - a, c - a)
        z = a[2] - (normal[:2] @ (at - a[:2])) / normal[2]
        found[k] = max(found[k], z)
    return found - city.terrain.height_at(shapely.get_coordinates(places))


@pytest.mark.parametrize("plan", PLANS)
@pytest.mark.parametrize("rise", [0.05, 0.15, 0.3])
def test_low_houses_keep_their_height_downhill_and_a_wall_uphill(tmp_path, plan, rise):
    city = hillside(tmp_path, (PLANS[plan], {"height": "6", "roof:shape": "flat"}), east=rise)
    for built in (prism(city), shell(design(city), parapet=False)):
        batch = built.scene.meshes["buildings"]
        over = tops_over_ground(built)
        assert over.max() < 6.0 + TOLERANCE
        assert over.min() > ROOM
        assert check_closed(batch).all()
        assert plan_area(batch) == pytest.approx(
            shapely.area(city.layout.buildings.geometry.to_numpy()), rel=1e-3
        )
        assert not [note for note in built.notes if "slopes" in note]


def test_towers_and_houses_that_are_high_enough_stand_whole(tmp_path):
    houses = [(PLANS["square"], {"height": "45"}), (PLANS["row"], {"height": "30"}),
              (PLANS["square"], {"height": "9", "roof:shape": "flat"})]  # fmt: skip
    built = prism(hillside(tmp_path, *houses, east=0.3))
    assert len(built.layout.parts) == 3
    for row, tags in enumerate(built.layout.buildings["height"]):
        assert tops_over_ground(built, row).max() == pytest.approx(tags, abs=TOLERANCE)


def test_floors_of_bays_lie_half_storeys_apart(tmp_path):
    built = prism(hillside(tmp_path, (PLANS["row"], {"height": "6"}), east=0.15))
    batch = built.scene.meshes["buildings"]
    up = batch.faces[area_vectors(batch.vertices, batch.faces)[:, 2] > 0.05]
    apart = np.diff(np.unique(np.round(batch.vertices[up[:, 0], 2], 2)))
    steps = np.round(apart / 1.5) * 1.5
    assert len(built.layout.parts) > 2
    assert np.abs(apart - steps).max() < 0.05, apart


def test_a_ridge_runs_on_through_the_bays_of_a_row(tmp_path):
    tags = {"height": "9", "roof:shape": "gabled", "roof:height": "3"}
    built = shell(design(hillside(tmp_path, (PLANS["row"], tags), east=0.2)), overhang=0.0)
    ridges = set(np.round(np.degrees(built.layout.parts["roof_direction"]) % 180, 3))
    assert len(built.layout.parts) > 3
    assert len(ridges) == 1
    assert abs(ridges.pop()) % 180 < 1.0  # down to the north and the south


@pytest.mark.parametrize("slope", [(0.15, 0.0), (0.0, 0.15), (0.1, -0.2)])
def test_doors_and_windows_of_houses_in_bays_keep_every_check(tmp_path, slope):
    uses = ("apartments", "retail", "house", "school")
    tags = [{"height": "7", "building": use} for use in uses]
    houses = zip(PLANS.values(), tags, strict=True)
    city = hillside(tmp_path, *houses, east=slope[0], north=slope[1])
    built = faced(shell(design(replace(city, lod=2))))
    checks = {check.name: check for check in run_checks(built)}
    wanted = (
        "building_height_off",
        "building_buried",
        "windows_on_blind_walls",
        "floating_building",
    )
    assert not [name for name in wanted if name in checks and not checks[name].ok]
    doors = built.scene.instances["doors"]
    assert set(doors.owner.tolist()) == set(built.layout.buildings["id"].tolist())


def test_what_is_flat_is_as_it_was(tmp_path):
    city = hillside(tmp_path, *((plan, {"height": "6"}) for plan in PLANS.values()))
    flat = replace(city, terrain=Terrain((0.0, 0.0), 1.0, np.zeros((1, 1))))
    a, b = prism(city).scene.meshes["buildings"], prism(flat).scene.meshes["buildings"]
    assert a.vertices.tobytes() == b.vertices.tobytes()


def test_a_slope_that_no_bay_follows_is_named(tmp_path):
    built = prism(hillside(tmp_path, (PLANS["square"], {"height": "4"}), east=0.5, north=0.5))
    assert any("walls downhill over their height: osm/way/" in note for note in built.notes)
