"""Limits of sentences hold in the finished city, measured from the numbers of the sentence."""

import math
import sys
from pathlib import Path

import numpy as np
import pytest
from town import Town

import cityx

sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))
import limits

SIZE = (160.0, 160.0)
CASES = [
    limits.Limit("height", "No building higher than 11 m", limits.heights_of("building"),
                 high=11.0, some=True, slack=limits.NEAR),
    limits.Limit("floors", "houses of at most two floors", limits.floors_of("building"),
                 high=2.0, some=True),
    limits.Limit("height", "all buildings are between 60 and 80 ft high",
                 limits.heights_of("building"), 60 * limits.FOOT, 80 * limits.FOOT, some=True,
                 slack=limits.NEAR),
    limits.Limit("count", "at most 9 buildings", limits.number_of("building"), high=9.0),
    limits.Limit("width", "side streets at most 7 m wide",
                 limits.widths_of(limits.STREETS[len(limits.MAIN):]), high=7.0, some=True),
    limits.Limit("share", "a suburb with at most 20 % green", limits.green_share,
                 high=0.2, slack=1e-6),
]  # fmt: skip


@pytest.mark.parametrize("limit", CASES, ids=[one.sentence for one in CASES])
def test_a_limit_is_kept(limit):
    assert limit.fault(cityx.build(limit.sentence, lod=0, size=SIZE).city) == ""


def test_sentences_are_drawn_with_their_numbers():
    drawn = list(limits.sentences(3, 100))
    assert len(drawn) == 100
    assert len({one.kind for one in drawn}) == len(limits.KINDS)
    assert all(math.isfinite(one.low) or math.isfinite(one.high) for one in drawn)
    again = [one.sentence for one in limits.sentences(3, 100)]
    assert again == [one.sentence for one in drawn]


@pytest.mark.parametrize("most", [9.0, 14.0])
def test_a_limit_binds_what_a_map_leaves_open(most, tmp_path):
    town = Town()
    town.way([town.node(x, 0) for x in (-90, 0, 90)], highway="residential", lanes="2")
    for k, x in enumerate(range(-80, 80, 28)):
        town.box(x, 10, 20, 14, building="apartments")
        stated = {"height": "21"} if k == 0 else {}
        town.box(x, -24, 20, 14, building="apartments", **stated)
    path = town.write(tmp_path / "town.osm")
    project = cityx.build(path, f"no building above {most:g} m", lod=1)
    tops = np.sort(limits.tops(project.city))
    assert tops[-1] == pytest.approx(21.0, abs=0.3)
    assert tops[-2] <= most + limits.NEAR
    assert any("the map states 21 to 21 m for 1 building" in note for note in project.city.notes)
