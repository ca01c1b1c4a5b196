from dataclasses import replace
from itertools import combinations, pairwise

import numpy as np
import pytest
import shapely
from massings import assert_sound, awkward

from cityx.building.catalogue import generators
from cityx.building.design import design
from cityx.building.facade.facade import facade
from cityx.building.generators.homes import mixed_use
from cityx.building.generators.towers import (
    brutalist,
    glass_tower,
    office_slab,
    postmodern_tower,
    setback_skyscraper,
)
from cityx.building.generators.trade import parking
from cityx.building.massing.massing import Plot
from cityx.building.samples import Sample, sample_city, sheet_of
from cityx.building.shell import shell
from cityx.protocol.example_city import example_city

MODULES = (
    glass_tower, setback_skyscraper, postmodern_tower, office_slab, brutalist, mixed_use, parking,
)  # fmt: skip
NAMES = [module.GENERATOR.name for module in MODULES]
SEEDS = (1, 2, 3)
# What each massing may be asked for beyond its defaults; the first of each is compared to itself.
OPTIONS = {
    "glass_tower": [
        *({"form": form} for form in glass_tower.FORMS),
        {"form": "taper", "taper": 0.4},
        {"form": "twist", "turn": 90.0},
        {"form": "notch", "plant": 0},
    ],
    "setback_skyscraper": [
        *({"crown": crown} for crown in setback_skyscraper.CROWNS),
        {"inset": 2.0},
        {"depth": 1},
    ],
    "postmodern_tower": [
        *({"crown": crown} for crown in postmodern_tower.CROWNS),
        {"crown": "gable", "base": 5},
        {"crown": "gable", "slot": 0.0},
        {"crown": "gable", "shoulder": 4.0},
    ],
    "office_slab": [
        *({"core": core} for core in office_slab.CORES),
        {"core": "end", "recess": 3.0},
    ],
    "brutalist": [
        *({"form": form} for form in brutalist.FORMS),
        {"form": "trays", "reach": 4.0},
        {"form": "trays", "towers": 0},
    ],
    "mixed_use": [
        {"divided": 1.0},
        {"divided": 1.0, "volumes": 1},
        {"divided": 1.0, "terrace": 4.0},
        {"divided": 1.0, "retail": 2},
        {"divided": 0.0},
    ],
    "parking": [
        {"ramp": "drum"},
        {"ramp": "inner"},
        {"ramp": "drum", "band": 0.8},
        {"ramp": "drum", "stairs": 0},
    ],
}
CASES = [(name, number) for name in NAMES for number in range(len(OPTIONS[name]))]


def grown(name, plot, **options):
    return MODULES[NAMES.index(name)].masses(plot, **options)


def plot_of(name, seed=1, **more):
    sample = Sample(name, seed).measured()
    given = {"front": (0.0, -1.0), **more}
    return Plot(sample.outline, sample.height, sample.levels, sample.id, **given)


def even(name, key=5):
    levels = {"mixed_use": 8, "parking": 6, "office_slab": 10, "brutalist": 10}.get(name, 36)
    storey = generators()[name].storey
    plan = shapely.box(0, 0, 60, 32)
    return Plot(plan, storey * levels, levels, key, front=(0.0, -1.0), noise=0.0)


@pytest.mark.parametrize(("name", "number"), CASES)
def test_volumes_lie_in_the_footprint_cover_it_and_share_no_interior(name, number):
    options = OPTIONS[name][number]
    for seed in SEEDS:
        plot = plot_of(name, seed)
        masses = grown(name, plot, **options)
        assert_sound(plot, masses)
        assert max(mass.high for mass in masses) <= plot.height + 1e-6


@pytest.mark.parametrize("name", NAMES)
def test_awkward_plans_get_sound_volumes(name):
    for plan in awkward():
        for options in OPTIONS[name][:3]:
            plot = replace(plot_of(name), plan=plan)
            assert_sound(plot, grown(name, plot, **options))


@pytest.mark.parametrize("name", NAMES)
def test_low_buildings_get_sound_volumes(name):
    for levels in (1, 2, 3, 4, 6):
        plot = replace(plot_of(name), levels=levels, height=3.5 * levels)
        assert_sound(plot, grown(name, plot))


@pytest.mark.parametrize("name", NAMES)
def test_the_same_seed_grows_the_same_and_another_seed_another(name):
    plot = plot_of(name)
    assert grown(name, plot) == grown(name, plot)
    others = [grown(name, replace(plot, seed=seed)) for seed in (2, 3, 4)]
    assert sum(other != grown(name, plot) for other in others) >= 2


@pytest.mark.parametrize("name", NAMES)
def test_every_option_changes_the_volumes(name):
    plot = even(name)
    made = [grown(name, plot, **options) for options in OPTIONS[name]]
    assert len(made) > 1
    for first, second in combinations(made, 2):
        assert first != second


@pytest.mark.parametrize("name", NAMES)
def test_without_noise_volumes_do_not_depend_on_the_building(name):
    options = OPTIONS[name][0]
    one, two = (grown(name, even(name, key), **options) for key in (5, 6))
    assert [(m.plan, m.low, m.high) for m in one] == [(m.plan, m.low, m.high) for m in two]


def test_glass_towers_have_different_silhouettes():
    plot = even("glass_tower")

    def outline(form):
        masses = grown("glass_tower", plot, form=form, plant=0)
        levels = np.linspace(0.3, 0.98, 12) * plot.height
        return [round(sum(m.plan.area for m in masses if m.low <= z < m.high)) for z in levels]

    shapes = [outline(form) for form in glass_tower.FORMS]
    assert len(shapes) > 1
    for first, second in combinations(shapes, 2):
        assert np.abs(np.subtract(first, second)).max() > 40


def test_an_inverted_block_grows_outwards():
    masses = grown("brutalist", even("brutalist"), form="inverted", towers=0)
    skins = [m for m in masses if m.zone in ("", "hooded", "banded")]
    areas = [m.plan.area for m in sorted(skins, key=lambda m: m.low)]
    assert len(areas) > 2
    assert areas == sorted(areas)


def test_decks_are_open_between_their_parapets():
    plot = even("parking")
    masses = grown("parking", plot, ramp="inner")
    decks = sorted((m.low, m.high) for m in masses if m.plan.area > 0.7 * plot.plan.area)
    assert len(decks) == plot.levels - 1
    for (_, below), (above, _) in pairwise(decks):
        assert above - below >= 1.5


def test_sample_buildings_close_with_the_roofs_they_ask_for_and_have_a_door():
    city = facade(shell(design(sample_city(sheet_of(NAMES, (1, 2))))))
    assert city.failures == ()
    doors = city.scene.instances["doors"]
    assert np.isin(city.layout.buildings["id"].to_numpy(np.uint64), doors.owner).all()


@pytest.mark.parametrize(
    ("module", "options"),
    [(glass_tower, {"form": "twist"}), (postmodern_tower, {"crown": "broken"})],
)
def test_one_building_becomes_such_a_tower(module, options):
    name = module.GENERATOR.name
    made = getattr(module, name)(example_city(), building="The Tower", floors=20, **options)
    assert (made.layout.buildings["generator"] == name).sum() == 1
    assert len(made.layout.parts) > len(example_city().layout.parts)
