from pathlib import Path

import numpy as np
import pytest

from cityx.ground.street_rules import (
    APART,
    CLEAR,
    INSTEAD,
    KERB_RULES,
    local_names,
    rates,
)
from cityx.ids import hash_ids
from cityx.nature.furniture.street_pieces import _few_of_a_kind
from cityx.places.profiles import profile_named

PAGE = (Path(__file__).parents[2] / "docs" / "furniture.md").read_text()


@pytest.mark.parametrize("rule", KERB_RULES, ids=lambda rule: rule.piece)
def test_the_page_tells_the_rates_and_the_room_of_every_rule(rule):
    numbers = (rule.main_town, rule.local_town, rule.main_out, rule.local_out)
    cells = [rule.piece.replace("_", " "), *(f"{n:g}" for n in numbers), f"{rule.room:.2f}"]
    assert f"| {' | '.join(cells)} |" in PAGE


def test_rates_follow_the_place():
    hydrant = next(rule for rule in KERB_RULES if rule.piece == "fire_hydrant")
    assert rates(hydrant, profile_named("us").furniture)[0] == pytest.approx(1.08)
    assert rates(hydrant, profile_named("gb").furniture)[0] == pytest.approx(0.36)


def test_pieces_are_those_of_the_region():
    usual = ["fire_hydrant", "bench", "post_box"]
    assert local_names(usual, profile_named("gb").furniture).tolist() == [
        "fire_hydrant_plate", "bench", "post_box_pillar",
    ]  # fmt: skip
    assert local_names(usual, profile_named("de").furniture)[0] == "fire_hydrant_cover"
    assert local_names(usual, profile_named("us").furniture)[0] == "fire_hydrant"


def test_every_rule_leaves_the_free_walk_behind_it():
    assert all(
        rule.room - rule.from_kerb - rule.depth == pytest.approx(CLEAR) for rule in KERB_RULES
    )
    assert all(rule.from_kerb > rule.depth or not rule.depth for rule in KERB_RULES)


def test_there_is_one_telephone_box_within_sight(crossroads):
    names = [rule.piece for rule in KERB_RULES]
    xy = np.column_stack([np.arange(0.0, 600.0, 30.0), np.zeros(20)])
    asked = np.full(20, names.index("telephone"))
    ids = hash_ids(0, "boxes", np.arange(20, dtype=np.uint64))
    kept = _few_of_a_kind(crossroads, xy, asked, ids)
    boxes = xy[kept == names.index("telephone"), 0]
    assert 2 <= len(boxes) <= 6
    assert np.diff(boxes).min() >= APART["telephone"]
    assert {names[rule] for rule in kept} <= {"telephone", *INSTEAD}
    assert (asked == names.index("telephone")).all()
