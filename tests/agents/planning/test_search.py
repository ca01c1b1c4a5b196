import random
import time

from cityx.agents.planning.search import LAYOUT, STAGE, Node, Operator, Reached

IMAGE = ("image", "semantic_map")
POINTS, FACES, LINES = ("point", "semantic"), ("surface", "semantic"), ("line", "road")


def op(action, needs, gives, cost=1.0, reads=()):
    return Operator(action, tuple(needs), tuple(reads), tuple(gives), cost)


def names(found, node):
    return [use.operator.action for use in found.uses([node])]


def test_the_cheapest_way_is_taken():
    ways = [op("a/direct-v1", [IMAGE], [LAYOUT], 5.0), op("b/points-v1", [IMAGE], [POINTS]),
            op("c/faces-v1", [POINTS], [FACES]), op("d/layout-v1", [FACES], [LAYOUT])]  # fmt: skip
    found = Reached(ways, [Node(IMAGE)])
    assert names(found, found.best(LAYOUT)) == ["b/points-v1", "c/faces-v1", "d/layout-v1"]


def test_what_a_user_handed_in_is_not_passed_over_for_what_is_cheaper():
    ways = [op("a/town-v1", [], [LAYOUT], 0.1), op("b/map-v1", [IMAGE], [LAYOUT], 9.0)]
    found = Reached(ways, [Node(IMAGE, frozenset({0}))])
    assert names(found, found.best(LAYOUT)) == ["a/town-v1"]
    assert names(found, found.best(LAYOUT, origin=frozenset({0}))) == ["b/map-v1"]


def test_a_reader_takes_all_inputs_at_once():
    osm = ("geographic_data", "osm")
    ways = [op("a/inputs-v1", [], [LAYOUT], 1.0, reads=[osm, IMAGE])]
    found = Reached(ways, [Node(osm, frozenset({0})), Node(IMAGE, frozenset({1}))])
    assert found.best(LAYOUT, origin=frozenset({0, 1})).origin == {0, 1}
    assert Reached(ways, []).best(LAYOUT) is None


def test_stages_are_needs_like_any_other():
    ways = [op("a/town-v1", [], [LAYOUT, (STAGE, "layout")]),
            op("b/road-v1", [(STAGE, "layout")], [LINES])]  # fmt: skip
    found = Reached(ways, [])
    assert names(found, found.best(LINES)) == ["a/town-v1", "b/road-v1"]
    assert Reached(ways[1:], []).best(LINES) is None


def test_several_goals_share_what_they_need():
    ways = [op("a/points-v1", [IMAGE], [POINTS]), op("b/lines-v1", [POINTS], [LINES]),
            op("c/faces-v1", [POINTS], [FACES])]  # fmt: skip
    found = Reached(ways, [Node(IMAGE)])
    goals = [found.best(LINES), found.best(FACES)]
    assert [use.operator.action for use in found.uses(goals)] == [
        "a/points-v1", "b/lines-v1", "c/faces-v1",
    ]  # fmt: skip


def test_the_order_of_operators_does_not_count():
    ways = [op(f"x/{n}-v1", [IMAGE], [POINTS if n % 2 else LINES]) for n in range(20)]
    ways += [op("y/join-v1", [POINTS, LINES], [FACES])]
    first = Reached(ways, [Node(IMAGE)])
    random.Random(1).shuffle(ways)
    again = Reached(ways, [Node(IMAGE)])
    assert names(first, first.best(FACES)) == names(again, again.best(FACES))


def test_four_hundred_actions_take_a_fifth_of_a_second():
    draw = random.Random(4)
    facts = [(f"format{draw.randrange(14)}", f"role{n}") for n in range(120)]
    ways = [
        op(f"s/a{n:03d}-v1", draw.sample(facts, draw.randrange(1, 4)), [draw.choice(facts)],
           draw.uniform(0.5, 3.0))
        for n in range(400)
    ]  # fmt: skip
    start = [Node(fact, frozenset({n % 3})) for n, fact in enumerate(facts[:12])]
    begin = time.process_time()
    found = Reached(ways, start)
    found.uses([node for fact in facts if (node := found.best(fact))])
    assert time.process_time() - begin < 0.2
    assert len(found.cost) > 50
