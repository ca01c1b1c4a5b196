import importlib
import math
from dataclasses import replace
from itertools import combinations, pairwise

import numpy as np
import pytest
import shapely

from cityx.assets.fixtures import east_asia, houses
from cityx.building.catalogue import MODULES
from cityx.building.design import design
from cityx.building.facade.facade import facade
from cityx.building.massing.massing import Plot
from cityx.building.samples import sample_city, sheet_of
from cityx.building.shell import shell

KINDS = ("suburban_house", "cottage", "bungalow", "japanese_lowrise", "japanese_midrise",
         "asian_block", "temple",
         "barn", "greenhouse", "shed")  # fmt: skip
# Masses that a setting of each kind brings, and those that its other end leaves out.
SETTINGS = {
    "suburban_house": ({"garage": 1.0, "porch": 1.0}, {"garage": 0.0, "porch": 0.0}),
    "cottage": ({"outshut": 1.0, "wing": 0.0}, {"outshut": 0.0, "wing": 0.0}),
    "bungalow": ({"porch": 1.0, "carport": 1.0}, {"porch": 0.0, "carport": 0.0}),
    "japanese_lowrise": ({"setback": 2.0}, {"setback": 0.0}),
    "japanese_midrise": ({"setback": 1.0}, {"setback": 0.0}),
    "asian_block": ({"podium": 4}, {"podium": 0}),
    "temple": ({"tiers": 4}, {"tiers": 1}),
    "barn": ({"lean": 1.0, "both": 1.0}, {"lean": 0.0}),
    "greenhouse": ({"bay": 3.0}, {"bay": 9.0}),
    "shed": ({"store": 1.0}, {"store": 0.0}),
}


def kind_of(name):
    place = next(module for module in MODULES if module.endswith(f".{name}"))
    return importlib.import_module(f"cityx.building.generators.{place}")


def plot_of(name, seed=0, plan=None, **more):
    made = kind_of(name).GENERATOR
    length, width = (made.plot[0] + made.plot[1]) / 2, (made.plot[2] + made.plot[3]) / 2
    if plan is None:
        plan = shapely.affinity.rotate(shapely.box(0, 0, length, width), 0.3, use_radians=True)
    levels, flat = made.floors[1], made.roofs[0][0] == "flat"
    rise = 0.0 if flat else 0.5 * width * math.tan(math.radians(made.pitch[0]))
    roof = "flat" if flat else made.roofs[0][0]
    plot = Plot(plan, made.storey * levels + rise, levels, 977 + seed, seed, (0.3, -1.0))
    return replace(plot, **{"roof": roof, "rise": rise, **more})


def awkward():
    yard = shapely.box(0, 0, 30, 30).difference(shapely.box(10, 10, 20, 20))
    ell = shapely.union_all([shapely.box(0, 0, 24, 9), shapely.box(0, 0, 9, 20)])
    skew = shapely.Polygon([(0, 0), (16, 1), (15, 12), (-1, 11)])
    return [yard, ell, skew, shapely.Polygon([(0, 0), (20, 0), (0, 15)]), shapely.box(0, 0, 30, 3),
            shapely.box(0, 0, 3, 3)]  # fmt: skip


def check_volumes(plot, masses):
    room = plot.plan.buffer(0.1)
    for mass in masses:
        assert mass.plan.is_valid
        assert room.covers(mass.plan)
        assert 0 <= mass.rise < mass.height
    for a, b in combinations(masses, 2):
        if min(a.high, b.high) - max(a.low, b.low) > 1e-6:
            assert a.plan.intersection(b.plan).area < 0.5
    ground = shapely.union_all([mass.plan for mass in masses if mass.low < 0.05])
    assert ground.area > 0.97 * plot.plan.area


@pytest.mark.parametrize("name", KINDS)
def test_volumes_share_no_room_stay_on_the_plan_and_cover_it(name):
    for seed in range(2):
        for plan in (None, *awkward()):
            for roof in ("", "hipped", "flat"):
                said = {"roof": roof, "said": True} if roof else {}
                said |= {"rise": 0.0} if roof == "flat" else {}
                plot = plot_of(name, seed, plan, **said)
                check_volumes(plot, kind_of(name).masses(plot))


@pytest.mark.parametrize("name", KINDS)
def test_a_seed_gives_the_same_house_and_seeds_differ(name):
    masses = kind_of(name).masses
    made = [masses(plot_of(name, seed)) for seed in range(8)]
    assert made == [masses(plot_of(name, seed)) for seed in range(8)]
    assert len({str(each) for each in made}) > 2


@pytest.mark.parametrize("name", KINDS)
def test_without_noise_houses_of_a_kind_are_alike(name):
    masses = kind_of(name).masses
    made = {str(masses(plot_of(name, seed, noise=0.0))) for seed in range(4)}
    assert len(made) == 1


@pytest.mark.parametrize("name", KINDS)
def test_settings_change_the_volumes(name):
    masses = kind_of(name).masses
    more, less = SETTINGS[name]
    plots = [plot_of(name, seed) for seed in range(4)]
    rich = [masses(plot, **more) for plot in plots]
    plain = [masses(plot, **less) for plot in plots]
    assert all(a != b for a, b in zip(rich, plain, strict=True))
    if name != "asian_block":
        assert all(len(a) > len(b) for a, b in zip(rich, plain, strict=True))


def test_a_garage_is_lower_than_its_house_and_has_a_door_of_its_own():
    masses = kind_of("suburban_house").masses(plot_of("suburban_house", 1), garage=1.0)
    tops = {mass.zone: mass.high for mass in masses}
    assert tops[next(zone for zone in tops if zone.startswith("garage"))] < tops[""] - 1.0


def test_each_roof_of_a_pagoda_is_smaller_than_the_one_below():
    plan = shapely.box(0, 0, 16, 16)
    masses = kind_of("temple").masses(plot_of("temple", plan=plan, height=24.0, levels=5))
    halls = sorted((m for m in masses if m.zone in ("", "tier")), key=lambda mass: mass.low)
    assert len(halls) >= 3
    for below, above in pairwise(halls):
        assert below.plan.covers(above.plan)
        assert above.low > below.high


def test_timbered_cottages_wear_their_frame_on_every_part():
    masses = kind_of("cottage").masses
    plots = [plot_of("cottage", seed) for seed in range(6)]
    framed = {mass.zone for plot in plots for mass in masses(plot, timber=1.0)}
    plain = {mass.zone for plot in plots for mass in masses(plot, timber=0.0)}
    assert framed == {"timber", "timber_low"}
    assert plain == {"", "low"}


def test_a_bungalow_takes_its_second_storey_into_the_roof():
    low = kind_of("bungalow").masses(plot_of("bungalow"))
    plot = plot_of("bungalow", height=7.4, levels=2)
    high = kind_of("bungalow").masses(plot)
    eave = {made: max(m.high - m.rise for m in made) for made in (low, high)}
    assert max(mass.high for mass in high) == pytest.approx(7.4)
    assert eave[high] < 0.6 * 7.4


def test_light_wells_take_from_slabs_above_the_ground():
    plan = shapely.box(0, 0, 42, 15)
    plot = plot_of("asian_block", plan=plan)
    area = [
        sum(mass.plan.area for mass in kind_of("asian_block").masses(plot, well=well)
            if mass.zone == "" and mass.low > 1)
        for well in (0.0, 2.0, 4.0)
    ]  # fmt: skip
    assert area[0] > area[1] > area[2] > 0.5 * plan.area


def test_a_slope_turns_the_roofs_of_sheds_to_the_back():
    plot = plot_of("shed", plan=shapely.box(0, 0, 5, 4), front=(0.0, -1.0))
    (made,) = kind_of("shed").masses(plot, slope=0.2)
    assert made.roof == "skillion"
    assert made.rise == pytest.approx(0.2 * 4)
    assert made.direction == pytest.approx(0.0)  # down to the north, away from the street


def test_bars_of_a_glass_roof_are_as_wide_as_its_bays():
    city = facade(shell(design(sample_city(sheet_of(["greenhouse"], (1,))))))
    bays = city.layout.parts.geometry.bounds
    width = (bays["maxy"] - bays["miny"]).to_numpy()
    rows = city.scene.instances["trims"]
    bars = [each.name for each in city.scene.prototypes].index("glass_bars")
    wide = rows.scale[rows.prototype == bars][:, 1]
    assert len(wide) > 10
    assert np.abs(wide[:, None] - width).min(axis=1).max() < 1e-3


def test_samples_close_under_the_roofs_they_ask_for_and_have_doors():
    city = facade(shell(design(sample_city(sheet_of(KINDS, (1, 2, 3))))))
    assert [failure.message for failure in city.failures] == []
    doors = set(city.scene.instances["doors"].owner.tolist())
    kinds = city.layout.buildings
    temples = set(kinds.loc[kinds["generator"] == "temple", "id"].tolist())
    assert set(kinds["id"].tolist()) - temples == doors


MADE = {**houses.MAKERS, **east_asia.MAKERS}


@pytest.mark.parametrize("name", MADE)
def test_fixtures_stand_at_the_wall_and_in_size(name):
    low, high = (
        [
            pick(axis)
            for axis in zip(
                *[v for s in MADE[name]() for v in s.vertices],
                strict=True,
            )
        ]
        for pick in (min, max)
    )
    assert high[1] < 0.4 or low[1] < -high[1] * 0.9  # before the wall, or about its own middle
    assert high[2] > low[2]
    assert max(high[0] - low[0], high[2] - low[2]) < 6.5
