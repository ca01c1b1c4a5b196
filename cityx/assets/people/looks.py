"""How people look: what is drawn for each, and from which palettes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

from cityx.assets.people.bags import BAGS
from cityx.assets.people.clothes import BOTTOMS, SHOES, SKIRTS, TOPS
from cityx.assets.people.hair import HAIR, HATS, HELMETS
from cityx.assets.shapes import Color
from cityx.assets.styles.materials import srgb_to_linear
from cityx.errors import UsageError, nearest
from cityx.ids import draw, stable_id

T = TypeVar("T")
AGES = ("child", "adult", "elder")
SEXES = ("female", "male")
STYLES = ("casual", "business", "sport")
LEAST, MOST = 1.0, 2.0  # metres, height
_AGE_SHARES = {"child": 0.13, "adult": 0.70, "elder": 0.17}
# Mean and spread of the height of grown people, shoes included, metres.
_HEIGHTS = {"female": (1.66, 0.065), "male": (1.79, 0.070)}


def _linear(color: int) -> Color:
    """Linear RGB of sRGB, for a material that is 0.80."""
    red, green, blue = srgb_to_linear(color)
    return red / 0.8, green / 0.8, blue / 0.8


# (sRGB, share, whether hair may be fair) of skins, from pale to dark.
_SKINS = ((0xDDB59D, 0.16, True), (0xD2A286, 0.22, True), (0xC48E6E, 0.18, True),
          (0xB07A58, 0.14, False), (0x966444, 0.11, False), (0x7A4E35, 0.09, False),
          (0x5E3B28, 0.06, False), (0x46291D, 0.04, False))  # fmt: skip
_FAIR = {0x16110E: 0.14, 0x2A1C14: 0.28, 0x44301F: 0.24, 0x6A4A2C: 0.14, 0x98733F: 0.10,
         0xBE9C62: 0.05, 0x6E3318: 0.05}  # fmt: skip
_DARK = {0x100C0A: 0.62, 0x1E1410: 0.30, 0x33221A: 0.08}
_GREY = {0x5C5955: 0.2, 0x8E8B86: 0.4, 0xC6C3BD: 0.4}
_TOPS: Mapping[str, Mapping[str, float]] = {
    "female": {"t_shirt": 16, "blouse": 13, "shirt": 6, "jumper": 13, "hoodie": 5, "jacket": 12,
               "open_jacket": 10, "suit": 5, "coat": 8, "open_coat": 6, "dress": 9,
               "long_dress": 3},
    "male": {"t_shirt": 24, "shirt": 17, "jumper": 13, "hoodie": 10, "jacket": 15,
             "open_jacket": 10, "suit": 8, "coat": 5, "open_coat": 4},
    "child": {"t_shirt": 34, "jumper": 22, "hoodie": 22, "jacket": 22},
}  # fmt: skip
_BOTTOMS: Mapping[str, Mapping[str, float]] = {
    "female": {"slim trousers": 40, "trousers": 18, "wide trousers": 13, "shorts": 6, "skirt": 10,
               "short skirt": 6, "long skirt": 7},
    "male": {"slim trousers": 30, "trousers": 54, "wide trousers": 4, "shorts": 12},
    "child": {"slim trousers": 40, "trousers": 35, "shorts": 25},
}  # fmt: skip
# What is worn in a style instead; where a style says nothing, everything goes.
_STYLE_TOPS: Mapping[str, Mapping[str, Mapping[str, float]]] = {
    "casual": {
        "female": {"t_shirt": 30, "blouse": 16, "jumper": 18, "hoodie": 12, "open_jacket": 14},
        "male": {"t_shirt": 34, "shirt": 16, "jumper": 18, "hoodie": 18, "open_jacket": 14},
    },
    "business": {
        "female": {"suit": 52, "blouse": 28, "coat": 20},
        "male": {"suit": 62, "shirt": 22, "coat": 16},
    },
    "sport": {"female": {"t_shirt": 78, "hoodie": 22}, "male": {"t_shirt": 80, "hoodie": 20}},
}
_STYLE_BOTTOMS: Mapping[str, Mapping[str, Mapping[str, float]]] = {
    "casual": {
        "female": {"slim trousers": 56, "trousers": 22, "shorts": 12, "skirt": 10},
        "male": {"slim trousers": 40, "trousers": 42, "shorts": 18},
    },
    "business": {
        "female": {"slim trousers": 40, "trousers": 30, "skirt": 30}, "male": {"trousers": 100},
    },
    "sport": {
        "female": {"slim trousers": 66, "shorts": 34}, "male": {"shorts": 72, "slim trousers": 28},
    },
}  # fmt: skip
_HAIRS: Mapping[str, Mapping[str, float]] = {
    "female": {"long": 34, "bob": 19, "ponytail": 20, "bun": 11, "short": 6, "curly": 6, "afro": 4},
    "male": {"short": 52, "cropped": 24, "curly": 7, "receding": 8, "bald": 5, "bun": 1, "afro": 3},
    "old female": {"bob": 36, "short": 26, "curly": 22, "bun": 12, "long": 4},
    "old male": {"short": 26, "cropped": 14, "receding": 28, "wreath": 22, "bald": 10},
}  # fmt: skip
# Muted first, as in a street; strong colours are few.
_TOP_COLORS = {
    0x23262B: 14, 0x3A3E45: 9, 0x6C7076: 8, 0xA9ABAC: 5, 0xDCDAD4: 11, 0x22304A: 11, 0x3F5F8A: 6,
    0x86A3BF: 4, 0x4B2A2C: 3, 0x8C2F2E: 4, 0xB5544A: 2, 0x53583E: 5, 0x2F4A3C: 4, 0x6E8A72: 2,
    0xA8855A: 4, 0xC9B28C: 5, 0x6B4A35: 4, 0xC69A3A: 2, 0xC98F9B: 2, 0x6A5478: 2, 0x2E7F86: 2,
}  # fmt: skip
_BRIGHT = {0xB8342F: 5, 0xD9A627: 4, 0x2F6FB0: 6, 0x3E8F5A: 4, 0xE07A3A: 3, 0xD77C9A: 4,
           0x7A5BA6: 3, 0x2B2F3A: 4, 0xE3E0D8: 5, 0x5E9AA8: 4}  # fmt: skip
_COAT_COLORS = {0x1D1F23: 18, 0x2B3242: 12, 0x4A4C50: 10, 0xA98B62: 10, 0x6B5138: 7, 0x54302E: 4,
                0x4B5040: 7, 0x8B8D90: 5, 0x7A2B2B: 3, 0xCFC3AE: 4}  # fmt: skip
_SHIRT_COLORS = {0xE4E4E2: 40, 0xA9C0DA: 18, 0xC9CDD2: 8, 0xE2CFCB: 4, 0x2A3346: 8, 0x55657A: 7}
_BOTTOM_COLORS = {0x1B1C1F: 20, 0x2A2D33: 10, 0x25324A: 18, 0x3B4F70: 14, 0x64799A: 7, 0x5A5B5E: 7,
                  0x8A7B62: 7, 0xB7A582: 5, 0x4A4A38: 4, 0x4A362A: 4, 0xCFCBC0: 2}  # fmt: skip
_SHOE_COLORS = {0x17171A: 30, 0x3A2418: 16, 0x5E3C24: 9, 0x2B2F38: 8, 0x6A6560: 4, 0x7A2B26: 2}
_TRAINERS = {0xDEDCD6: 36, 0x1C1D20: 24, 0x6E7277: 12, 0x2A3A5E: 8, 0xA33A34: 4, 0x55705F: 3}
_BAG_COLORS = {0x1B1C1F: 30, 0x2B3A55: 10, 0x5A3A26: 12, 0x8A5A36: 8, 0x4C5442: 8, 0x7E2E2C: 5,
               0x8A8D90: 7, 0xC9B48E: 4}  # fmt: skip
_TIES = {0x7A1F24: 4, 0x1F2C4D: 5, 0x2A2A2E: 3, 0x3C5A48: 2}
_WARM = frozenset({"jumper", "hoodie", "jacket", "open_jacket", "coat", "open_coat"})
_WRAPS = frozenset({"jacket", "open_jacket", "suit", "coat", "open_coat"})


@dataclass(frozen=True)
class Person:
    """What a person looks like.

    Attributes
    ----------
    age, sex
        Of `AGES` and `SEXES`.
    height
        Metres from the ground to the top of the hair, shoes included, hats not.
    build
        -1 slim to 1 stout.
    skin, hair_color
        Linear RGB.
    hair
        Key of `HAIR`.
    beard
        0 none to 1 full and long.
    top
        Key of `TOPS`.
    under
        Key of `TOPS` worn under an open one, or "".
    bottom
        Key of `BOTTOMS` or `SKIRTS`, or "" under a dress.
    tights
        Whether bare legs are covered by tights of the colour of the shoes.
    shoes
        Of `SHOES`.
    hat, bag
        Of `HATS` or `HELMETS`, and of `BAGS`, or "".
    tucked
        Whether the top is tucked into the trousers.
    tie
        Whether a tie is worn.
    top_color, under_color, bottom_color, shoe_color, sole_color, hat_color, tie_color, bag_color
        Linear RGB.

    Raises
    ------
    UsageError
        If a word is unknown or the height is out of range.
    """

    age: str = "adult"
    sex: str = "female"
    height: float = 1.68
    build: float = 0.0
    skin: Color = (0.55, 0.30, 0.20)
    hair_color: Color = (0.03, 0.018, 0.01)
    hair: str = "short"
    beard: float = 0.0
    top: str = "t_shirt"
    under: str = ""
    bottom: str = "trousers"
    tights: bool = False
    shoes: str = "shoes"
    hat: str = ""
    bag: str = ""
    tucked: bool = False
    tie: bool = False
    top_color: Color = (0.5, 0.5, 0.5)
    under_color: Color = (0.7, 0.7, 0.7)
    bottom_color: Color = (0.03, 0.04, 0.08)
    shoe_color: Color = (0.03, 0.03, 0.03)
    sole_color: Color = (0.03, 0.03, 0.03)
    hat_color: Color = (0.03, 0.03, 0.03)
    tie_color: Color = (0.15, 0.02, 0.02)
    bag_color: Color = (0.03, 0.03, 0.03)

    def __post_init__(self) -> None:
        """Refuse words that name nothing."""
        if not LEAST <= self.height <= MOST:
            raise UsageError(f"People are {LEAST} to {MOST} m high, not {self.height} m.")
        known: dict[str, Sequence[str]] = {
            "age": AGES, "sex": SEXES, "hair": tuple(HAIR), "top": tuple(TOPS),
            "under": ("", *TOPS), "bottom": ("", *BOTTOMS, *SKIRTS), "shoes": SHOES,
            "hat": ("", *HATS, *HELMETS), "bag": ("", *BAGS),
        }  # fmt: skip
        for name, words in known.items():
            word = getattr(self, name)
            if word not in words:
                raise UsageError(
                    f'A person has no {name} "{word}"; known: {", ".join(filter(None, words))}.'
                    f"{nearest(word, words)}"
                )


def drawn_person(
    number: int, *, seed: int = 0, age: str = "", sex: str = "", style: str = ""
) -> Person:
    """Draw a person.

    Parameters
    ----------
    number
        Of the person; the same arguments give the same one.
    seed
        Key of all draws.
    age, sex
        Of `AGES` and `SEXES`, or "" for any.
    style
        Of `STYLES`, or "" for whatever people wear.
    """
    key = stable_id("person", number, age, *filter(None, (sex, style)))

    def share(what: str) -> float:
        return draw(seed, f"people/{what}", key)

    def word(what: str, weights: Mapping[str, float]) -> str:
        return _pick(weights, share(what))

    def color(what: str, weights: Mapping[int, float]) -> Color:
        return _linear(_pick(weights, share(what)))

    age = age or word("age", _AGE_SHARES)
    sex = sex or SEXES[int(share("sex") < 0.5)]
    kind = "child" if age == "child" else sex
    tone = _pick({row: row[1] for row in _SKINS}, share("skin"))
    hair = word("hair", _HAIRS[f"old {sex}" if age == "elder" else sex])
    if hair == "afro" and tone[2]:
        hair = "curly"
    if age == "child" and hair in ("bald", "receding", "bun"):
        hair = "short" if sex == "male" else "ponytail"
    grey = age == "elder" and share("grey") < 0.85
    tops, bottoms = _TOPS[kind], _BOTTOMS[kind]
    if style and age != "child":
        tops, bottoms = _STYLE_TOPS[style][sex], _STYLE_BOTTOMS[style][sex]
    top = word("top", tops)
    bottom = "" if "dress" in top else word("bottom", bottoms)
    if top == "suit" and bottom in ("shorts", "short skirt"):
        bottom = "trousers"
    if age == "elder" and bottom in ("shorts", "short skirt", "slim trousers"):
        bottom = "trousers"
    shoes = word("shoes", {"shoes": 45, "trainers": 40, "boots": 15})
    shoes = {"child": "trainers"}.get(age, "shoes" if top == "suit" else shoes)
    if style == "sport":
        shoes = "trainers"
    if shoes == "boots" and (bottom in BOTTOMS or bottom == ""):
        shoes = "shoes"  # trousers would cover them
    worn = color("shoe color", _TRAINERS if shoes == "trainers" else _SHOE_COLORS)
    hat = word("hat", {"": 82, "cap": 8, "beanie": 6 if top in _WARM else 0, "brimmed hat": 4})
    bag = word("bag", {"": 56, "backpack": 22, "handbag": 14 if sex == "female" else 1,
                       "shopping bag": 8})  # fmt: skip
    if age == "child" and bag == "handbag":
        bag = "backpack"
    if style == "sport":
        bag = ""
    if top in ("coat", "open_coat", "suit") and hat == "cap":
        hat = ""
    palette: Mapping[int, float] = _TOP_COLORS
    if top in _WRAPS:
        palette = _COAT_COLORS
    elif top == "shirt":
        palette = _SHIRT_COLORS
    if age == "child" or (sex == "female" and top != "suit" and share("bright") < 0.2):
        palette = _BRIGHT
    top_color = color("top color", palette)
    bottom_color = color("bottom color", _BOTTOM_COLORS)
    suited = top == "suit"
    return Person(
        age=age,
        sex=sex,
        height=_height(age, sex, share("height"), share("height more")),
        build=round(_bell(share("build"), share("build more"), 0.42, 1.0)
                    + 0.2 * (age == "elder"), 3),
        skin=_linear(tone[0]),
        hair_color=color("hair color", _GREY if grey else _FAIR if tone[2] else _DARK),
        hair=hair,
        beard=_beard(share("beard")) if sex == "male" and age != "child" else 0.0,
        top=top,
        under=word("under", {"shirt": 5, "t_shirt": 4, "jumper": 3 * (not suited)})
        if TOPS[top].open else "",
        bottom=bottom,
        tights=bottom not in BOTTOMS and share("tights") < 0.5,
        shoes=shoes,
        hat=hat,
        bag=bag,
        tucked=top in ("shirt", "blouse") and share("tucked") < 0.6,
        tie=suited and sex == "male" and share("tie") < 0.6,
        top_color=top_color,
        under_color=color("under color", _SHIRT_COLORS),
        bottom_color=top_color if suited and share("one cloth") < 0.8 else bottom_color,
        shoe_color=worn,
        sole_color=_linear(0xE2E0DA) if shoes == "trainers" else _linear(0x1A1816),
        hat_color=color("hat color", _COAT_COLORS),
        tie_color=color("tie color", _TIES),
        bag_color=color("bag color", _BAG_COLORS),
    )  # fmt: skip


def words_of(person: Person) -> str:
    """Describe a person in a few words."""
    from cityx.assets.library.descriptions import color_words

    def tinted(color: Color, thing: str) -> str:
        red, green, blue = color
        name = str(color_words([(0.8 * red, 0.8 * green, 0.8 * blue)])[0])
        return f"{name} {thing}"

    noun = {
        "child": {"female": "girl", "male": "boy"},
        "adult": {"female": "woman", "male": "man"},
        "elder": {"female": "elderly woman", "male": "elderly man"},
    }[person.age][person.sex]
    worn = [tinted(person.top_color, TOPS[person.top].words)]
    if person.bottom:
        worn.append(tinted(person.bottom_color, person.bottom))
    if person.hat:
        worn.append(tinted(person.hat_color, person.hat))
    if person.bag:
        worn.append(tinted(person.bag_color, person.bag))
    hair = "bald" if person.hair == "bald" else tinted(person.hair_color, f"{person.hair} hair")
    return f"{noun}, person, pedestrian, {hair}, {', '.join(worn)}"  # fmt: skip


def _pick(weights: Mapping[T, float], share: float) -> T:
    """Choose a key by its weight; `share` is uniform in [0, 1)."""
    left = share * sum(weights.values())
    for key, weight in weights.items():
        left -= weight
        if left < 0:
            return key
    return next(reversed(list(weights)))


def _bell(first: float, second: float, spread: float, most: float) -> float:
    """Turn two uniform draws into a normal one about zero, cut off at `most`."""
    radius = math.sqrt(-2.0 * math.log(max(first, 1e-12)))
    return max(-most, min(most, spread * radius * math.cos(2.0 * math.pi * second)))


def _height(age: str, sex: str, first: float, second: float) -> float:
    if age == "child":
        return round(1.02 + 0.55 * first, 3)
    mean, spread = _HEIGHTS[sex]
    mean -= 0.04 * (age == "elder")
    return round(mean + _bell(first, second, spread, 0.19), 3)


def _beard(share: float) -> float:
    """Length of a beard: most men have none."""
    return 0.0 if share < 0.66 else round(0.15 + 0.85 * ((share - 0.66) / 0.34) ** 2, 2)
