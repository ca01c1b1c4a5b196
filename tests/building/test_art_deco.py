import numpy as np
import pytest
import shapely

from cityx.assets.fixtures import fixture
from cityx.assets.fixtures.deco import MAKERS
from cityx.assets.styles.style_shares import speaking_of
from cityx.building.generators.towers import art_deco
from cityx.building.massing.massing import Plot
from cityx.building.selection import choose_generators
from cityx.protocol.example_city import example_city


def plot_of(levels=6, size=(30, 18), **more):
    given = {"front": (0.0, -1.0), "noise": 0.0, **more}
    return Plot(shapely.box(0, 0, *size), 3.3 * levels, levels, 5, **given)


def test_streamlined_corners_are_round_and_take_little_of_the_ground():
    plot = plot_of()
    masses = art_deco.masses(plot, form="streamline")
    drums = [mass.plan for mass in masses if mass.zone == "drum"]
    assert len(drums) == 2
    for drum in drums:
        x0, y0, x1, y1 = drum.bounds
        assert len(drum.exterior.coords) >= 6
        assert x1 - x0 == pytest.approx(y1 - y0)
        assert drum.area < 0.9 * (x1 - x0) ** 2
    ground = shapely.union_all([mass.plan for mass in masses if mass.low < 0.01])
    assert 0.97 * plot.plan.area < ground.area < plot.plan.area


def test_zigzag_parapets_rise_in_steps_to_the_middle():
    masses = art_deco.masses(plot_of(), form="zigzag")
    crests = sorted(
        (mass for mass in masses if mass.zone in ("crest", "crown")),
        key=lambda mass: mass.plan.centroid.x,
    )
    tops = [mass.high for mass in crests]
    assert len(tops) == 5
    assert tops == pytest.approx(tops[::-1])
    assert tops[0] < tops[1] < tops[2]
    assert crests[2].zone == "crown"


def test_stepped_houses_draw_in_towards_their_pylon():
    masses = art_deco.masses(plot_of(), form="stepped")
    areas = {mass.zone: mass.plan.area for mass in masses}
    assert areas["shops"] > areas["bays"] > areas["penthouse"] > areas["pylon"]
    assert max(masses, key=lambda mass: mass.high).zone == "pylon"


@pytest.mark.parametrize("form", art_deco.FORMS)
def test_upper_walls_stand_behind_those_below(form):
    for levels in (3, 6):
        plot = plot_of(levels)
        upper = [mass for mass in art_deco.masses(plot, form=form) if mass.low > 0.01]
        assert upper
        for mass in upper:
            assert mass.plan.distance(plot.plan.exterior) >= 0.1


def test_a_named_roof_stays():
    plot = plot_of(roof="gabled", rise=3.0, said=True)
    assert art_deco.masses(plot) == (plot.body,)


@pytest.mark.parametrize("name", sorted(MAKERS))
def test_ornaments_stand_on_the_wall(name):
    vertices = fixture(name).mesh.vertices
    assert np.isfinite(vertices).all()
    assert vertices[:, 1].min() < 0.15
    assert vertices[:, 1].min() > -1.3


def test_a_small_town_in_art_deco_is_built_of_it():
    from test_selection import town

    chosen = choose_generators(town(use="apartments", size=(20.0, 14.0)), 1, style="art deco")
    assert np.isin(chosen, list(speaking_of("art_deco")["flats"])).mean() > 0.8


def test_one_building_becomes_an_art_deco_house():
    made = art_deco.art_deco(example_city(), building="The Tower", floors=5, form="zigzag")
    assert (made.layout.buildings["generator"] == "art_deco").sum() == 1
    assert {"middle", "crown"} <= set(made.layout.parts["zone"])
