import numpy as np
import pytest

from cityx.assets.shops.lettering import COLORS, FORMS, GLYPH, neon
from cityx.building.design import design, raised
from cityx.building.samples import sample_city, sheet_of
from cityx.building.shops.neon_signs import LAYER, neon_signs
from cityx.checks.predicates import measure
from cityx.city.content import content_hash


@pytest.fixture(scope="module")
def street():
    """Towers and houses with shops."""
    kinds = ["setback_skyscraper", "glass_tower", "mixed_use", "shop_house"]
    return raised(design(sample_city(sheet_of(kinds, (1, 2, 3)))))


def test_signs_of_shops_and_edges_of_towers_glow(street):
    lit = neon_signs(street, share=1.0)
    rows = lit.scene.instances[LAYER]
    names = np.array([p.name for p in lit.scene.prototypes])[rows.prototype]
    assert {name.split("_")[1] for name in names} == {"board", "line", "blade"}
    assert measure("n(light, type=neon) >= 20", lit).met
    assert measure("n(light, type=neon) <= 3", street).met  # beacons of towers


def test_a_board_takes_the_place_of_its_sign(street):
    lit = neon_signs(street, share=1.0)
    before, after = street.scene.instances["trims"], lit.scene.instances["trims"]
    letter = np.array([p.name.startswith(GLYPH) for p in street.scene.prototypes])
    gone = np.setdiff1d(before.object_id[~letter[before.prototype]], after.object_id)
    rows = lit.scene.instances[LAYER]
    boards = np.isin(rows.object_id, gone)
    assert boards.sum() == len(gone) > 0
    old = np.isin(before.object_id, gone)
    place = before.position[old][np.argsort(before.object_id[old])]
    assert np.allclose(rows.position[boards], place)


def test_neon_belongs_to_buildings_and_has_ids_of_its_own(street):
    lit = neon_signs(street)
    rows = lit.scene.instances[LAYER]
    assert np.isin(rows.owner, street.layout.buildings["id"]).all()
    ids = np.concatenate([r.object_id for r in lit.scene.instances.values()])
    assert len(np.unique(ids)) == len(ids)


def test_neon_is_the_same_twice_and_grows_with_its_share(street):
    few, again, many = neon_signs(street, share=0.3), neon_signs(street, share=0.3), street
    assert content_hash(few).total == content_hash(again).total
    many = neon_signs(street, share=0.9)
    inside = np.isin(few.scene.instances[LAYER].object_id, many.scene.instances[LAYER].object_id)
    assert inside.all()


def test_lines_run_along_walls_and_not_through_them(street):
    lit = neon_signs(street, share=1.0)
    rows = lit.scene.instances[LAYER]
    names = np.array([p.name for p in lit.scene.prototypes])[rows.prototype]
    lines = np.char.startswith(names, "neon_line")
    flat = lines & (rows.rotation[:, 1] == 0)
    assert flat.any()
    middle = rows.position[flat].copy()
    turn = rows.rotation[flat, 2]
    middle[:, 0] += np.cos(turn) * rows.scale[flat, 0] / 2
    middle[:, 1] += np.sin(turn) * rows.scale[flat, 0] / 2
    import shapely

    parts = street.layout.parts
    for owner, point in zip(rows.owner[flat], middle, strict=True):
        own = parts.geometry[(parts["building"] == owner).to_numpy()].to_numpy()
        away = shapely.distance(shapely.boundary(own), shapely.points(point[:2]))
        assert 0.05 < away.min() < 0.15


def test_of_a_village_the_city_says_that_nothing_is_lit():
    village = raised(design(sample_city(sheet_of(["cottage"], (1,)))))
    (note,) = neon_signs(village, share=1.0).notes[len(village.notes) :]
    assert note == ("Nothing is lit with neon: no building has signs of shops or is 40 m high.")


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("color", COLORS)
def test_every_neon_light_glows_in_its_color(form, color):
    fine, plain = neon(form, color, detail=3), neon(form, color)
    assert f"neon_{color}" in plain.mesh.materials
    assert len(fine.mesh.faces) > len(plain.mesh.faces)
