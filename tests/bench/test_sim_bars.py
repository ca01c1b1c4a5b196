"""Bars of the simulator are reached, missed or not measured; maps are stepped or say why not."""

import pytest
from cityx_bench.sim_bars import (
    ABSENT,
    BARS,
    MISSED,
    REACHED,
    Asked,
    Finding,
    at_least,
    at_most,
    measured,
    missing,
    verdict,
)
from cityx_bench.sim_maps import FAILED, LONG, RAN, REFUSED, maps_of, sweep
from cityx_bench.sim_measures import MEASURES, placed
from cityx_bench.sim_rules import _complaints, _placed

from cityx.errors import InputError
from cityx.sim.registration import IDS
from cityx.sim.world import kept_scenery_path


def test_there_are_fourteen_bars_and_each_is_measured():
    assert sorted(BARS) == sorted(MEASURES) == list(range(1, 15))


def test_one_figure_that_misses_misses_the_bar():
    good, bad = at_least("rate", 5.0, 4.0), at_most("faults", 1, 0)
    assert verdict([good, Finding("beside", "12")]) == REACHED
    assert verdict([good, bad]) == MISSED
    assert verdict([good, missing("no camera")]) == ABSENT
    assert verdict([bad, missing("no camera")]) == MISSED
    assert verdict([]) == ABSENT


def test_bars_are_told_with_figures_and_counted(tmp_path):
    lines = []
    asked = Asked((), True, (), 60, 0.0, tmp_path)
    found = measured(asked, {6: MEASURES[6], 8: MEASURES[8], 13: MEASURES[13]}, lines.append, (13,))
    assert list(found) == [13]
    assert lines[0] == "13. every map: not measured"
    assert "no --maps" in lines[1]
    assert lines[-1] == "of 1 bars 0 reached, 0 missed, 1 not measured"


def test_a_map_is_stepped_by_chance_and_one_without_streets_says_so(town_map, tmp_path):
    empty = tmp_path / "field.osm"
    empty.write_text('<osm version="0.6"><node id="1" lat="52.0" lon="13.0"/>'
                     '<node id="2" lat="52.001" lon="13.001"/></osm>')  # fmt: skip
    lines = []
    found = sweep(maps_of([tmp_path, town_map]), 30, 300, lines.append, ("CityX/Drive-v0",))
    assert [each.place for each in found] == ["field.osm", town_map.name]
    assert found[0].state == REFUSED
    assert found[0].told.endswith(".")
    assert (found[1].state, found[1].steps) == (RAN, 30), found[1].told
    assert len(lines) == 2
    assert {FAILED, LONG}.isdisjoint(each.state for each in found)


def test_a_checker_sees_a_place_that_no_camera_has_seen_before(town_map):
    place = placed([town_map])[0]
    kept = kept_scenery_path(place.world.hash, place.world.facts["name"])
    assert kept is not None
    kept.unlink(missing_ok=True)
    assert _complaints("gymnasium", IDS[0], _placed(place, IDS[0])) == []


def test_a_folder_without_maps_is_refused(tmp_path):
    with pytest.raises(InputError, match="There is no map in"):
        maps_of([tmp_path])
