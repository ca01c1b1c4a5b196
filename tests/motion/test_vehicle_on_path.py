import numpy as np
import pytest

from cityx.assets.vehicles.movers import vehicle
from cityx.city.content import content_hash
from cityx.city.tracks import MOVER, poses_at
from cityx.errors import ActionFailed
from cityx.motion.vehicle_on_path import SPEEDS, add_vehicles


@pytest.mark.parametrize("kind", SPEEDS)
def test_every_kind_drives_in_the_lane_of_a_street(park, kind):
    city, (object_id,) = add_vehicles(park, path="y1", kind=kind)
    tracks = city.tracks
    assert tracks.object_id.tolist() == [object_id]
    assert tracks.kind.tolist() == [MOVER[kind]]
    assert park.ground.on(tracks.position[:, :2], "carriageway", "junction", "marking").all()
    assert (tracks.position[:, 1] < -80.5).all()  # right of the middle, going east
    assert np.cos(tracks.heading).min() > 0.999
    assert vehicle(str(tracks.look[0])).kind == kind


def test_the_speed_along_the_arc_is_the_one_asked_for(park):
    city, _ = add_vehicles(park, path="y2", speed=12.0)
    step = np.hypot(*np.diff(city.tracks.position[:, :2], axis=0).T)
    assert step / np.diff(city.tracks.time) == pytest.approx(12.0, rel=0.02)


def test_vehicles_keep_their_distance(park):
    city, ids = add_vehicles(park, path="y1", count=8)
    assert len(ids) == 8
    x = np.sort(poses_at(city.tracks, 2.0).position[:, 0])
    assert np.diff(x).min() > city.tracks.size[:, 0].max() + 5.0


def test_the_same_seed_gives_the_same_bytes(park):
    made = [add_vehicles(park, path="y1", count=8)[0] for _ in range(2)]
    assert content_hash(made[0]).total == content_hash(made[1]).total


@pytest.mark.parametrize(
    ("args", "said"),
    [
        ({"path": "loop1"}, '"loop1" is a way for people, no vehicle drives along it'),
        ({"path": "y1", "count": 400}, r"400 vehicles do not fit .*: 18 fit, 16.3 m apart at 30"),
        ({"path": "z", "points": ((-50.0, -50.0), (50.0, 50.0))},
         r"It lies on park for .* m from \(-50.0, -50.0\).*Right would be a way on carriageways"),
    ],
)  # fmt: skip
def test_what_cannot_be_driven_is_refused(park, args, said):
    with pytest.raises(ActionFailed, match=said):
        add_vehicles(park, **args)
