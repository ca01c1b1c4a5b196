"""Commands about parts of buildings: only the part changes; what there is not is asked about."""

from dataclasses import replace

import numpy as np
import pytest

from cityx.agents.planning.planner import OfflinePlanner
from cityx.city import Instances, one_mesh
from cityx.city.scene import Prototype
from cityx.ids import id_text
from cityx.language.brief import Clarify
from cityx.language.lexicon.phrases import part_of
from cityx.language.reading import read_brief
from cityx.language.references.resolved_changes import slots_of_edits
from cityx.protocol import registry
from cityx.protocol.catalogue import known_records
from cityx.protocol.example_city import example_city
from cityx.protocol.running import run_step


@pytest.fixture(scope="module")
def town():
    """A town whose buildings have a red door each."""
    city = example_city()
    owner = city.layout.buildings["id"].to_numpy(np.uint64)
    at = np.array([(p.x, p.y, 0.0) for p in city.layout.buildings.geometry.representative_point()])
    size = len(owner)
    first = len(city.scene.prototypes)
    mesh = one_mesh(1, [(0, 0, 0), (1, 0, 0), (1, 0, 2), (0, 0, 2)], [[0, 1, 2, 3]])
    rows = Instances(
        np.full(size, first, np.int32), owner + np.uint64(1 << 40), owner, at,
        np.zeros((size, 3), np.float32), np.ones((size, 3), np.float32),
        np.ones((size, 3), np.float32),
    )  # fmt: skip
    prototypes = (*city.scene.prototypes, Prototype("door_plain", "door", mesh))
    return replace(city, scene=city.scene.with_instances("doors", prototypes, rows))


def asked(text, city):
    ((_, slots),) = slots_of_edits(read_brief(text, base=True), city)
    return slots


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("Remove the balconies of the tallest building", "balcony"),
        ("Take the chimneys off the church", "chimney"),
        ("Remove the building with the red door", ""),
        ("Remove the building", ""),
    ],
)
def test_a_part_is_what_is_named_before_what_it_is_of(text, part):
    assert part_of(text) == part


@pytest.mark.parametrize(
    ("text", "action"),
    [
        ("Remove the doors of the tallest building.", "edit/remove_parts-v1"),
        ("Paint the doors of the tallest building red.", "edit/paint_objects-v1"),
    ],
)
def test_only_the_part_is_changed(town, text, action):
    slots = asked(text, town)
    (item,) = OfflinePlanner(known_records(registry())).answers(slots)
    assert item.action == action
    changed = run_step(town, item.call, registry())
    before, after = (city.scene.instances["doors"] for city in (town, changed))
    assert len(changed.layout.buildings) == len(town.layout.buildings)
    if action == "edit/remove_parts-v1":
        (gone,) = np.setdiff1d(before.object_id, after.object_id).tolist()
        assert slots["objects"] == ((id_text(gone),),)
    else:
        assert (after.tint != before.tint).any(axis=1).sum() == 1


def test_what_a_building_has_not_is_asked_about(town):
    with pytest.raises(Clarify, match="has no balcony of its own"):
        asked("Remove the balconies of the tallest building.", town)
