"""How much of the pavement hangs together."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
from crossing_town import ARMS, crossing_town

from cityx.checks.walkway_checks import check_walkways
from cityx.city import City, Frame, Layout, make_table
from cityx.city.ground import LABEL
from cityx.ground.walking.crosswalks import FOOTWAYS
from cityx.road.ground.ground_surface import ground
from cityx.road.network.network import network
from cityx.town.bounded_town import layout_of_site
from cityx.town.plane import Plan


def share(**options):
    (check,) = check_walkways(crossing_town(plaza=False, **options))
    return check


def test_pavements_hang_together_over_crosswalks():
    assert share().value == pytest.approx(0.0)
    assert share().ok


def test_pavements_hang_together_over_wide_streets_where_kerbs_are_lowered():
    assert share(width=16.0).value == pytest.approx(0.0)


def test_pavements_of_wide_roads_without_lowered_kerbs_are_apart():
    wide = share(width=16.0, main=True)
    assert wide.value == pytest.approx(0.5, abs=0.02)
    assert not wide.ok
    assert "in 1 pieces" in wide.meaning


def test_a_footbridge_joins_what_it_leads_over():
    assert share(width=16.0, main=True, footbridge=True).value == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize(
    ("line", "kind", "level"),
    [([(0, 25), (0, 45)], "footway", 1), ([(55, 26), (45, 48)], "pedestrian", 2),
     ([(30, 20), (30, 50)], "footway", -1)],
)  # fmt: skip
def test_a_way_over_or_under_water_joins_the_land_at_its_ends(line, kind, level):
    arms = [shapely.LineString(arm) for arm in (*ARMS, line)]
    roads = make_table(
        "roads", arms, id=[1, 2, 3], kind=["residential"] * 2 + [kind], width=[6.0, 6.0, 2.0],
        bridge=[False, False, level > 0], tunnel=[False, False, level < 0], layer=[0, 0, level],
    )  # fmt: skip
    river = shapely.box(-70, 30, 70, 40)
    squares = [shapely.box(8, 5, 20, 18), shapely.box(10, 52, 30, 66)]
    areas = make_table(
        "areas", [river, *squares], id=[4, 5, 6], kind=["water"] + 2 * ["pedestrian"]
    )

    def apart(table):
        layout = Layout((-70.0, -70.0, 70.0, 70.0), roads=table, areas=areas)
        (check,) = check_walkways(ground(network(City("river", Frame(52.0, 13.0), layout, lod=0))))
        return check.value

    assert apart(roads) == pytest.approx(0.0)
    assert apart(roads[:2]) > 0.2


@pytest.mark.parametrize("name", ["kerb", "kerb_dropped", "edging"])
def test_stones_without_a_walk_beside_them_do_not_count(name):
    city = crossing_town(plaza=False, width=16.0, main=True)
    walked = city.ground.labelled(*FOOTWAYS)
    label = np.where(walked, LABEL[name], city.ground.face_label)
    assert not check_walkways(replace(city, ground=replace(city.ground, face_label=label)))


@pytest.mark.parametrize("pattern", ["mixed", "organic", "superblock"])
def test_pavements_of_towns_hang_together(pattern):
    frame = Frame(50.0, 10.0)
    layout = layout_of_site((-200.0, -200.0, 200.0, 200.0), Plan(pattern), 3, frame=frame)
    (check,) = check_walkways(ground(network(City("town", frame, layout, lod=1))))
    assert check.value < 0.1
