"""Lettering: words in real letters, for signs.

``glyphs.npz`` holds outlines of Inter and Noto Sans CJK (SIL Open Font License 1.1), which
`cityx.blender.glyphs` takes from the fonts that come with Blender. One em is 1 m; a letter stands
on its baseline in the plane of x and z and looks along -y.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.assets.shapes import prototype
from cityx.city.mesh import NO_VERTEX, MeshBatch, one_mesh
from cityx.city.scene import Prototype
from cityx.geometry.polygons import rings_of, triangulate

FILE = Path(__file__).with_name("glyphs.npz")
GRID = 0.001  # em, of the outlines in the file
FIRST_EAST_ASIAN = 0x2E80  # code from which characters fill a square
FINE = 3  # level of detail from which letters have sides
GAP, SPACE = 0.085, 0.27  # em between letters and between words
GLYPH = "sign_glyph_"  # names of prototypes of letters begin so
CAP = 0.73  # em, height of capitals
DEEP = 1.0  # metres that a prototype stands out; its instances are squeezed to some centimetres
# Common in names of shops and of what they sell.
KANJI = (
    "一二三四五六七八九十百千万円日月火水木金土年時分上下左右中大小新古本店屋館堂院所局舎亭庵軒荘園"
    "町村市区都道府県国東西南北京阪神奈横浜名銀座谷田川山原野橋駅前通坂森林花草竹梅松桜菊藤鳥魚"
    "貝馬牛豚鶏肉米麺飯丼鍋焼揚煮蒸生食酒茶珈琲味菓子餅粥汁寿司鮨鰻蕎麦餃珍喫居薬粧洗濯理美容髪"
    "眼鏡靴服布革宝石時計玩具書文房電気家工事務不動産銀行信用金庫保険旅歯科医接骨整体鍼灸療質買"
    "取専門直送自然有限会社公司商豆腐湯温泉光天空海風雪春夏秋冬福寿喜楽美和幸愛夢心青赤白黒緑紅"
    "呉果洋精華車転料理汽港梁塔窓壁灯門"
    "龍虎鶴亀丸吉富士高安井佐伊加藤鈴木村中島清水長久保岡本近江浅草築地王将太郎元祖本格横丁台所"
    "炭串炉端郵便写真印刷教室塾学校英語音楽着物古着雑貨文具陶器仏壇茶房手打名物営業案内第号階番街"
    "角並内外昔無料定休別当正直味噌塩醤油辛濃厚系担々立飲処旬菜彩鮮魚海老蟹牡蠣刺身盛合"
)


def characters() -> str:
    """Return every character that outlines are kept of, in order."""
    ranges = ((0x21, 0x7E), (0xA1, 0x17F), (0x391, 0x3C9), (0x410, 0x44F), (0x3041, 0x3096),
              (0x30A1, 0x30FC))  # fmt: skip
    wanted = {chr(code) for low, high in ranges for code in range(low, high + 1)}
    return "".join(sorted(wanted | set(KANJI) | set("’–Ёё々")))


@cache
def outlines() -> Mapping[str, Any]:
    """Return the shape of every character, polygons in em."""
    with np.load(FILE) as held:
        rings = shapely.linearrings(held["points"] * GRID, indices=held["ring"])
        pieces = shapely.polygons(rings, indices=held["piece"])
        first = np.searchsorted(held["glyph"], np.arange(len(held["letters"]) + 1))
        return MappingProxyType(
            {
                letter: shapely.multipolygons(pieces[first[k] : first[k + 1]])
                for k, letter in enumerate(held["letters"].tolist())
            }
        )


def is_known(text: str) -> bool:
    """Tell whether there are outlines of all letters of a text."""
    return bool(text.strip()) and all(letter in outlines() for letter in text if letter != " ")


@cache
def spans() -> Mapping[str, tuple[float, float]]:
    """Return where each character begins and ends, em; those of East Asia fill a square."""
    found = {}
    for letter, shape in outlines().items():
        low, _, high, _ = shape.bounds
        if ord(letter) >= FIRST_EAST_ASIAN:  # its outline stands in the middle of its square
            low, high = (low + high) / 2 - 0.5, (low + high) / 2 + 0.5
        found[letter] = (low, high)
    return MappingProxyType(found)


@dataclass(frozen=True)
class Line:
    """A text set in one line.

    Attributes
    ----------
    letters
        Characters that show, k of them.
    middle
        (k,) em from the middle of the line to that of each.
    width
        Em.
    """

    letters: tuple[str, ...]
    middle: NDArray[np.float64]
    width: float


@lru_cache(maxsize=4096)
def line_of(text: str) -> Line:
    """Set a text, whose letters must all be known, in one line."""
    pen, letters, middles = 0.0, [], []
    for letter in text:
        if letter == " ":
            pen += SPACE
            continue
        low, high = spans()[letter]
        letters.append(letter)
        middles.append(pen + (high - low) / 2)
        pen += high - low + (GAP if ord(letter) < FIRST_EAST_ASIAN else 0.06)
    width = max(pen - GAP, 0.0)
    return Line(tuple(letters), np.array(middles) - width / 2, width)


def glyph_name(letter: str) -> str:
    """Return the name of the prototype of a letter; signs shine at night by their first word."""
    return f"{GLYPH}{ord(letter):04x}"


@lru_cache(maxsize=2048)
def glyph(letter: str, *, detail: int = 2) -> Prototype:
    """Make the prototype of a letter: 1 em high, `DEEP` deep, its middle over the origin."""
    shape = _raised(letter, "sign", sides=detail >= FINE)
    fine = "_fine" if detail >= FINE else ""
    return prototype(glyph_name(letter) + fine, "trim", [shape])


def _raised(letter: str, material: str, *, sides: bool) -> MeshBatch:
    """Raise a letter by `DEEP` towards -y, without its back."""
    shape = outlines()[letter]
    low, high = spans()[letter]
    flat = shapely.orient_polygons(shapely.get_parts(shape))
    rings = rings_of(flat)
    faces = triangulate(flat, rings).triangles
    at = rings.points - [(low + high) / 2, 0.0]
    count = len(at)
    front = np.column_stack([at[:, 0], np.full(count, -DEEP), at[:, 1]])
    quads = np.column_stack([faces, np.full(len(faces), NO_VERTEX)])
    if not sides:
        return one_mesh(0, front, quads, materials=(material,))
    back = np.column_stack([at[:, 0], np.zeros(count), at[:, 1]])
    here = np.arange(count)
    after = here + 1
    last = rings.start[1:] - 1
    after[last] = rings.start[:-1]
    around = np.column_stack([count + here, count + after, after, here])
    return one_mesh(0, np.vstack([front, back]), np.vstack([quads, around]), materials=(material,))


def word(
    text: str, reach: float, low: float, high: float, front: float, material: str = "lamp_glow",
    *, deep: float = 0.03, upright: bool = False,
) -> list[MeshBatch]:  # fmt: skip
    """Make a word that is part of a thing, as large as its field admits.

    Parameters
    ----------
    text
        Of known letters.
    reach
        Half the width that it may take, metres.
    low, high
        Lower and upper edge of the field, metres.
    front
        y of the face that it is fixed on, metres.
    material
        What it is made of.
    deep
        Metres that it stands out.
    upright
        Whether the letters stand one above the other.
    """
    line = line_of(text)
    count = len(line.letters)
    if upright:
        size = min(2 * reach / 0.95, (high - low) / max(count, 1))
        step = (high - low) / max(count, 1)
        places = [(0.0, high - (k + 0.5) * step - 0.37 * size) for k in range(count)]
    else:
        size = min((high - low) / CAP, 2 * reach / max(line.width, 0.1))
        foot = (low + high - CAP * size) / 2
        places = [(size * x, foot) for x in line.middle.tolist()]
    made = []
    for letter, (x, z) in zip(line.letters, places, strict=True):
        shape = _raised(letter, material, sides=True)
        points = shape.vertices * [size, deep / DEEP, size] + [x, front, z]
        made.append(replace(shape, vertices=points))
    return made
