import numpy as np
import pytest
import shapely
from skimage.color import rgb2lab

from cityx.assets.styles.materials import MATERIALS
from cityx.assets.styles.palettes import STYLES, family_of, finishes_for, without_material
from cityx.building.catalogue import generators
from cityx.building.selection import choose_generators
from cityx.city import Layout, make_table
from cityx.errors import UsageError
from cityx.places.profiles import profile_named

COUNT = 60


def row_of_houses(**columns):
    boxes = shapely.box(np.arange(COUNT) * 8.0, 0, np.arange(COUNT) * 8.0 + 8.0, 12)
    ids = np.arange(1, COUNT + 1, dtype=np.uint64) * 977
    use = np.full(COUNT, "apartments")
    buildings = make_table(
        "buildings", boxes, id=ids, use=use, levels=[5] * COUNT, place=["urban"] * COUNT
    )
    unsaid = {"wall_color": [-1] * COUNT, "roof_color": [-1] * COUNT}
    given = {"roof_shape": ["gabled"] * COUNT, **unsaid, **columns}
    parts = make_table("parts", boxes, id=ids, building=ids, use=use, levels=[5] * COUNT, **given)
    return Layout((0, 0, 480, 12), buildings, parts)


PLACES = ("us", "gb", "de", "fr", "nl", "fi", "ru", "it", "jp", "cn", "sg", "in", "ng", "mx", "au")


def finished(layout, seed, style="", place="europe"):
    profile = profile_named(place)
    design = choose_generators(layout, seed, style=style, place=profile)
    local = profile.buildings
    return finishes_for(layout, seed, design, generators(), style=style, local=local)


@pytest.mark.parametrize(
    ("style", "place"), [*((style, "europe") for style in STYLES), *(("", name) for name in PLACES)]
)
def test_every_style_gives_known_materials_and_colours(style, place):
    made = finished(row_of_houses(), 3, style, place)
    assert set(made.wall_material) <= set(MATERIALS)
    assert set(made.roof_material) <= set(MATERIALS)
    for tint in (made.wall_tint, made.roof_tint, made.trim_tint, made.frame_tint, made.accent_tint):
        assert tint.shape == (COUNT, 3)
        assert tint.dtype == np.float32
        assert ((tint >= 0) & (tint <= 1)).all()


def test_neighbours_differ():
    made = finished(row_of_houses(), 3, "european")
    same = np.abs(np.diff(made.wall_tint, axis=0)).max(axis=1) < 0.01
    assert same.mean() < 0.05


def test_the_input_wins():
    layout = row_of_houses(
        wall_color=[0xFF0000] * COUNT, wall_material=["brick"] * COUNT,
        roof_material=["slate"] * COUNT,
    )  # fmt: skip
    made = finished(layout, 0, "european")
    assert set(made.wall_material) == {"brick"}
    assert set(made.roof_material) == {"slate"}
    assert (made.wall_tint[:, 0] > 1.8 * made.wall_tint[:, 1:].max(axis=1)).all()


def test_unknown_material_words_change_nothing():
    layout = row_of_houses(wall_material=["unobtainium"] * COUNT)
    plain = finished(row_of_houses(), 0)
    assert (finished(layout, 0).wall_material == plain.wall_material).all()


def test_unknown_style_names_the_nearest():
    with pytest.raises(UsageError, match='"european"'):
        family_of("europaen")


def test_finishes_do_not_depend_on_the_other_buildings():
    whole = finished(row_of_houses(), 5)
    layout = row_of_houses()
    half = Layout(layout.extent, layout.buildings[:20].copy(), layout.parts[:20].copy())
    some = finished(half, 5)
    assert np.array_equal(some.wall_tint, whole.wall_tint[:20])
    assert np.array_equal(some.wall_material, whole.wall_material[:20])


def test_an_empty_layout_has_no_finishes():
    assert len(finished(Layout((0, 0, 1, 1)), 0).wall_material) == 0


def test_no_plaster_of_a_table_is_loud():
    looks = [look for each in generators().values() for look in each.looks().values()]
    drawn = {color for look in looks if look.old for _, material, colors in look.walls
             if material == "plaster" for color in colors}  # fmt: skip
    channels = [[color >> 16 & 255, color >> 8 & 255, color & 255] for color in sorted(drawn)]
    lab = rgb2lab(np.array(channels)[None] / 255)[0]
    assert len(drawn) > 40
    assert np.hypot(lab[:, 1], lab[:, 2]).max() < 33


def painted_in(color, walls, roofs):
    """Return how far the walls and the roofs of houses are from a colour that all have."""
    names = [(wall, roof) for wall in walls for roof in roofs]
    repeated = [names[i % len(names)] for i in range(COUNT)]
    made = finished(
        row_of_houses(
            wall_color=[color] * COUNT, roof_color=[color] * COUNT,
            wall_material=[wall for wall, _ in repeated],
            roof_material=[roof for _, roof in repeated],
        ), 3,
    )  # fmt: skip
    levels = np.array([color >> 16, color >> 8 & 255, color & 255]) / 255
    stated = np.where(levels <= 0.04045, levels / 12.92, ((levels + 0.055) / 1.055) ** 2.4)
    wanted = _lab(np.clip(stated, 0.03, 0.85))
    pairs = ((made.wall_material, made.wall_tint), (made.roof_material, made.roof_tint))
    seen = [np.array([MATERIALS[name].color for name in names]) * tint for names, tint in pairs]
    return np.array([np.linalg.norm(_lab(each) - wanted, axis=1) for each in seen])


def _lab(linear):
    """Return colours in CIELab, where 100 is from black to white."""
    srgb = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    return rgb2lab(np.clip(srgb, 0, 1).reshape(-1, 1, 3)).reshape(-1, 3)


@pytest.mark.parametrize("color", [0xFFD700, 0xFF0000, 0xFFFFFF, 0x000000, 0x87CEEB, 0x32CD32])
def test_a_stated_colour_comes_out_whatever_it_is_on(color):
    walls = ("glass", "brick", "stone", "concrete", "metal", "wood", "plaster", "")
    roofs = ("glass", "copper", "thatch", "gravel", "grass", "concrete", "slate", "tiles", "")
    far = painted_in(color, walls, roofs)
    assert far.max() < 36.0  # weathered paint; gold on dark glass was 80 off


def test_glass_without_a_colour_stays_what_it_is():
    made = finished(row_of_houses(wall_material=["glass"] * COUNT), 3)
    assert set(made.wall_material) == {"glass_wall"}
    tinted = finished(
        row_of_houses(wall_material=["glass"] * COUNT, wall_color=[0xFFD700] * COUNT), 3
    )
    assert {MATERIALS[name].root for name in tinted.wall_material} == {"glass_wall"}


@pytest.mark.parametrize(
    ("what", "words"),
    [
        ("wall", {"brick": "brick", "stone": "stone", "wood": "wood", "concrete": "concrete",
                  "plaster": "plaster", "glass": "glass_wall", "metal": "metal_panel",
                  "tin": "metal_panel", "timber_framing": "wood", "adobe": "plaster",
                  "eternit": "plaster", "brick;wood": "brick", "jelly; Sandstone": "stone"}),
        ("roof", {"tiles": "roof_tiles", "slate": "slate", "thatch": "thatch", "copper": "copper",
                  "tin": "roof_metal", "eternit": "slate", "grass": "grass",
                  "gravel": "roof_gravel",
                  "concrete": "concrete", "glass": "glass_wall", "tar_paper": "bitumen",
                  "wood": "wood", "metal": "roof_metal", "plants;gravel": "grass"}),
    ],
)  # fmt: skip
def test_a_stated_material_is_kept(what, words):
    said = [list(words)[i % len(words)] for i in range(COUNT)]
    layout = row_of_houses(**{f"{what}_material": said})
    made = finished(layout, 5)
    assert getattr(made, f"{what}_material").tolist() == [words[word] for word in said]
    assert not without_material(layout).any()


@pytest.mark.parametrize("word", ["jelly", "yes", "moon;cheese"])
def test_a_material_that_is_not_known_is_told(word):
    layout = row_of_houses(wall_material=[word, *[""] * (COUNT - 1)])
    assert np.flatnonzero(without_material(layout)).tolist() == [0]
