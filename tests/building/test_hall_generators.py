from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import shapely

from cityx.assets.fixtures import fixture, names
from cityx.building.catalogue import generators
from cityx.building.design import design
from cityx.building.facade.facade import facade
from cityx.building.generators.civic.church import masses as church_masses
from cityx.building.generators.civic.hospital import masses as hospital_masses
from cityx.building.generators.civic.mosque import masses as mosque_masses
from cityx.building.generators.civic.school import masses as school_masses
from cityx.building.generators.civic.stadium import masses as stadium_masses
from cityx.building.generators.civic.station_hall import masses as station_masses
from cityx.building.generators.trade.big_box import masses as store_masses
from cityx.building.generators.trade.petrol_station import masses as petrol_masses
from cityx.building.generators.trade.sawtooth_factory import masses as factory_masses
from cityx.building.generators.trade.warehouse import masses as warehouse_masses
from cityx.building.massing.massing import Plot
from cityx.building.samples import sample_city, sheet_of
from cityx.building.shell import shell
from cityx.city.city import City

KINDS = ("church", "mosque", "school", "hospital", "stadium", "station_hall", "warehouse",
         "sawtooth_factory", "big_box", "petrol_station")  # fmt: skip
SEEDS = (1, 2, 3)


def plots(name, **more):
    return [
        Plot(each.outline, each.height, each.levels, each.id, front=(0.0, -1.0), **more)
        for each in sheet_of([name], SEEDS)
    ]


def awkward(name):
    yard = shapely.box(0, 0, 60, 50).difference(shapely.box(18, 16, 42, 34))
    ell = shapely.union_all([shapely.box(0, 0, 44, 14), shapely.box(0, 0, 14, 40)])
    cross = shapely.union_all([shapely.box(0, 10, 50, 22), shapely.box(30, 0, 42, 32)])
    thin = shapely.affinity.rotate(shapely.box(0, 0, 60, 3), 33)
    shapes = [yard, ell, cross, thin, shapely.Polygon([(0, 0), (30, 0), (0, 25)]),
              shapely.Point(5, 9).buffer(22, quad_segs=6), shapely.box(0, 0, 7, 6)]  # fmt: skip
    kind = generators()[name]
    height = kind.storey * kind.floors[0]
    return [Plot(shape, height, kind.floors[0], 77, front=(0.3, -0.95)) for shape in shapes]


def shared(masses):
    """Square metres in which volumes lie within one another, of the worst pair."""
    worst = 0.0
    for i, a in enumerate(masses):
        for b in masses[i + 1 :]:
            if min(a.high, b.high) - max(a.low, b.low) > 1e-6:
                worst = max(worst, a.plan.intersection(b.plan).area)
    return worst


def plans(masses):
    return shapely.union_all(np.array([mass.plan for mass in masses if mass.low < 0.05]))


@pytest.mark.parametrize("name", KINDS)
def test_volumes_share_no_interior_and_stay_on_the_plot(name):
    kind = generators()[name]
    for plot in plots(name) + awkward(name):
        masses = kind.mass(plot)
        assert masses
        assert shared(masses) < 0.5
        room = plot.plan if kind.covers else shapely.Polygon(plot.plan.exterior)
        for mass in masses:
            assert mass.plan.is_valid
            assert mass.height > max(mass.rise, 0.4) - 1e-9
            assert mass.plan.difference(room.buffer(0.1)).area < 0.2


@pytest.mark.parametrize("name", [name for name in KINDS if generators()[name].covers])
def test_the_footprint_is_covered_at_the_ground(name):
    for plot in plots(name) + awkward(name):
        assert plans(generators()[name].mass(plot)).area > 0.97 * plot.plan.area


@pytest.mark.parametrize("name", KINDS)
def test_the_same_seed_grows_the_same_and_noise_can_be_left_out(name):
    kind = generators()[name]
    for plot in plots(name):
        assert kind.mass(plot) == kind.mass(plot)
    first, other = plots(name)[0], replace(plots(name)[0], seed=9)
    assert kind.mass(first) != kind.mass(other)
    still = kind.mass(replace(first, noise=0.0))
    assert still == kind.mass(replace(first, noise=0.0))


@cache
def raised() -> City:
    return facade(shell(design(sample_city(sheet_of(KINDS, SEEDS)))))


def test_sample_buildings_close_without_a_simpler_roof():
    city = raised()
    assert [failure.message for failure in city.failures] == []
    assert len(city.scene.meshes["buildings"].object_id) == len(KINDS) * len(SEEDS)


def test_the_looks_put_their_fixtures_on_the_samples():
    made = {each.name for each in raised().scene.prototypes}
    wanted = {"rose_window", "buttress", "finial_crescent", "arcade_bay", "letters_school",
              "cross_sign", "helipad_marks", "pitch_field", "floodlight", "grand_window",
              "loading_dock", "water_tank", "sign_board", "pump_island", "price_totem"}  # fmt: skip
    assert wanted - made == set()


def test_parameters_change_the_volumes():
    plot = plots("church")[0]
    tall = max(mass.high for mass in church_masses(plot, tower=2.0))
    assert tall > max(mass.high for mass in church_masses(plot)) + 5.0
    zones = {mass.zone for mass in church_masses(plot, tower=0.0)}
    assert "tower" not in zones
    plot = plots("mosque")[0]
    count = [sum(mass.zone == "cone" for mass in mosque_masses(plot, minarets=k)) for k in range(5)]
    assert count == [0, 1, 2, 3, 4]
    plot = plots("school")[0]
    assert all(mass.zone != "gym" for mass in school_masses(plot, gym=0.0))
    plot = plots("hospital")[0]
    areas = {
        word: round(sum(m.plan.area for m in hospital_masses(plot, plan=word) if m.zone == "ward"))
        for word in ("slab", "cross", "h", "comb", "tee")
    }
    assert len(set(areas.values())) == 5
    plot = plots("stadium")[0]
    assert len(stadium_masses(plot, tiers=14)) == len(stadium_masses(plot, tiers=9)) + 5
    assert all(mass.zone != "cover" for mass in stadium_masses(plot, roof=0.0))


def test_parameters_of_halls_change_the_volumes():
    plot = plots("station_hall")[0]
    sheds = [m for m in station_masses(plot, spans=4) if m.zone == "shed"]
    assert len(sheds) == 4
    plot = plots("warehouse")[0]
    assert all(m.zone == "" for m in warehouse_masses(plot, docks=False, office=0.0))
    plot = plots("sawtooth_factory")[0]
    zones = {m.zone for m in factory_masses(plot, chimney=0.0, tank=False)}
    assert not zones & {"shaft", "stack", "tank"}
    plot = plots("big_box")[0]
    assert sum(m.zone == "portal" for m in store_masses(plot, units=3)) == 3
    plot = plots("petrol_station")[0]
    assert sum(m.zone == "pumps" for m in petrol_masses(plot, rows=3)) == 3


def test_a_church_without_noise_has_aisles_alike():
    plot = Plot(shapely.box(0, 0, 44, 16), 14.0, 1, 5, front=(0.0, -1.0), noise=0.0)
    aisles = [m for m in church_masses(plot) if m.roof == "skillion"]
    assert len(aisles) == 2
    assert aisles[0].plan.area == pytest.approx(aisles[1].plan.area, rel=0.02)
    assert np.cos(aisles[0].direction - aisles[1].direction) == pytest.approx(-1.0)


def test_a_mapped_bowl_keeps_its_pitch():
    ring = shapely.Point(0, 0).buffer(80).difference(shapely.Point(0, 0).buffer(52))
    masses = stadium_masses(Plot(ring, 22.0, 5, 3))
    pitch = next(mass for mass in masses if mass.zone == "pitch")
    assert pitch.plan.area == pytest.approx(np.pi * 52**2, rel=0.03)


@pytest.mark.parametrize("word", ["halls", "worship", "trade"])
def test_fixtures_are_small_and_stand_before_their_wall(word):
    from importlib import import_module

    for name in import_module(f"cityx.assets.fixtures.{word}").MAKERS:
        assert name in names()
        mesh = fixture(name).mesh
        assert np.isfinite(mesh.vertices).all()
        assert 0 < len(mesh.faces) < 1600
        assert mesh.vertices[:, 1].min() < 0.1


def test_a_canopy_on_posts_stands_on_no_street():
    city = design(sample_city(sheet_of(["hospital"], SEEDS)))  # streets run 7 m before the doors
    found = []
    for width, walk in ((2.0, 0.0), (2.0, 3.0), (8.0, 0.0)):
        roads = city.layout.roads.assign(width=width, sidewalk_left=walk, sidewalk_right=walk)
        trims = facade(shell(replace(city, layout=replace(city.layout, roads=roads)))).scene
        names_of = [prototype.name for prototype in trims.prototypes]
        rows = trims.instances["trims"].prototype.tolist()
        found.append(sum(names_of[row] == "canopy_ambulance" for row in rows))
    assert found == [len(SEEDS), 0, 0]
