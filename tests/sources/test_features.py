import numpy as np
import shapely

from cityx.city import Frame
from cityx.sources.features.gather import gather
from cityx.sources.features.resolve import resolve
from cityx.sources.features.tagged import KIND, Owner, Report, tag

BOX = (0.0, 0.0, 200.0, 200.0)


def found(*pairs):
    owners = [Owner(("made", index), tags) for index, (_, tags) in enumerate(pairs)]
    return tag([shape for shape, _ in pairs], owners)


def layout_of(*pairs, report=None):
    features = gather(found(*pairs), BOX, report or Report())
    return resolve(features, Frame(52.0, 13.0), seed=1)


def test_shapes_are_sorted_by_what_their_tags_mean():
    square = shapely.box(50, 50, 60, 60)
    report = Report()
    layout = layout_of(
        (square, {"building": "house", "building:levels": "2", "roof:shape": "flat"}),
        (shapely.box(100, 0, 200, 100), {"leisure": "park"}),
        (shapely.LineString([(0, 20), (200, 20)]), {"highway": "residential", "name": "Mill Lane"}),
        (shapely.LineString([(0, 90), (90, 90)]), {"barrier": "hedge"}),
        (shapely.Point(10, 10), {"natural": "tree"}),
        (shapely.Point(11, 10), {"mood": "good"}),
        report=report,
    )
    assert layout.buildings["levels"].tolist() == [2]
    assert layout.parts["roof_shape"].tolist() == ["flat"]
    assert layout.areas["kind"].tolist() == ["park"]
    assert layout.roads[["kind", "name"]].to_numpy().tolist() == [["residential", "Mill Lane"]]
    assert layout.lines["kind"].tolist() == ["hedge"]
    assert layout.points["kind"].tolist() == ["tree"]
    assert report.counts == {"features without a use": 1}


def test_shapes_are_cut_at_the_site_and_pieces_get_ids_of_their_own():
    bend = shapely.LineString([(-50, 20), (50, 20), (50, -40), (90, -40), (90, 30)])
    layout = layout_of(
        (shapely.box(80, 80, 90, 90), {"building": "yes"}),
        (bend, {"highway": "service"}),
        (shapely.box(-100, 150, 100, 400), {"natural": "water"}),
        (shapely.Point(500, 10), {"natural": "tree"}),
    )
    assert len(layout.roads) == 2
    assert len(set(layout.roads["id"])) == 2
    assert set(layout.roads["source"]) == {"made/1"}
    assert 5000 <= layout.areas.geometry.area.sum() < 5050
    assert not len(layout.points)


def test_a_collection_is_taken_apart():
    two = shapely.MultiPolygon([shapely.box(10, 10, 20, 20), shapely.box(30, 10, 40, 20)])
    layout = layout_of((two, {"building": "yes"}))
    assert len(layout.buildings) == 2


def test_the_layout_has_words_of_its_own():
    layout = layout_of(
        (shapely.box(0, 0, 50, 50), {KIND: "sea"}),
        (shapely.box(60, 60, 90, 90), {KIND: "residential"}),
        (shapely.LineString([(0, 60), (50, 60)]), {KIND: "tram"}),
        (shapely.Point(5, 5), {KIND: "bench"}),
        (shapely.Point(5, 6), {KIND: "nonsense"}),
    )
    assert sorted(layout.areas["kind"]) == ["residential", "sea"]
    assert layout.roads["kind"].tolist() == ["tram"]
    assert layout.points["kind"].tolist() == ["bench"]


def test_the_order_of_features_changes_nothing():
    pairs = [
        (shapely.box(10 * i, 5 * i, 10 * i + 8, 5 * i + 8), {"building": "yes"}) for i in range(12)
    ]
    owners = [Owner(("made", index), tags) for index, (_, tags) in enumerate(pairs)]
    shapes = [shape for shape, _ in pairs]
    order = np.random.default_rng(0).permutation(12).tolist()
    one = gather(tag(shapes, owners), BOX, Report())
    other = gather(tag([shapes[i] for i in order], [owners[i] for i in order]), BOX, Report())
    first, second = (resolve(f, Frame(52.0, 13.0), seed=1) for f in (one, other))
    assert first.parts.equals(second.parts)
    assert first.buildings.equals(second.buildings)


def test_a_small_ring_driven_one_way_is_a_roundabout():
    turn = np.linspace(0, 2 * np.pi, 13)
    ring = np.column_stack([np.cos(turn), np.sin(turn)])
    small, wide = (shapely.LineString(100 + radius * ring) for radius in (8, 60))
    one_way = {"highway": "residential", "oneway": "yes"}
    layout = layout_of(
        (small, one_way), (wide, one_way), (small, {"highway": "residential"}),
        (shapely.LineString([(0, 0), (20, 0)]), one_way),
    )  # fmt: skip
    found = layout.roads.set_index("source")["roundabout"]
    assert found[["made/0", "made/1", "made/2", "made/3"]].tolist() == [True, False, False, False]


def test_barriers_drawn_as_polygons_are_thick_or_go_round_what_else_they_are():
    layout = layout_of(
        (shapely.box(80, 80, 90, 90), {"building": "yes", "barrier": "wall"}),
        (shapely.box(0, 0, 40, 2), {"barrier": "city_wall"}),
        (shapely.box(0, 20, 40, 60), {"barrier": "hedge", "leisure": "garden"}),
        (shapely.box(60, 20, 80, 40), {"barrier": "fence"}),
    )
    lines = layout.lines.set_index("kind").geometry
    assert lines["city_wall"].equals(shapely.box(0, 0, 40, 2))
    assert lines["hedge"].length == 160.0
    assert lines["fence"].geom_type == "LineString"
    assert layout.areas["kind"].tolist() == ["garden"]
    assert len(layout.buildings) == 1
    assert "wall" not in lines.index
    assert not set(layout.lines["id"]) & set(layout.areas["id"])
