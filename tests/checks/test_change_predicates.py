from dataclasses import replace

import numpy as np
import pytest

from cityx.checks.predicates import measure, measure_all
from cityx.checks.predicates.forms import season_of
from cityx.city import Environment


@pytest.mark.parametrize(
    ("date", "latitude", "season"),
    [("2025-01-10", 50.0, "winter"), ("2025-01-10", -33.0, "summer"),
     ("2025-10-15", 50.0, "autumn"), ("", 50.0, "summer")],
)  # fmt: skip
def test_the_season_is_that_of_the_calendar(date, latitude, season):
    assert season_of(Environment(date=date), latitude) == season


@pytest.mark.parametrize(
    ("predicate", "met"),
    [
        ("n(road, surface=asphalt) == 8", True), ("n(road, surface=cobbles) == 0", True),
        ("n(road, oneway=true) == 0", True), ("n(road, cycling=none) == 8", True),
        ("n(road, parking=both) == 1", False), ("env.hour == 12", True),
        ("share(building, roof_form=flat) == 1.0", True),
    ],
)  # fmt: skip
def test_streets_roofs_and_the_hour_are_measured(scene, predicate, met):
    found = measure(predicate, scene("grid_s"))
    assert found.met is met, found.evidence


def test_others_beyond_a_distance_lets_go_of_what_lies_near_what_is_named(scene):
    before = scene("grid_s")
    rows = before.scene.instances["trees"]
    position = rows.position.copy()
    nearest = int(np.argmin(np.abs(position[:, 0] + 192.0)))  # of street x1
    away = abs(position[nearest, 0] + 192.0)
    position[nearest, 2] += 1.0
    moved = replace(rows, position=position)
    after = replace(
        before, scene=before.scene.with_instances("trees", before.scene.prototypes, moved)
    )
    told = "n(road, name=x1) == 1"
    for reach, met in ((away + 1.0, True), (away / 2, False)):
        found = measure_all([told, f"same(others, beyond={reach:.1f})"], after, before=before)
        assert found[1].met is met, found[1].evidence
