import numpy as np
import pytest

from cityx.geometry.raycast import Masks, cast, joined, placed, ray_scene, subset
from cityx.geometry.turns import matrices

QUAD = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
HALVES = np.array([[0, 1, 2], [0, 2, 3]])
STAND = np.eye(3, 4)


def soup(rng, count):
    """Random triangles of several sizes, some flattened to a line or a point."""
    middle = rng.uniform(-5, 5, (count, 1, 3))
    corners = middle + rng.normal(size=(count, 3, 3)) * rng.choice([0.05, 0.5, 3.0], (count, 1, 1))
    corners[: count // 20, 2] = corners[: count // 20, 1]
    corners[count // 20 : count // 15, 1:] = corners[count // 20 : count // 15, :1]
    return corners.reshape(-1, 3).astype(np.float32), np.arange(3 * count).reshape(-1, 3)


def brute(corners, origins, directions):
    """Distance to the nearest of (t, 3, 3) triangles by Moeller and Trumbore, for each ray."""
    a, e, f = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    found = np.full(len(origins), np.inf)
    for ray, (o, d) in enumerate(zip(origins, directions, strict=True)):
        with np.errstate(all="ignore"):
            p = np.cross(d, f)
            det = (e * p).sum(axis=1)
            s = o - a
            u = (s * p).sum(axis=1) / det
            q = np.cross(s, e)
            v = (d * q).sum(axis=1) / det
            t = (f * q).sum(axis=1) / det
            hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0)
        found[ray] = t[hit].min() if hit.any() else np.inf
    return found


@pytest.mark.parametrize("seed", range(4))
def test_rays_meet_what_a_search_of_all_triangles_finds(seed):
    rng = np.random.default_rng(seed)
    meshes = [soup(rng, 300), soup(rng, 40), (QUAD, HALVES)]
    mesh = rng.integers(0, 3, 25)
    way = np.zeros((25, 3, 4))
    scale = rng.uniform(0.3, 2.0, (25, 3)) * rng.choice([-1.0, 1.0], (25, 3))  # some mirrored
    way[:, :, :3] = matrices(rng.uniform(-3, 3, (25, 3))) * scale[:, None, :]
    way[:, :, 3] = rng.uniform(-20, 20, (25, 3))
    scene = ray_scene([v for v, _ in meshes], [t for _, t in meshes], mesh, way)
    world = [
        np.asarray(meshes[m][0], np.float32).astype(float)[meshes[m][1]] @ w[:, :3].T + w[:, 3]
        for m, w in zip(mesh, way, strict=True)
    ]
    origins = rng.uniform(-30, 30, (400, 3))
    directions = np.where(
        rng.uniform(size=(400, 1)) < 0.3, np.eye(3)[rng.integers(0, 3, 400)], -origins
    ) + np.where(rng.uniform(size=(400, 1)) < 0.5, rng.normal(size=(400, 3)), 0.0)
    hits = cast(scene, origins, directions)
    expected = brute(np.concatenate(world), origins, directions)
    np.testing.assert_array_equal(np.isinf(hits.distance), np.isinf(expected))
    np.testing.assert_allclose(hits.distance, expected, rtol=1e-9)
    seen = np.flatnonzero(hits.instance >= 0)
    assert len(seen) > 50
    for ray in seen.tolist():
        corners = world[hits.instance[ray]][hits.triangle[ray]]
        u, v = float(hits.u[ray]), float(hits.v[ray])
        spot = corners[0] * (1 - u - v) + corners[1] * u + corners[2] * v
        there = origins[ray] + hits.distance[ray] * directions[ray]
        np.testing.assert_allclose(spot, there, atol=1e-4)


def test_no_ray_slips_through_shared_edges_and_corners():
    rng = np.random.default_rng(5)
    n = 24
    x, y = np.meshgrid(np.linspace(-1, 1, n), np.linspace(-1, 1, n))
    points = np.column_stack([x.ravel(), y.ravel(), 0.1 * np.sin(7 * x.ravel() * y.ravel())])
    at = np.arange(n * n).reshape(n, n)
    a, b, c, d = at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]
    quads = [np.stack([a, b, c], -1), np.stack([a, c, d], -1)]
    faces = np.concatenate([q.reshape(-1, 3) for q in quads])
    way = np.zeros((1, 3, 4))
    way[0, :, :3] = matrices([[0.3, 0.2, 0.7]])[0]
    way[0, :, 3] = (3.0, -2.0, 1.0)
    scene = ray_scene([points], [faces], [0], way)
    world = points.astype(np.float32).astype(float) @ way[0, :, :3].T + way[0, :, 3]
    inner = np.setdiff1d(at[1:-1, 1:-1].ravel(), [])
    ends = world[faces[:, :2]]
    share = rng.uniform(size=(len(faces), 1))
    on_edges = ends[:, 0] * share + ends[:, 1] * (1 - share)
    border = np.isin(faces[:, :2], at[1:-1, 1:-1]).any(axis=1)
    targets = np.concatenate([world[inner], on_edges[border]])
    eye = np.array([3.3, -2.2, 9.0])
    assert np.isfinite(cast(scene, eye, targets - eye).distance).all()


def test_axis_aligned_rays_meet_a_box_in_its_faces():
    unit = np.array([[x, y, z] for x in (0.0, 1) for y in (0.0, 1) for z in (0.0, 1)])
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))]
    scene = ray_scene([unit], [faces], [0], STAND[None])
    directions = np.concatenate([np.eye(3), -np.eye(3)])
    hits = cast(scene, np.array([0.5, 0.5, 0.5]) - 3 * directions, directions)
    np.testing.assert_allclose(hits.distance, 2.5)
    assert not hits.back.any()
    inside = cast(scene, np.full(3, 0.5), directions)
    np.testing.assert_allclose(inside.distance, 0.5)
    assert inside.back.all()
    corner = cast(scene, [0.0, 0.0, 5.0], [0.0, 0.0, -1.0])  # along an edge, onto a corner
    assert corner.distance[0] == pytest.approx(4.0)


def test_distances_count_lengths_of_the_direction_and_end_at_the_reach():
    scene = ray_scene([QUAD], [HALVES], [0], STAND[None])
    above, down = [0.25, 0.5, 6.0], [0.0, 0.0, -2.0]
    assert cast(scene, above, down).distance[0] == 3.0
    assert cast(scene, above, down, reach=3.0).instance[0] == 0
    short = cast(scene, above, down, reach=2.9)
    assert np.isinf(short.distance[0])
    assert short.instance[0] == -1
    assert np.isinf(cast(scene, [0.25, 0.5, -1.0], down).distance[0])  # it lies behind


def test_flattened_instances_and_empty_meshes_are_not_seen():
    flat = STAND.copy()
    flat[2, 2] = 0.0
    nothing = (np.zeros((0, 3)), np.zeros((0, 3), int))
    scene = ray_scene([QUAD, nothing[0]], [HALVES, nothing[1]], [0, 1], [flat, STAND])
    assert cast(scene, [0.25, 0.5, 6.0], [0.0, 0.0, -1.0]).instance[0] == -1
    empty = ray_scene([], [], np.zeros(0, int), np.zeros((0, 3, 4)))
    assert cast(empty, np.zeros((2, 3)), np.ones((2, 3))).instance.tolist() == [-1, -1]


def test_of_hits_at_one_distance_the_first_instance_wins():
    ways = np.repeat(STAND[None], 40, axis=0)
    scene = ray_scene([QUAD], [HALVES], np.zeros(40, int), ways)
    hits = cast(scene, [0.5, 0.5, 1.0], [0.0, 0.0, -1.0])
    assert (hits.instance[0], hits.triangle[0]) == (0, 0)


def test_joined_scenes_and_subsets_number_their_instances_in_order():
    low = ray_scene([QUAD], [HALVES], [0], STAND[None])
    high = STAND.copy()
    high[2, 3] = 2.0
    upper = placed(low.shapes, [0, 0], np.stack([high, high + np.array([0, 0, 0, 9.0])]))
    both = joined(low, upper)
    above, down = [0.25, 0.5, 3.0], [0.0, 0.0, -1.0]
    hits = cast(both, above, down)
    assert (hits.distance[0], hits.instance[0]) == (1.0, 1)
    assert both.count == 3
    alone = subset(both, [0])
    assert cast(alone, above, down).distance[0] == 3.0
    assert cast(subset(both, [2]), above, down).instance[0] == -1
    assert cast(subset(both, []), above, down).instance[0] == -1


def test_cut_outs_let_rays_through():
    uv = QUAD[:, :2][HALVES].astype(np.float32) * 4
    board = np.array([[True, False], [False, True]])  # a chess board of 8 by 8 on the quad
    masks = Masks(np.zeros(2, np.int32), uv, (board,))
    scene = ray_scene([QUAD], [HALVES], [0], STAND[None], masks=masks)
    x, y = (np.meshgrid(*[(np.arange(16) + 0.5) / 16] * 2)[k].ravel() for k in (0, 1))
    hits = cast(scene, np.column_stack([x, y, np.ones(256)]), np.tile([0.0, 0.0, -1.0], (256, 1)))
    upper_left = (np.floor(x * 8) + np.floor(y * 8)) % 2 == 1  # v runs upwards
    np.testing.assert_array_equal(hits.instance == 0, upper_left)


def test_threads_change_no_byte():
    rng = np.random.default_rng(11)
    points, faces = soup(rng, 500)
    scene = ray_scene([points], [faces], [0], STAND[None])
    directions = rng.normal(size=(40_000, 3))
    one, two = (cast(scene, np.zeros(3), directions, threads=n) for n in (1, 2))
    for name in vars(one):
        assert getattr(one, name).tobytes() == getattr(two, name).tobytes(), name
