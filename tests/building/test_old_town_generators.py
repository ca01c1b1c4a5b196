from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
import shapely
from massings import assert_sound, awkward

from cityx.assets.fixtures import fixture
from cityx.building.catalogue import generators
from cityx.building.design import design
from cityx.building.facade.facade import facade
from cityx.building.generators.civic import townhall
from cityx.building.generators.homes import (
    georgian_terrace,
    mediterranean_house,
    palazzo,
    panel_slab,
    perimeter_block,
    shop_house,
    walk_up,
)
from cityx.building.generators.towers import art_deco
from cityx.building.massing.massing import Plot
from cityx.building.samples import Sample, sample_city, sheet_of
from cityx.building.shell import shell
from cityx.protocol.example_city import example_city

MODULES = (
    palazzo, perimeter_block, georgian_terrace, walk_up, mediterranean_house, shop_house, townhall,
    panel_slab, art_deco,
)  # fmt: skip
NAMES = [module.GENERATOR.name for module in MODULES]
SEEDS = (1, 2, 3)
# What each massing may be asked for; on the plot of `even` no two give the same volumes.
OPTIONS = {
    "palazzo": [
        *({"pavilions": form} for form in palazzo.PAVILIONS),
        {"pavilions": "ends", "attic": 3.0},
        {"pavilions": "ends", "wing": 9.0},
    ],
    "perimeter_block": [
        *({"front": front} for front in perimeter_block.FRONTS),
        {"front": "oriel", "wing": 9.0},
        {"front": "oriel", "wing": 9.0, "closed": True},
    ],
    "georgian_terrace": [
        *({"roof": roof} for roof in georgian_terrace.ROOFS),
        {"roof": "butterfly", "parapet": 1.4},
    ],
    "walk_up": [
        *({"front": front} for front in walk_up.FRONTS),
        {"front": "flats", "shaft": 2.4},
        {"front": "flats", "shaft": 0.0},
    ],
    "mediterranean_house": [
        *({"form": form} for form in mediterranean_house.FORMS),
        {"form": "terrace", "terrace": 0.5},
    ],
    "shop_house": [
        *({"gable": gable, "corner": 0.0} for gable in shop_house.GABLES),
        {"gable": "bell", "corner": 1.0},
        {"gable": "bell", "corner": 0.0, "house": 5.0},
    ],
    "townhall": [
        *({"top": top} for top in townhall.TOPS),
        {"top": "spire", "tower": 3.0},
        {"top": "spire", "tower": 0.0},
        {"top": "spire", "pavilions": False},
    ],
    "panel_slab": [
        {"colour": "ochre"},
        {"colour": "grey"},
        {"colour": "grey", "section": 15.0},
        {"colour": "grey", "step": 0.0},
    ],
    "art_deco": [
        *({"form": form} for form in art_deco.FORMS),
        {"form": "streamline", "corner": 7.0},
        {"form": "stepped", "attic": 4.0},
        {"form": "zigzag", "parapet": 1.8},
    ],
}
CASES = [(name, number) for name in NAMES for number in range(len(OPTIONS[name]))]
ROOFS = {"mediterranean_house": ("hipped", 1.8), "walk_up": ("flat", 0.0),
         "panel_slab": ("flat", 0.0), "art_deco": ("flat", 0.0)}  # fmt: skip


def grown(name, plot, **options):
    return MODULES[NAMES.index(name)].masses(plot, **options)


def plot_of(name, seed=1, **more):
    sample = Sample(name, seed).measured()
    roof, rise = ROOFS.get(name, ("mansard", 4.5))
    given = {"front": (0.0, -1.0), "roof": roof, "rise": rise, **more}
    return Plot(sample.outline, sample.height + rise, sample.levels, sample.id, **given)


def even(name, key=5):
    roof, rise = ROOFS.get(name, ("mansard", 6.0))
    storey = generators()[name].storey
    size = {"shop_house": (18, 14), "georgian_terrace": (7, 12)}.get(name, (44, 30))
    return Plot(shapely.box(0, 0, *size), 5 * storey + rise, 5, key, front=(0.0, -1.0), roof=roof,
                rise=rise, noise=0.0)  # fmt: skip


def look_of(mass):
    return mass.plan, mass.low, mass.high, mass.roof, mass.rise


@pytest.mark.parametrize(("name", "number"), CASES)
def test_volumes_lie_in_the_footprint_cover_it_and_share_no_interior(name, number):
    for seed in SEEDS:
        plot = plot_of(name, seed)
        assert_sound(plot, grown(name, plot, **OPTIONS[name][number]))


@pytest.mark.parametrize("name", NAMES)
def test_awkward_plans_get_sound_volumes(name):
    for plan in awkward():
        for options in ({}, *OPTIONS[name][-2:]):
            plot = replace(plot_of(name), plan=plan)
            assert_sound(plot, grown(name, plot, **options))


@pytest.mark.parametrize("name", NAMES)
def test_low_buildings_get_sound_volumes(name):
    for levels in (1, 2, 3):
        plot = replace(plot_of(name), levels=levels, height=3.5 * levels, rise=0.8)
        assert_sound(plot, grown(name, plot))


@pytest.mark.parametrize("name", NAMES)
def test_the_same_seed_grows_the_same_and_another_seed_another(name):
    plot = plot_of(name, 2)
    assert grown(name, plot) == grown(name, plot)
    others = [grown(name, replace(plot, seed=seed)) for seed in range(2, 8)]
    assert sum(other != grown(name, plot) for other in others) >= 3


@pytest.mark.parametrize("name", NAMES)
def test_every_option_changes_the_volumes(name):
    made = [grown(name, even(name), **options) for options in OPTIONS[name]]
    assert len(made) > 1
    for first, second in combinations(made, 2):
        assert first != second


@pytest.mark.parametrize("name", NAMES)
def test_without_noise_measures_do_not_depend_on_the_building(name):
    options = dict(OPTIONS[name][0])
    if name == "shop_house":
        options["gable"] = "bell"
    if name == "georgian_terrace":
        options["closet"] = 0.0
    one, two = (grown(name, even(name, key), **options) for key in (5, 6))
    assert [look_of(mass) for mass in one] == [look_of(mass) for mass in two]


def test_a_town_hall_without_noise_is_symmetric():
    plot = even("townhall")
    masses = grown("townhall", plot, top="spire")
    whole = shapely.union_all([mass.plan for mass in masses if mass.high > 22])
    mirrored = shapely.transform(whole, lambda at: np.column_stack([44 - at[:, 0], at[:, 1]]))
    assert whole.symmetric_difference(mirrored).area < 0.1
    assert {"porch", "shaft", "clock", "lantern", "pavilion"} <= {mass.zone for mass in masses}


def test_the_roofs_of_terraces_hide_behind_their_parapets():
    masses = grown("georgian_terrace", even("georgian_terrace"), roof="butterfly")
    screen = max(masses, key=lambda mass: mass.high)
    behind = next(mass for mass in masses if mass.roof == "butterfly")
    assert screen.roof == "flat"
    assert screen.plan.bounds[1] == pytest.approx(0.0)
    assert behind.plan.bounds[1] >= screen.plan.bounds[3] - 1e-6


def test_the_gables_of_shop_houses_look_at_the_street():
    masses = grown("shop_house", even("shop_house"), gable="stepped", corner=0.0)
    assert len(masses) == 3
    for mass in masses:
        x0, y0, x1, y1 = mass.plan.bounds
        assert y1 - y0 > x1 - x0
        assert abs(np.sin(mass.direction)) == pytest.approx(1.0)


def test_deep_tenements_are_dumbbells():
    plot = plot_of("walk_up")
    tall = max(grown("walk_up", plot, front="flats"), key=lambda mass: mass.high).plan
    x0, y0, x1, y1 = plot.plan.bounds
    spans = [
        tall.intersection(shapely.LineString([(x0 - 1, y), (x1 + 1, y)])).length
        for y in (y0 + 1.0, (y0 + y1) / 2, y1 - 1.0)
    ]
    assert spans[1] < spans[0] - 1.5
    assert spans[0] == pytest.approx(spans[2])


@pytest.fixture(scope="module")
def built():
    return facade(shell(design(sample_city(sheet_of(NAMES, (1, 2))))))


def test_sample_buildings_close_with_the_roofs_they_ask_for_and_have_a_door(built):
    assert built.failures == ()
    doors = built.scene.instances["doors"]
    assert np.isin(built.layout.buildings["id"].to_numpy(np.uint64), doors.owner).all()


def placed(city, name):
    """Return the rows of a prototype among the trims."""
    trims = city.scene.instances["trims"]
    number = [each.name for each in city.scene.prototypes].index(name)
    return trims.position[trims.prototype == number]


def walk_up_with_escapes():
    city = sample_city([Sample("walk_up", seed, 300.0 * seed).measured() for seed in range(8)])
    return facade(shell(design(city)))


def test_oriels_hang_above_heads_and_stand_out_less_than_a_metre():
    city = sample_city(
        [Sample("perimeter_block", seed, 300.0 * seed).measured() for seed in range(8)]
    )
    city = facade(shell(design(city)))
    feet = placed(city, "oriel_foot")
    assert len(feet)
    assert (feet[:, 2] + fixture("oriel_foot").mesh.vertices[:, 2].min() > 2.4).all()
    assert -fixture("oriel").mesh.vertices[:, 1].min() < 1.0


def test_flights_of_fire_escapes_alternate():
    city = walk_up_with_escapes()
    left, right = placed(city, "escape_left"), placed(city, "escape_right")
    assert len(left)
    assert len(right)
    for at in np.unique(left[:, :2].round(2), axis=0):
        one, other = (np.sort(z[np.abs(z[:, :2] - at).max(axis=1) < 0.1, 2]) for z in (left, right))
        both = np.sort(np.concatenate([one, other]))
        assert np.allclose(both[::2], one)
        assert np.allclose(both[1::2], other)


def test_a_stoop_leads_to_every_door_of_a_tenement():
    city = walk_up_with_escapes()
    doors = city.scene.instances["doors"]
    steps = placed(city, "stoop_steps")
    names = np.array([each.name for each in city.scene.prototypes])[doors.prototype]
    own = doors.position[names == "door_stoop"]
    assert len(steps) == len(own) == 8
    assert np.allclose(np.sort(steps[:, 0]), np.sort(own[:, 0]), atol=0.01)


def test_no_block_of_stone_stands_before_a_door_or_a_shop(built):
    blocks = placed(built, "palace_blocks")
    for layer, half in (("doors", 1.2), ("shopfronts", 0.9)):
        rows = built.scene.instances[layer]
        gap = np.abs(blocks[:, None, :2] - rows.position[None, :, :2]).max(axis=2)
        assert (gap > half).all()


@pytest.mark.parametrize(
    ("module", "options"),
    [(townhall, {"top": "dome"}), (palazzo, {"pavilions": "ends"})],
)
def test_one_building_becomes_such_a_house(module, options):
    name = module.GENERATOR.name
    made = getattr(module, name)(example_city(), building="The Tower", floors=5, **options)
    assert (made.layout.buildings["generator"] == name).sum() == 1
