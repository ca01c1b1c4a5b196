import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.building.facade.recess import BACK, FRONT, HEAD, SIDE, SILL, Niches, cut_niches
from cityx.geometry.extrude import prisms
from cityx.geometry.solids import area_vectors, join_solids, open_groups, volumes_by_group

ARCH = np.array([[-0.5, 0], [0.5, 0], [0.5, 1.2], [0.35, 1.5], [0, 1.7], [-0.35, 1.5], [-0.5, 1.2]])


def shell(polygon, height=10.0):
    solids, _ = prisms(np.array([polygon], object), np.zeros(1), np.full(1, height), np.zeros(1))
    return solids


def niches(rows, depth=0.2, rim=None):
    """Make niches of rows (x, y, normal x, normal y, low, width, height)."""
    table = np.array(rows, float).reshape(-1, 7)
    rims = [
        np.array([[-w / 2, 0], [w / 2, 0], [w / 2, h], [-w / 2, h]]) if rim is None else rim
        for w, h in table[:, 5:]
    ]
    start = np.concatenate([[0], np.cumsum([len(each) for each in rims])]).astype(np.int64)
    points = np.concatenate(rims) if rims else np.zeros((0, 2))
    count = len(table)
    return Niches(
        np.zeros(count, np.int64), table[:, :2], table[:, 2:4], table[:, 4],
        np.full(count, depth), start, points,
    )  # fmt: skip


def cut(solids, asked):
    count = len(solids.faces)
    return cut_niches(
        solids.vertices, solids.faces, solids.face_part, solids.role == 0,
        np.zeros(count, np.int64), solids.uv, asked,
    )  # fmt: skip


def whole(solids, made):
    """Vertices and faces after the cut."""
    vertices = np.concatenate([solids.vertices, made.vertices])
    return vertices, np.concatenate([solids.faces[made.kept], made.faces])


def is_closed(vertices, faces):
    return not open_groups(faces, np.zeros(len(faces), np.int64), len(vertices), 1)[0]


def volume(vertices, faces):
    return volumes_by_group(vertices, faces, np.zeros(len(faces), np.int64), 1)[0]


@st.composite
def fronts(draw):
    """Windows on a grid over the south wall of a turned house, with gaps that differ."""
    columns, rows = draw(st.integers(1, 6)), draw(st.integers(1, 4))
    skip = draw(st.sets(st.integers(0, 23), max_size=6))
    width, height = draw(st.floats(0.5, 1.6)), draw(st.floats(0.5, 1.9))
    lift = draw(st.sampled_from([0.0, 0.13]))
    found = [
        (2.0 * c + 1.5, 0.0, 0, -1, 0.6 + 2.4 * r + lift * c, width, height)
        for r in range(rows) for c in range(columns) if r * columns + c not in skip
    ]  # fmt: skip
    return found, draw(st.floats(0.05, 0.3)), draw(st.floats(0, 6.28))


@settings(max_examples=40, deadline=None, derandomize=True)
@given(fronts())
def test_niches_keep_the_shell_closed_and_take_their_volume(case):
    rows, depth, turn = case
    c, s = np.cos(turn), np.sin(turn)
    rotation = np.array([[c, s], [-s, c]])
    corners = np.array([[0, 0], [5.0, 0], [14, 0], [14, 9], [0, 9]]) @ rotation
    solids = shell(shapely.Polygon(corners), 11.0)
    table = np.array(rows, float).reshape(-1, 7)
    table[:, :2] = table[:, :2] @ rotation
    table[:, 2:4] = table[:, 2:4] @ rotation
    made = cut(solids, niches(table, depth))
    vertices, faces = whole(solids, made)
    assert made.done.all()
    assert is_closed(vertices, faces)
    taken = (table[:, 5] * table[:, 6]).sum() * depth
    before = volume(solids.vertices, solids.faces)
    assert volume(vertices, faces) == pytest.approx(before - taken, rel=1e-9)
    size = np.linalg.norm(area_vectors(vertices, made.faces), axis=1)
    assert size.min(initial=1.0) > 1e-6
    opened = size[made.kind == BACK].sum()
    assert opened == pytest.approx((table[:, 5] * table[:, 6]).sum())
    if len(table):
        assert size[made.kind == FRONT].sum() == pytest.approx(14 * 11 - opened)
        jambs = size[made.kind == SIDE].sum()
        assert jambs == pytest.approx(2 * depth * table[:, 6].sum())
        assert size[made.kind == SILL].sum() == pytest.approx(depth * table[:, 5].sum())
        assert size[made.kind == HEAD].sum() == pytest.approx(depth * table[:, 5].sum())


def test_arched_niches_are_closed_too():
    solids = shell(shapely.box(0, 0, 12, 8))
    made = cut(solids, niches([(3, 0, 0, -1, 1, 0, 0), (6, 0, 0, -1, 1, 0, 0)], rim=ARCH))
    vertices, faces = whole(solids, made)
    assert is_closed(vertices, faces)
    taken = 2 * 0.2 * shapely.Polygon(ARCH).area
    assert volume(vertices, faces) == pytest.approx(12 * 8 * 10 - taken)


def test_a_niche_over_the_joint_of_two_quads_is_cut():
    house = shapely.Polygon([(0, 0), (6, 0.0), (12, 0), (12, 8), (0, 8)])
    made = cut(shell(house), niches([(6, 0, 0, -1, 2, 1.2, 1.5)]))
    assert made.done.all()


@pytest.mark.parametrize(
    "row",
    [
        (0.4, 0, 0, -1, 2, 1, 1),  # over the corner
        (6, 0, 0, -1, 9.5, 1, 1),  # over the head
        (6, 0, 0, 1, 2, 1, 1),  # faces the other way
        (6, 0.5, 0, -1, 2, 1, 1),  # off the wall
    ],
)
def test_a_niche_that_no_wall_holds_changes_nothing(row):
    solids = shell(shapely.box(0, 0, 12, 8))
    made = cut(solids, niches([row]))
    assert not made.done.any()
    assert made.kept.all()
    assert not len(made.faces)


def test_of_two_niches_that_touch_the_first_is_cut():
    made = cut(
        shell(shapely.box(0, 0, 12, 8)),
        niches([(6, 0, 0, -1, 2, 1, 1), (6.9, 0, 0, -1, 2, 1, 1), (9, 0, 0, -1, 2, 1, 1)]),
    )
    assert made.done.tolist() == [True, False, True]


def test_texture_runs_on_round_the_edges():
    solids = shell(shapely.box(0, 0, 12, 8))
    made = cut(solids, niches([(3, 0, 0, -1, 2, 1, 1)]))
    vertices, _ = whole(solids, made)
    front = made.kind == FRONT
    corner = vertices[made.faces[front, :3]]
    run = made.uv[front, :3, 0] - made.uv[front, :3, 0].min()
    assert np.allclose(run, corner[:, :, 0], atol=1e-5)
    assert np.allclose(made.uv[front, :3, 1], corner[:, :, 2], atol=1e-5)
    side = made.kind != FRONT
    edges = np.linalg.norm(np.diff(made.uv[side][:, [0, 1, 2, 3]], axis=1), axis=2)
    corners = vertices[made.faces[side]]
    assert np.allclose(edges, np.linalg.norm(np.diff(corners, axis=1), axis=2), atol=1e-5)


def test_other_groups_are_left_alone():
    both = [shell(shapely.box(0, 0, 5, 5)), shell(shapely.box(5, 0, 9, 5))]
    solids = join_solids(both)
    asked = niches([(2.5, 0, 0, -1, 2, 1, 1)])
    half = len(both[0].faces)
    group = np.repeat([1, 0], [half, len(both[1].faces)])
    made = cut_niches(
        solids.vertices, solids.faces, group, solids.role == 0, np.zeros(len(group), np.int64),
        solids.uv, asked,
    )  # fmt: skip
    assert not made.done.any()


@pytest.mark.parametrize("asked", [[], [(5, 0, 0, -1, 1, 1, 1.5)]])
def test_where_there_is_no_wall_nothing_is_cut(asked):
    solids = shell(shapely.box(0, 0, 10, 8))
    nowhere = cut_niches(
        solids.vertices, solids.faces, solids.face_part, np.zeros(len(solids.faces), bool),
        np.zeros(len(solids.faces), np.int64), solids.uv, niches(asked),
    )  # fmt: skip
    assert not nowhere.done.any()
    assert nowhere.kept.all()
    assert not len(nowhere.faces)


def test_without_niches_a_shell_stays_as_it_is():
    made = cut(shell(shapely.box(0, 0, 10, 8)), niches([]))
    assert made.kept.all()
    assert not len(made.faces)
