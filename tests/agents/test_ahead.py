from dataclasses import replace

import numpy as np
import pytest

from cityx.agents.ahead import Clash, changed, difference
from cityx.city.city import City, Failure
from cityx.city.frame import NOWHERE
from cityx.city.layout import Layout
from cityx.city.mesh import one_mesh
from cityx.city.scene import Prototype, Scene, no_instances

CORNERS = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])


def triangle(object_id):
    return one_mesh(object_id, CORNERS, np.array([[0, 1, 2]]), materials=("plaster",))


def town(**parts):
    return City("town", NOWHERE, Layout((0.0, 0.0, 9.0, 9.0)), **parts)


def with_layer(city, name):
    return replace(city, scene=city.scene.with_mesh(name, triangle(1)))


def test_both_sides_add_to_a_city():
    start = town(notes=("read",), made={"layout": {}})
    houses = replace(
        with_layer(start, "buildings"),
        stages_done=frozenset({"building"}), made={"layout": {}, "shell": {"parapet": True}},
        failures=(Failure(3, "shell", "raised as a block"),), notes=("read", "a roof became flat"),
    )  # fmt: skip
    streets = replace(
        with_layer(start, "ground"), stages_done=frozenset({"road"}), notes=("read", "a tunnel"),
        made={"layout": {}, "ground": {}},
    )  # fmt: skip
    both = changed(streets, start, difference(start, houses))
    assert list(both.scene.meshes) == ["ground", "buildings"]
    assert both.scene.meshes["buildings"] is houses.scene.meshes["buildings"]
    assert both.stages_done == {"building", "road"}
    assert list(both.made) == ["layout", "ground", "shell"]
    assert both.notes == ("read", "a tunnel", "a roof became flat")
    assert both.failures == houses.failures


@pytest.mark.parametrize("part", [{"seed": 7}, {"layout": Layout((0.0, 0.0, 5.0, 5.0))}])
def test_both_sides_cannot_change_the_same(part):
    start = town()
    other = replace(start, **{name: type(value)(*"3") if name == "seed" else Layout((0, 0, 1, 1))
                              for name, value in part.items()})  # fmt: skip
    with pytest.raises(Clash):
        changed(other, start, difference(start, replace(start, **part)))


def test_both_sides_cannot_add_prototypes_since_rows_count_them():
    start = town()
    sides = [
        replace(start, scene=Scene().with_instances(
            layer, [Prototype(layer, "tree", triangle(1))], no_instances()))
        for layer in ("trees", "windows")
    ]  # fmt: skip
    with pytest.raises(Clash):
        changed(sides[0], start, difference(start, sides[1]))


def test_nothing_changed_is_nothing():
    assert difference(town, town) is None
    start = town()
    assert changed(start, start, difference(start, replace(start))) == start
