import numpy as np
import pytest
import shapely

from cityx.ids import stable_id

TOWER = {"building__part": "yes", "height": 40}


def parts_of(city):
    return city.layout.parts.sort_values("top").reset_index(drop=True)


def test_a_building_keeps_its_courtyard_and_its_id(drawing):
    outer = drawing.box(0, 0, 30, 30)
    inner = drawing.box(10, 10, 10, 10)
    key = drawing.relation(
        [(outer, "outer"), (inner, "inner")], type="multipolygon", building="apartments"
    )
    building = drawing.city().layout.buildings.iloc[0]
    assert building["id"] == stable_id("osm", "relation", key)
    assert building["source"] == f"osm/relation/{key}"
    assert building.geometry.area == pytest.approx(800, rel=0.01)


def test_a_relation_without_tags_takes_those_of_its_outer_way(drawing):
    outer = drawing.box(0, 0, 30, 30, building="yes", height=9)
    inner = drawing.box(10, 10, 10, 10)
    drawing.relation([(outer, "outer"), (inner, "inner")], type="multipolygon")
    buildings = drawing.city().layout.buildings
    assert len(buildings) == 1
    assert buildings.geometry.iloc[0].area == pytest.approx(800, rel=0.01)
    assert buildings["height"].iloc[0] == 9


def test_parts_replace_the_outline(drawing):
    way = drawing.box(0, 0, 20, 10, building="office", height=40)
    drawing.box(0, 0, 10, 10, height=12, building__part="yes")
    drawing.box(10, 0, 10, 10, **TOWER)
    city = drawing.city()
    parts = parts_of(city)
    assert parts["top"].tolist() == [12, 40]
    assert set(parts["building"]) == {stable_id("osm", "way", way)}
    assert city.layout.buildings["height"].tolist() == [40]


def test_what_parts_leave_uncovered_is_raised_too(drawing):
    drawing.box(0, 0, 40, 10, building="office", building__levels=3, roof__shape="flat")
    drawing.box(0, 0, 10, 10, **TOWER)
    parts = parts_of(drawing.city())
    assert len(parts) == 2
    assert parts["levels"].iloc[0] == 3
    assert parts.geometry.area.tolist() == pytest.approx([300, 100], rel=0.01)


@pytest.mark.parametrize(
    ("own", "low"),
    [
        ({"building": "civic", "height": 10}, [{"height": 3}]),
        ({"building": "church", "height": 18}, [{"height": 8}, {"height": 4}]),
        ({"building": "apartments", "height": 14}, [{"building__levels": 1}, {"height": 3}]),
        ({"building": "office", "building__height": "60 ft"}, [{"height": "9'"}]),
    ],
)
def test_the_rest_beside_lower_parts_keeps_the_height_of_the_outline(drawing, own, low):
    drawing.box(0, 0, 40, 30, **own)
    for k, said in enumerate(low):
        drawing.box(10 * k, 0, 10, 30, building__part="yes", **said)
    parts = parts_of(drawing.city())
    highest = parts[parts["top"] > parts["top"].max() - 0.1]
    stated = 18.288 if "building__height" in own else own["height"]
    assert highest["top"].tolist() == pytest.approx([stated])
    assert highest.geometry.area.tolist() == pytest.approx([(40 - 10 * len(low)) * 30], rel=0.01)


def test_the_rest_beside_the_part_that_the_outline_is_as_high_as_is_lower(drawing):
    drawing.box(0, 0, 40, 10, building="office", height=40)
    drawing.box(0, 0, 10, 10, **TOWER)
    assert parts_of(drawing.city())["top"].tolist() == [14, 40]


def test_less_than_a_tenth_uncovered_is_left_alone(drawing):
    drawing.box(0, 0, 20, 10, building="office", height=40)
    drawing.box(0, 0, 19, 10, **TOWER)
    assert len(drawing.city().layout.parts) == 1


def test_parts_may_stand_on_each_other(drawing):
    drawing.box(0, 0, 20, 20, building="office", height=40)
    drawing.box(0, 0, 20, 20, building__part="yes", height=10)
    drawing.box(5, 5, 10, 10, building__part="yes", min_height=10, height=40)
    parts = parts_of(drawing.city())
    assert parts["base"].tolist() == [0, 10]
    assert parts.geometry.area.tolist() == pytest.approx([400, 100], rel=0.01)


def test_what_begins_lower_than_a_step_stands_on_the_ground(drawing):
    drawing.box(0, 0, 20, 20, building="house", min_height="0.1", height=6)
    drawing.box(40, 0, 20, 20, building="roof", min_height="2.5", height=6)
    assert sorted(drawing.city().layout.parts["base"]) == [0.0, 2.5]


def test_parts_that_overlap_in_height_too_become_disjoint_with_the_same_union(drawing):
    drawing.box(0, 0, 20, 20, building="office", height=40)
    drawing.box(0, 0, 20, 20, building__part="yes", height=10)
    drawing.box(5, 5, 10, 10, building__part="yes", height=40)
    parts = parts_of(drawing.city())
    volume = (parts.geometry.area * (parts["top"] - parts["base"])).sum()
    assert volume == pytest.approx(300 * 10 + 100 * 40, rel=0.01)
    assert shapely.area(shapely.intersection(*parts.geometry)) < 0.5


def test_parts_without_an_outline_form_a_building(drawing):
    drawing.box(0, 0, 10, 10, **TOWER)
    drawing.box(10, 0, 10, 10, building__part="yes", height=5)
    drawing.box(100, 0, 10, 10, building__part="yes", height=5)
    city = drawing.city()
    assert len(city.layout.buildings) == 2
    assert set(city.layout.parts["building"]) == set(city.layout.buildings["id"])


def test_the_height_includes_the_roof(drawing):
    drawing.box(
        0, 0, 10, 8, building="house", height="9 m", roof__height=3, roof__shape="gabled"
    )  # fmt: skip
    part = drawing.city().layout.parts.iloc[0]
    assert (part["top"], part["roof_height"], part["roof_shape"]) == (9, 3, "gabled")
    assert part["levels"] == 2


def test_levels_do_not_include_the_roof(drawing):
    drawing.box(0, 0, 10, 8, building="house", building__levels=2, roof__shape="gabled",
                roof__angle=45)  # fmt: skip
    part = drawing.city().layout.parts.iloc[0]
    assert part["top"] - part["roof_height"] == pytest.approx(5.6)
    assert part["roof_height"] == pytest.approx(4, rel=0.02)
    assert part["levels"] == 2


@pytest.mark.parametrize(
    "tags",
    [
        {"height": "1e9"}, {"height": "-5"}, {"building__levels": "1000000"}, {"height": "nan"},
        {"min_height": "50", "height": "10"}, {"roof__height": "99", "height": "5"},
        {"building__levels": "0"}, {"building__levels": "0", "roof__shape": "gabled"},
        {"building__min_level": "9", "building__levels": "3"}, {"building__levels": "nan"},
    ],
)  # fmt: skip
def test_senseless_heights_become_sane_ones(tags, drawing):
    drawing.box(0, 0, 10, 8, building="yes", **tags)
    part = drawing.city().layout.parts.iloc[0]
    assert 0 <= part["base"] < part["top"] <= 120
    assert 0 <= part["roof_height"] < part["top"] - part["base"]
    assert part["levels"] >= 1


def test_what_lies_underground_is_not_built(drawing):
    drawing.box(0, 0, 10, 10, building="yes")
    drawing.box(20, 0, 10, 10, building="parking", location="underground")
    drawing.box(40, 0, 10, 10, building="yes", layer=-1)
    drawing.box(60, 0, 10, 10, building="no")
    assert len(drawing.city().layout.buildings) == 1


def test_canopies_have_no_walls(drawing):
    drawing.box(0, 0, 10, 10, building="roof")
    part = drawing.city().layout.parts.iloc[0]
    assert not part["walls"]
    assert part["roof_shape"] == "flat"


def test_towers_are_raised_from_outlines_and_points(drawing):
    drawing.box(0, 0, 5, 5, man_made="chimney", height=60)
    drawing.node(8, -6, man_made="water_tower")
    buildings = drawing.city().layout.buildings.sort_values("height")
    assert buildings["use"].tolist() == ["water_tower", "chimney"]
    assert buildings["height"].tolist() == [30, 60]


def test_a_building_drawn_twice_is_built_once(drawing):
    drawing.box(0, 0, 10, 10, building="yes")
    drawing.box(0, 0, 10, 10.2, building="yes", height=12)
    city = drawing.city()
    assert city.layout.buildings["height"].tolist() == [12]
    assert any(note.startswith("map: 1 buildings are drawn twice: osm/way/") for note in city.notes)


def test_ways_of_one_ring_that_run_over_each_other_enclose_a_building(drawing):
    first = drawing.way([(0, 0), (0, 6), (0, 20), (20, 20), (20, 10)])
    second = drawing.way([(20, 10), (0, 6), (0, 0)])
    house = drawing.relation([(first, "outer"), (second, "outer")], type="multipolygon",
                             building="yes", height=9)  # fmt: skip
    drawing.box(40, 0, 10, 10, building="yes")
    city = drawing.city()
    built = city.layout.buildings[city.layout.buildings["source"] == f"osm/relation/{house}"]
    assert built.geometry.area.tolist() == pytest.approx([240.0], rel=0.01)
    assert built["height"].tolist() == [9.0]
    assert any("were mended" in note and f"osm/relation/{house}" in note for note in city.notes)


def test_a_building_that_parts_of_another_cover_is_named(drawing):
    shop = drawing.box(2, 2, 6, 6, building="yes", name="Hats")
    drawing.box(0, 0, 30, 12, building="yes", name="Hall")
    drawing.box(0, 0, 30, 12, building__part="yes", height=12)
    city = drawing.city()
    assert city.layout.buildings["name"].tolist() == ["Hall"]
    assert f"map: 1 buildings are covered by the parts of others: osm/way/{shop}" in city.notes


@pytest.mark.parametrize(("own", "names"), [("Inn", ["Inn", "Mews"]), ("Mews", ["Mews"])])
def test_an_outer_way_with_a_name_of_its_own_is_a_building_of_its_own(drawing, own, names):
    first = drawing.box(0, 0, 10, 10, building="yes", name=own)
    second = drawing.box(10, 0, 10, 10)
    drawing.relation([(first, "outer"), (second, "outer")], type="multipolygon", building="yes",
                     name="Mews")  # fmt: skip
    buildings = drawing.city().layout.buildings
    assert sorted(set(buildings["name"])) == names
    assert buildings.geometry.area.sum() == pytest.approx(200.0, rel=0.01)


@pytest.mark.parametrize("value", ["entrance", "demolished", "proposed", "Collapsed"])
def test_an_outline_of_which_nothing_stands_is_named(drawing, value):
    drawing.box(0, 0, 10, 10, building=value, levels="2")
    drawing.box(20, 0, 10, 10, building="yes")
    drawing.box(40, 0, 10, 10, building="no")
    city = drawing.city()
    assert len(city.layout.buildings) == 1
    word = f"map: 1 outlines of building={value.lower()} are of no building that stands: osm/way/"
    assert [note.startswith(word) for note in city.notes if "outlines of" in note] == [True]


def test_a_pile_of_houses_on_one_spot_is_named_and_the_rest_stands(drawing):
    for number in range(300):
        drawing.box(0.01 * (number % 20), 0.02 * (number // 20), 10, 10, building="yes")
    drawing.box(10.3, 0, 10, 10, building="house", name="beside")
    drawing.box(2, 2, 3, 3, building="yes", name="in it")
    drawing.box(40, 0, 10, 10, building="house", name="far")
    city = drawing.city()
    assert {"beside", "in it", "far"} < set(city.layout.buildings["name"])
    assert len(city.layout.buildings) == 4
    assert any(note.startswith("map: 299 buildings are piled on one spot") for note in city.notes)


@pytest.mark.parametrize(("tags", "where"), [
    ({"level": "-1", "height": "4"}, "below the ground"),
    ({"level": "-2;-1", "building:levels": "2"}, "below the ground"),
    ({"location": "underground", "height": "12"}, "below the ground"),
    ({"building:levels": "0", "building:levels:underground": "3"}, "below the ground"),
    ({"layer": "-1", "parking": "underground", "location": "surface"}, "below the ground"),
    ({"indoor": "room", "height": "3", "level": "1"}, "within houses"),
    ({"indoor": "yes", "height": "3", "level": "0"}, "within houses"),
])  # fmt: skip
def test_what_cannot_be_seen_from_the_street_is_named_not_raised(drawing, tags, where):
    drawing.box(0, 0, 10, 10, building="yes")
    hidden = drawing.box(20, 0, 10, 10, building="yes", **tags)
    city = drawing.city()
    assert len(city.layout.buildings) == 1
    assert f"map: 1 buildings lie {where} and are not raised: osm/way/{hidden}" in city.notes


@pytest.mark.parametrize("tags", [
    {"building:levels": "5", "building:levels:underground": "2", "parking": "underground"},
    {"layer": "-1", "height": "6"}, {"level": "-1;0"}, {"indoor": "yes"},
])  # fmt: skip
def test_what_rises_above_the_ground_is_raised(drawing, tags):
    drawing.box(0, 0, 10, 10, building="yes", **tags)
    assert len(drawing.city().layout.buildings) == 1


def test_overlapping_outlines_become_disjoint(drawing):
    drawing.box(0, 0, 20, 10, building="yes")
    drawing.box(15, 0, 10, 10, building="yes")
    drawing.box(2, 2, 3, 3, building="yes")
    shapes = drawing.city().layout.buildings.geometry
    assert shapely.area(shapely.union_all(shapes)) == pytest.approx(250, rel=0.01)
    assert shapes.area.sum() == pytest.approx(250, rel=0.01)


def test_colours_and_materials_are_kept_and_inherited(drawing):
    drawing.box(0, 0, 20, 10, building="yes", building__colour="#aabbcc",
                building__material="Brick", roof__colour="red")  # fmt: skip
    drawing.box(0, 0, 10, 10, building__part="yes", height=8, building__colour="white")
    drawing.box(10, 0, 10, 10, building__part="yes", height=9)
    parts = parts_of(drawing.city())
    assert parts["wall_color"].tolist() == [0xFFFFFF, 0xAABBCC]
    assert parts["roof_color"].tolist() == [0xFF0000] * 2
    assert parts["wall_material"].tolist() == ["brick"] * 2


def test_a_bow_tie_becomes_its_two_triangles(drawing):
    drawing.way([(0, 0), (20, 20), (20, 0), (0, 20), (0, 0)], building="yes")
    buildings = drawing.city().layout.buildings
    assert len(buildings) == 2
    assert shapely.is_valid(buildings.geometry).all()
    assert buildings["id"].is_unique


def test_an_outline_of_two_points_is_reported(drawing):
    drawing.box(0, 0, 10, 10, building="yes")
    way = drawing.way([(30, 0), (40, 0)], building="yes")
    failure = drawing.city().failures[0]
    assert failure.object_id == stable_id("osm", "way", way)
    assert "fewer than three" in failure.error


def test_other_tags_tell_the_type_of_a_building_that_only_says_yes(drawing):
    drawing.box(0, 0, 20, 40, building="yes", amenity="place_of_worship")
    part = drawing.city(seed=3).layout.parts.iloc[0]
    assert part["top"] - part["roof_height"] >= 8


def test_random_choices_depend_on_the_building_alone(drawing):
    for index in range(20):
        drawing.box(30 * index, 0, 12, 9, building="house")
    alone = drawing.city(seed=5).layout.parts.set_index("id")
    for index in range(20):
        drawing.box(30 * index, 60, 12, 9, building="house")
    more = drawing.city(seed=5).layout.parts.set_index("id").loc[alone.index]
    for column in ("roof_shape", "levels"):
        assert more[column].tolist() == alone[column].tolist()
    other = drawing.city(seed=6).layout.parts.set_index("id").loc[alone.index]
    assert not np.allclose(other["roof_height"], more["roof_height"])


def noted(city, words):
    """Return the note that has some words, or ""."""
    return next((note for note in city.notes if words in note), "")


@pytest.mark.parametrize(
    ("key", "wrong"),
    [
        ("height", ["banana", "-50", "tall", "1e9"]),
        ("building:levels", ["1000000", "-2", "many"]),
        ("roof:direction", ["up", "left", "Nord"]),
        ("roof:shape", ["banana", "7", "nice"]),
        ("min_height", ["-3", "x", "40"]),
    ],
)
def test_values_that_cannot_be_used_are_counted_with_their_ids(drawing, key, wrong):
    tags = {"building": "house", "height": "9"}
    named = [
        drawing.box(20 * k, 0, 10, 10, **{**tags, key: value}) for k, value in enumerate(wrong)
    ]
    drawing.box(200, 0, 10, 10, building="house", height="9 m", building__levels="2")
    city = drawing.city()
    note = noted(city, f"values of {key} cannot be used")
    assert note.startswith(f"map: {len(wrong)} ")
    assert set(note.split(": ")[2].split(", ")) == {f"osm/way/{way}" for way in named}
    assert len(city.layout.buildings) == len(wrong) + 1
    assert city.layout.parts["top"].between(2, 40).all()


def test_outlines_that_are_mended_are_counted_with_their_ids(drawing):
    open_ = [
        drawing.way([(x, 0), (x + 10, 0), (x + 10, 10), (x, 10)], building="yes")
        for x in (0, 20, 40)
    ]
    bows = [
        drawing.way([(x, 40), (x + 10, 50), (x + 10, 40), (x, 50), (x, 40)], building="yes")
        for x in (0, 20, 40)
    ]
    drawing.box(80, 0, 10, 10, building="yes")
    city = drawing.city()
    for words, ways in (("not closed", open_), ("cross or touch themselves", bows)):
        assert all(f"osm/way/{way}" in noted(city, words) for way in ways)
        assert noted(city, words).startswith("map: 3 ")


def test_relations_without_members_are_counted_and_all_named(drawing):
    drawing.box(0, 0, 10, 10, building="yes")
    numbers = [
        drawing.relation([(90_000 + k, "outer")], type="multipolygon", building="yes")
        for k in range(12)
    ]
    note = noted(drawing.city(), "no member")
    assert note.startswith("map: 12 ")
    assert all(f"osm/relation/{number}" in note for number in numbers)
