"""Places that other objects tell: the ground of them, and what lies there."""

import numpy as np
import pytest
import shapely

from cityx.checks.predicates import measure
from cityx.city import City, Frame, Layout
from cityx.city.content import content_hash
from cityx.language import Reference, Selector, read_brief
from cityx.language.references.resolved_changes import slots_of_edits
from cityx.language.references.selecting import Open, choose, place_of
from cityx.town.town import town
from cityx.town.wishes.river import river

B05, B22 = Selector(ids=("b05",)), Selector(ids=("b22",))


def shape_of(city, name):
    (shape,) = city.layout.buildings.loc[city.layout.buildings["name"] == name].geometry
    return shape


@pytest.mark.parametrize("key", ["before", "behind", "opposite"])
def test_the_ground_of_a_view_lies_apart_from_that_of_the_others(key, scene):
    city = scene("grid_s")
    own = place_of(Reference(key, (B05,)), city)
    others = [place_of(Reference(other, (B05,)), city)
              for other in {"before", "behind", "opposite"} - {key}]  # fmt: skip
    assert own.area > 50.0
    house = shape_of(city, "b05")
    assert all(own.difference(house).intersection(other).area < own.area / 2 for other in others)


def test_what_lies_across_the_street_is_beyond_it(scene):
    city = scene("grid_s")
    ground = place_of(Reference("opposite", (B05,)), city)
    house = shape_of(city, "b05")
    lines = shapely.shortest_line(house, shapely.get_parts(ground))
    roads = city.layout.roads.geometry.union_all()
    assert shapely.intersects(lines, roads).all()


def test_between_two_places_leads_from_one_to_the_other(scene):
    city = scene("grid_s")
    way = place_of(Reference("between", (B05, B22)), city)
    assert all(way.distance(shape_of(city, name)) < 0.01 for name in ("b05", "b22"))
    found = choose(Selector("tree", where=(Reference("between", (B05, B22)),)), city)
    assert 0 < found.count < choose(Selector("tree"), city).count


def test_an_end_of_a_park_is_a_third_of_it(scene):
    city = scene("park_s")
    park = city.layout.areas.set_index("name").loc["park1", "geometry"]
    end = place_of(Reference("end", (Selector("park"),), side="west"), city)
    assert park.covers(end.buffer(-0.01))
    assert end.bounds[2] <= park.bounds[0] + (park.bounds[2] - park.bounds[0]) / 3 + 1e-6


@pytest.mark.parametrize(("far", "missed"), [(30.0, 6.0), (60.0, 12.0), (150.0, 20.0)])
def test_a_distance_that_is_told_is_missed_by_a_part_of_it(far, missed, scene):
    city = scene("grid_s")
    house, off = shape_of(city, "b05"), Reference("off", (B05,), far)
    ring = place_of(off, city)
    assert ring.distance(house) == pytest.approx(far - missed, rel=0.01)
    assert shapely.hausdorff_distance(ring, house) > far
    trees = choose(Selector("tree", where=(off,)), city)
    away = shapely.distance(choose(Selector("tree"), city).shapes, house)
    assert trees.count == np.count_nonzero(np.abs(away - far) <= missed)


def test_a_place_of_nothing_is_asked_about(scene):
    with pytest.raises(Open, match="There is no church"):
        place_of(Reference("behind", (Selector("church", alone=True),)), scene("grid_s"))


@pytest.mark.parametrize(
    ("text", "goal"),
    [
        ("Put a bench in front of b05.", "before(bench, b05)"),
        ("There should be a fountain between b05 and b22.", "between(fountain, b05, b22)"),
        ("Could you set up a kiosk within 30 m of b05?", "dist(kiosk, b05) <= 30"),
        ("We need a bench across from b05, or rather opposite b05.", ""),
    ],
)
def test_what_is_added_stands_where_it_is_measured(text, goal, scene):
    from cityx.edit.land.add import add
    from cityx.language.references.goals_here import with_goals_here

    city, brief = scene("grid_s"), read_brief(text, base=True)
    if not goal:
        assert brief.questions
        return
    ((_edit, slots),) = changes = slots_of_edits(brief, city)
    goals = {one.predicate.replace('"', "") for one in with_goals_here(brief, changes).goals}
    assert goal in goals
    made = add(city, thing=str(slots["element"][0]), ground=slots["ground"][0])
    assert measure(goal, made).met
    again = add(city, thing=str(slots["element"][0]), ground=slots["ground"][0])
    assert content_hash(again).total == content_hash(made).total


def test_exceptions_and_the_rest_part_a_kind(scene):
    city = scene("grid_s")
    tall = Selector("building", rank="tallest", k=3)
    rest = choose(Selector("building", but=(tall,)), city)
    both = np.concatenate([rest.ids, choose(tall, city).ids])
    assert sorted(both.tolist()) == sorted(choose(Selector("building"), city).ids.tolist())


def test_each_house_takes_over_from_its_own_neighbours(scene):
    city = scene("grid_s")
    brief = read_brief("Make b05 and b22 one floor taller than their neighbours.", base=True)
    assert len(slots_of_edits(brief, city)) == 2


def test_the_houses_that_face_water_are_those_in_the_front_row():
    city = City("Town", Frame(50.0, 10.0), Layout((0.0, 0.0, 1.0, 1.0)), seed=5)
    city = river(town(city, width=400.0, depth=300.0, pattern="grid", zone="suburb"))
    water = shapely.union_all(
        city.layout.areas.geometry.to_numpy()[city.layout.areas["kind"] == "river"]
    )
    shapes = city.layout.buildings.geometry.to_numpy()
    lines = shapely.shortest_line(shapes, water)
    hidden = np.array([
        any(line.intersects(other) for at, other in enumerate(shapes.tolist()) if at != row)
        for row, line in enumerate(lines.tolist())
    ])  # fmt: skip
    front = ~hidden & (shapely.distance(shapes, water) <= 70.0)
    assert front.any()
    for link in ("facing", "along"):
        text = f"Make the buildings {link} the river red."
        (edit,) = read_brief(text, base=True).edits
        chosen = choose(edit.target, city)
        wanted = city.layout.buildings["id"].to_numpy(np.uint64)[front]
        assert set(chosen.ids.tolist()) == set(wanted.tolist()), text


def test_what_is_chosen_on_a_side_of_a_park_lies_where_things_are_put_there(scene):
    city = scene("park_s")
    park = city.layout.areas.set_index("name").loc["park1", "geometry"]
    side = Reference("side", (Selector("park", ids=("park1",)),), side="north")
    ground, found = place_of(side, city), choose(Selector("tree", where=(side,)), city)
    assert found.count
    assert park.buffer(0.01).covers(ground)
    assert shapely.intersects(shapely.centroid(found.shapes), ground).all()
