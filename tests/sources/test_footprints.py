import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.city import Frame
from cityx.errors import UsageError
from cityx.geometry.parcels.parcels import DOOR, parcels_of
from cityx.geometry.rectangles import rectangles_of
from cityx.geometry.seams import NEEDLE
from cityx.sources.features.gather import gather
from cityx.sources.features.resolve import resolve
from cityx.sources.features.tagged import Report
from cityx.sources.osm import read_osm
from cityx.sources.parcels.footprints import GROUNDS, footprints_of
from cityx.sources.parcels.houses import LEAST_ROOM

ASIDE = np.array([500.0, 0.0])
ZONES = sorted(GROUNDS)
FAR = np.array([1e6, -1e6])
STEP = 2.0**-6  # metres; six decimals, and exact at 1,000 km from the origin


def block(width, depth, skew, turn, seed):
    """A block of four corners, more or less a rectangle."""
    rng = np.random.default_rng(seed)
    corner = np.array([(0, 0), (width, 0), (width, depth), (0, depth)])
    corner = corner + skew * rng.uniform(-1, 1, (4, 2))
    way = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    return shapely.Polygon(np.round(corner @ way / STEP) * STEP)


BLOCKS = st.builds(
    block,
    st.floats(70, 200),
    st.floats(48, 90),
    st.floats(0, 9),
    st.floats(0, 6),
    st.integers(0, 9999),
)


def built_on(blocks, zone, *, density=0.5, height=np.nan, seed=1):
    count = len(blocks)
    parcels = parcels_of(blocks, np.arange(5, 5 + count), [zone] * count, [density] * count,
                         seed=seed)  # fmt: skip
    many = len(parcels.shapes)
    found = footprints_of(
        parcels, [zone] * many, np.full(many, density), np.full(many, height), seed=seed
    )
    return parcels, found


def rows(found, key):
    return np.array([key in own for own in found.tags()], bool)


@settings(max_examples=60, deadline=None, derandomize=True)
@given(BLOCKS, st.sampled_from(ZONES), st.floats(0, 1), st.integers(0, 99))
def test_buildings_stand_on_their_parcels_and_apart(block, zone, density, seed):
    parcels, found = built_on([block], zone, density=density, seed=seed)
    houses = found.shapes[rows(found, "building")]
    assert len(houses)
    assert shapely.is_valid(found.shapes).all()
    assert (shapely.get_type_id(houses) == 3).all()
    of = {f"{one:016x}": shape for one, shape in zip(parcels.id, parcels.shapes, strict=True)}
    for shape, owner in zip(found.shapes, found.owner, strict=True):
        if found.owners[owner].key[0] == "parcel":
            parcel = of[found.owners[owner].key[1]]
            # Grounds with needles are rounded, so that their border may move by that much.
            solid = "building" in found.owners[owner].tags
            limit = 1e-6 if solid else NEEDLE * parcel.length
            assert shape.difference(parcel).area < limit
    a, b = shapely.STRtree(houses).query(houses, predicate="intersects")
    assert shapely.area(shapely.intersection(houses[a[a < b]], houses[b[a < b]])).sum() < 1e-6
    homes = [shape for shape, own in zip(found.shapes, found.tags(), strict=True)
             if own.get("building", "garage") not in ("garage", "shed")]  # fmt: skip
    assert rectangles_of(homes).width.min() > LEAST_ROOM - 0.05


@settings(max_examples=12, deadline=None, derandomize=True)
@given(BLOCKS, BLOCKS, st.sampled_from(ZONES))
def test_other_blocks_and_the_place_change_nothing(first, second, zone):
    _, alone = built_on([first], zone)
    _, both = built_on([first, shapely.transform(second, lambda at: at + ASIDE)], zone)
    _, far = built_on([shapely.transform(first, lambda at: at + FAR)], zone)
    assert far.ids().tolist() == alone.ids().tolist()
    back = shapely.transform(far.shapes, lambda at: at - FAR)
    assert shapely.equals_exact(back, alone.shapes, 1e-6).all()
    kept = np.isin(both.ids(), alone.ids())
    assert both.ids()[kept].tolist() == alone.ids().tolist()
    assert shapely.equals_exact(both.shapes[kept], alone.shapes).all()
    assert both.take(np.flatnonzero(kept)).tags() == alone.tags()


@pytest.mark.parametrize("zone", ZONES)
def test_buildings_take_the_share_of_ground_of_their_zone(zone):
    blocks = [block(90 + 9 * k, 56 + 2 * k, 4, k, k) for k in range(12)]
    parcels, found = built_on(blocks, zone)
    share = shapely.area(found.shapes[rows(found, "building")]).sum()
    share /= shapely.area(parcels.shapes).sum()
    assert share == pytest.approx(GROUNDS[zone].coverage, rel=0.1)


def test_terraced_houses_share_their_walls_to_the_bit():
    _, found = built_on([shapely.box(0, 0, 150, 58)], "row")
    houses = found.shapes[rows(found, "building")]
    corners = [set(map(tuple, shapely.get_coordinates(house).tolist())) for house in houses]
    a, b = shapely.STRtree(houses).query(houses, predicate="touches")
    shared = [len(corners[i] & corners[j]) for i, j in zip(a, b, strict=True) if i < j]
    assert len(shared) >= len(houses) - 4
    assert min(shared) >= 2


def test_towers_have_the_height_that_is_wanted():
    _, found = built_on([shapely.box(0, 0, 120, 90)], "core", height=112.0)
    tags = found.tags()
    assert {own["height"] for own in tags if "building" in own} == {"112.0"}
    assert {own["height"] for own in tags if own.get("building:part")} >= {"112.0"}


def test_a_zone_that_is_none_is_named():
    parcels, _ = built_on([shapely.box(0, 0, 120, 60)], "row")
    count = len(parcels.shapes)
    with pytest.raises(UsageError, match="zones moon are none of core, midrise"):
        footprints_of(parcels, ["moon"] * count, np.zeros(count), np.zeros(count), seed=0)


@pytest.mark.parametrize("zone", ZONES)
def test_a_layout_is_made_of_every_zone(zone):
    _, found = built_on([shapely.box(20, 20, 170, 90)], zone)
    report = Report()
    features = gather(found, (0.0, 0.0, 200.0, 120.0), report)
    layout = resolve(features, Frame(52.0, 13.0), seed=1)
    assert len(layout.buildings) == rows(found, "building").sum()
    assert report.counts == {}
    assert not report.failures


STREETS = ("residential", "living_street", "tertiary", "secondary", "primary", "unclassified")
REAL = ("new_york_east_village.osm.gz", "harrisburg_pa_access.osm.gz", "london_camberwell.osm")


@pytest.mark.sweep(4)
@pytest.mark.shared
@pytest.mark.slow
@pytest.mark.parametrize("name", REAL)
@pytest.mark.parametrize("zone", ["core", "midrise", "row", "suburb"])
def test_blocks_of_real_towns_are_cut_and_built_on(name, zone, shared_osm):
    roads = read_osm(shared_osm(name)).layout.roads
    lines = roads.geometry.to_numpy()[roads["kind"].isin(STREETS).to_numpy()]
    faces = shapely.polygonize([shapely.node(shapely.multilinestrings(lines))])
    streets = shapely.union_all(shapely.buffer(lines, 6.0))
    blocks = shapely.get_parts(shapely.difference(shapely.get_parts(faces), streets))
    blocks = shapely.get_parts(shapely.set_precision(shapely.simplify(blocks, 0.3), 1e-3))
    blocks = blocks[(shapely.area(blocks) > 200) & (shapely.area(blocks) < 150_000)]
    parcels, found = built_on(blocks, zone)
    area = shapely.area(blocks)
    assert np.allclose(
        np.bincount(parcels.block, shapely.area(parcels.shapes)), area, rtol=1e-9, atol=0
    )
    assert shapely.length(parcels.street).min() > DOOR
    assert shapely.is_valid(found.shapes).all()
    houses = found.shapes[rows(found, "building")]
    a, b = shapely.STRtree(houses).query(houses, predicate="intersects")
    assert (
        shapely.area(shapely.intersection(houses[a[a < b]], houses[b[a < b]])).max(initial=0.0)
        < 1e-6
    )
    assert len(houses) > 0.8 * len(parcels.shapes)
