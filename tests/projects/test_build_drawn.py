import json
from pathlib import Path

import pytest
from town import small_town

from cityx.errors import UsageError
from cityx.options import BuildOptions
from cityx.projects.build import build

CROSSING = Path(__file__).parents[2] / "examples" / "curves" / "crossing.geojson"
OPTIONS = BuildOptions(formats=(), render=False)


def test_a_town_crossing_is_built_from_a_drawing_alone(tmp_path):
    report = build([CROSSING], tmp_path / "city", OPTIONS)
    assert {name for name, check in report["checks"].items() if not check["ok"]} == set()
    assert report["counts"]["junctions"] >= 6
    assert report["inputs"][0]["kind"] == "drawn"


def test_a_drawing_joins_the_streets_of_a_map(tmp_path):
    town = small_town().write(tmp_path / "town.osm")
    drawn = {
        "type": "FeatureCollection", "units": "metres",
        "origin": {"latitude": 60.17, "longitude": 24.94},
        "features": [{"type": "Feature", "properties": {"kind": "residential"},
                      "geometry": {"type": "LineString", "coordinates": [[80, -40], [80, 40]]}}],
    }  # fmt: skip
    path = tmp_path / "more.geojson"
    path.write_text(json.dumps(drawn))
    alone = build([town], tmp_path / "alone", OPTIONS)
    both = build([town, path], tmp_path / "both", OPTIONS)
    assert both["counts"]["junctions"] == alone["counts"]["junctions"] + 1


def test_every_fault_of_a_drawing_is_told_and_nothing_is_written(tmp_path):
    line = {"type": "LineString", "coordinates": [[0, 0], [80, 0]]}
    short = {"type": "LineString", "coordinates": [[0, 0], [1, 0]]}
    rows = [({"kind": "secondary", "lanes": 40, "colour": "red"}, line),
            ({"kind": "footway"}, short)]  # fmt: skip
    document = {
        "type": "FeatureCollection", "units": "metres", "origin": {"latitude": 48, "longitude": 16},
        "features": [{"type": "Feature", "properties": said, "geometry": shape}
                     for said, shape in rows],
    }  # fmt: skip
    path = tmp_path / "bad.geojson"
    path.write_text(json.dumps(document))
    with pytest.raises(UsageError) as caught:
        build([path], tmp_path / "city", OPTIONS)
    text = str(caught.value)
    for part in ("lanes = 40", "colour", "shorter than"):
        assert part in text
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["bad.geojson"]
