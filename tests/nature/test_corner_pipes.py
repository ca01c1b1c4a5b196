"""Guard pipes round the corners of junctions in Japan."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import ndimage
from scipy.spatial import cKDTree

from cityx.city import Frame
from cityx.ground.standing import WALKED
from cityx.ground.walking.walkable import BODY, CELL, walkable_of
from cityx.nature.furniture.guard_rails import FREE_WALK, PIPE, guard_rails
from cityx.road.ground.ground_surface import ground
from cityx.road.network.lane_graph import lanes

TOKYO, BERLIN = Frame(35.69, 139.78), Frame(52.5, 13.4)


def junction(crossroads, walk, frame):
    """The crossroads without houses, with walks of so many metres."""
    empty = crossroads.layout
    roads = empty.roads.assign(sidewalk_left=walk, sidewalk_right=walk)
    layout = replace(empty, roads=roads, areas=empty.areas[:0], points=empty.points[:0],
                     buildings=empty.buildings[:0], parts=empty.parts[:0])  # fmt: skip
    done = frozenset({"layout", "terrain"})
    city = replace(crossroads, layout=layout, frame=frame, stages_done=done, lod=2)
    return ground(lanes(city))


@pytest.mark.parametrize(
    ("walk", "frame", "there"), [(3.0, TOKYO, True), (1.5, TOKYO, False), (3.0, BERLIN, False)]
)
def test_pipes_go_round_corners_where_walks_are_wide(crossroads, walk, frame, there):
    city = junction(crossroads, walk, frame)
    made = guard_rails(city)
    mesh = made.scene.meshes.get("guard_rails")
    if not there:
        assert mesh is None
        return
    points = mesh.vertices[:, :2]
    amid = (np.abs(points) < 14.0).all(axis=1)
    quarters = {tuple(each) for each in np.sign(points[amid]).astype(int).tolist()}
    assert len(quarters) == 4
    assert city.ground.on(points[amid], *WALKED).all()
    assert not city.ground.on(points, "ramp", "kerb_dropped").any()
    corner = np.abs(points[amid]).min(axis=1)
    assert corner.min() == pytest.approx(5.0 + PIPE.beyond - PIPE.half, abs=0.02)
    assert FREE_WALK + PIPE.beyond < walk
    again = guard_rails(city).scene.meshes["guard_rails"]
    assert again.vertices.tobytes() == mesh.vertices.tobytes()
    assert len(np.unique(mesh.object_id)) == mesh.count


def test_people_keep_half_a_body_off_pipes_and_pass_behind_them(crossroads):
    city = junction(crossroads, 3.0, TOKYO)
    made = guard_rails(city)
    points = made.scene.meshes["guard_rails"].vertices[:, :2]
    shut, open_ = walkable_of(made), walkable_of(city)
    assert open_.holds(points).mean() > 0.5
    assert not shut.holds(points).any()
    rows, columns = np.nonzero(shut.free)
    places = shut.places(np.column_stack([rows, columns]))
    gap = cKDTree(places).query(points)[0]
    assert gap.min() >= BODY
    assert gap.max() < 2 * BODY + 2 * CELL
    assert ndimage.label(shut.free)[1] == ndimage.label(open_.free)[1]  # nowhere is shut off
