import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.errors import UsageError
from cityx.geometry.parcels.parcels import DOOR, SCHEMES, parcels_of

FAR = np.array([1e6, -1e6])
ZONES = sorted(SCHEMES)
STEP = 2.0**-6  # metres; six decimals, and exact at 1,000 km from the origin


def ring(count, radius, squash, seed, notch):
    """A block with `count` corners, convex but for one notch."""
    rng = np.random.default_rng(seed)
    angle = (np.arange(count) + 0.4 * rng.random(count)) * 2 * np.pi / count
    points = radius * np.column_stack([np.cos(angle), squash * np.sin(angle)])
    if notch:
        points[0] *= 0.4
    return shapely.Polygon(np.round(points / STEP) * STEP)


BLOCKS = st.builds(
    ring,
    st.integers(3, 12),
    st.floats(15, 160),
    st.floats(0.35, 1.0),
    st.integers(0, 10_000),
    st.booleans(),
).filter(lambda block: block.is_valid and block.area > 100)


def cut(*blocks, zone="suburb", density=0.5, seed=1):
    count = len(blocks)
    return parcels_of(blocks, np.arange(7, 7 + count), [zone] * count, [density] * count, seed=seed)


def overlap(shapes):
    a, b = shapely.STRtree(shapes).query(shapes, predicate="intersects")
    a, b = a[a < b], b[a < b]
    return shapely.area(shapely.intersection(shapes[a], shapes[b])).sum()


@settings(max_examples=120, deadline=None, derandomize=True)
@given(BLOCKS, st.sampled_from(ZONES), st.floats(0, 1), st.integers(0, 99))
def test_parcels_cover_their_block_without_overlap_and_have_a_door_to_the_street(
    block, zone, density, seed
):
    parcels = cut(block, zone=zone, density=density, seed=seed)
    area = shapely.area(parcels.shapes).sum()
    assert abs(area - block.area) < 1e-9 * block.area
    assert overlap(parcels.shapes) < 1e-9 * block.area
    assert (shapely.get_type_id(parcels.shapes) == 3).all()
    assert shapely.is_valid(parcels.shapes).all()
    street = shapely.buffer(block.boundary, 1e-6)
    assert (
        shapely.length(shapely.intersection(shapely.boundary(parcels.shapes), street)) >= DOOR
    ).all()
    assert (shapely.length(parcels.street) >= DOOR).all()
    assert shapely.dwithin(shapely.points(parcels.front.reshape(-1, 2)), block.boundary, 1e-6).all()
    assert len(set(parcels.id.tolist())) == len(parcels.id)


@settings(max_examples=25, deadline=None, derandomize=True)
@given(st.lists(BLOCKS, min_size=2, max_size=5), st.sampled_from(ZONES))
def test_other_blocks_and_the_place_change_nothing(blocks, zone):
    ids = np.arange(1, len(blocks) + 1)
    together = parcels_of(blocks, ids, [zone] * len(blocks), [0.5] * len(blocks), seed=3)
    for row, block in enumerate(blocks):
        far = shapely.transform(block, lambda points: points + FAR)
        alone = parcels_of([far], ids[row : row + 1], [zone], [0.5], seed=3)
        same = together.take(together.block == row)
        assert alone.id.tolist() == same.id.tolist()
        moved = shapely.transform(same.shapes, lambda points: points + FAR)
        assert shapely.equals_exact(alone.shapes, moved, 1e-9).all()
        assert np.allclose(alone.front, same.front + FAR, rtol=0, atol=1e-9)


def test_rows_are_as_wide_and_deep_as_terraced_houses():
    parcels = cut(shapely.box(0, 0, 160, 58), zone="row")
    width = np.hypot(*(parcels.front[:, 1] - parcels.front[:, 0]).T)
    assert np.quantile(width, 0.05) > 5.0
    assert np.quantile(width, 0.9) < 8.5
    assert np.allclose(shapely.area(parcels.shapes) / width, 29.0, atol=1.0)


def test_suburban_parcels_are_as_wide_as_detached_houses_need():
    parcels = cut(shapely.box(0, 0, 160, 64), shapely.box(300, 0, 420, 70))
    width = np.hypot(*(parcels.front[:, 1] - parcels.front[:, 0]).T)
    assert width.min() > 12.0
    assert width.max() < 26.0


def test_no_strip_ends_in_a_diagonal():
    parcels = cut(shapely.box(0, 0, 150, 60), zone="midrise")
    box = shapely.area(shapely.oriented_envelope(parcels.shapes))
    assert np.allclose(box, shapely.area(parcels.shapes))


def test_a_small_block_is_one_parcel():
    assert len(cut(shapely.box(0, 0, 6, 8)).shapes) == 1


def test_the_inside_of_a_deep_block_belongs_to_a_parcel_on_the_street():
    block = shapely.box(0, 0, 240, 200)
    parcels = cut(block, zone="row")
    inner = parcels.shapes[shapely.contains_xy(parcels.shapes, 120, 100)]
    assert len(inner) == 1
    assert shapely.intersection(inner[0], block.boundary).length > 5


def test_a_seed_changes_the_boundaries_and_not_the_block():
    first, second = (cut(shapely.box(0, 0, 150, 60), seed=seed) for seed in (1, 2))
    assert not shapely.equals_exact(first.shapes[0], second.shapes[0], 1e-3)


def test_no_blocks_have_no_parcels():
    assert not len(parcels_of([], [], [], [], seed=0).shapes)


def test_all_faults_are_named_at_once():
    bow = shapely.Polygon([(0, 0), (10, 10), (10, 0), (0, 10)])
    with pytest.raises(UsageError) as caught:
        parcels_of([bow, shapely.box(0, 0, 9, 9)], [1, 2], ["row", "moon"], [0, 0], seed=0)
    assert "block 0 is not a valid polygon; zone 'moon' is none of core, midrise" in str(
        caught.value
    )


def test_a_piece_that_is_on_no_street_is_left_out(monkeypatch):
    from cityx.geometry.parcels import parcels as module

    block = shapely.box(0.0, 0.0, 120.0, 80.0)
    args = ([block], np.array([7], np.uint64), ["suburb"], [0.5])
    whole = parcels_of(*args, seed=1)
    fronts = module.fronts_of

    def without_one(*said):
        front = fronts(*said)
        front[0] = np.nan
        return front

    monkeypatch.setattr(module, "fronts_of", without_one)
    assert parcels_of(*args, seed=1).id.tolist() == whole.id[1:].tolist()
