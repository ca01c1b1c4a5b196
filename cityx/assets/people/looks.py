"""How people look: what is drawn for each, and from which palettes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

from cityx.assets.people.clothes import BAGS, BOTTOMS, SHOES, SKIRTS, TOPS
from cityx.assets.people.gear import GEAR
from cityx.assets.people.head import HAIR, HATS, HELMETS
from cityx.assets.shapes import Color
from cityx.assets.styles.materials import srgb_to_linear
from cityx.errors import UsageError, nearest
from cityx.ids import draw, stable_id
from cityx.system.tables import load, table

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
_SKINS = load("assets/people", tuple[tuple[int, float, bool], ...], "skins")
_COLORS = table("assets/people", dict[int, float], "colors")
_TOPS = table("assets/people", dict[str, float], "tops")
_BOTTOMS = table("assets/people", dict[str, float], "bottoms")
# What is worn in a style instead; where a style says nothing, everything goes.
_STYLE_TOPS = table("assets/people", dict[str, dict[str, float]], "style_tops")
_STYLE_BOTTOMS = table("assets/people", dict[str, dict[str, float]], "style_bottoms")
_HAIRS = table("assets/people", dict[str, float], "hairs")
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
    gear
        Of `GEAR`, "" for none; its cloth has the colour of the bag.

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
    gear: str = ""

    def __post_init__(self) -> None:
        """Refuse words that name nothing."""
        if not LEAST <= self.height <= MOST:
            raise UsageError(f"People are {LEAST} to {MOST} m high, not {self.height} m.")
        known: dict[str, Sequence[str]] = {
            "age": AGES, "sex": SEXES, "hair": tuple(HAIR), "top": tuple(TOPS),
            "under": ("", *TOPS), "bottom": ("", *BOTTOMS, *SKIRTS), "shoes": SHOES,
            "hat": ("", *HATS, *HELMETS), "bag": ("", *BAGS), "gear": ("", *GEAR),
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
    worn = color("shoe color", _COLORS["trainers"] if shoes == "trainers" else _COLORS["shoes"])
    hat = word("hat", {"": 82, "cap": 8, "beanie": 6 if top in _WARM else 0, "brimmed hat": 4})
    bag = word("bag", {"": 56, "backpack": 22, "handbag": 14 if sex == "female" else 1,
                       "shopping bag": 8})  # fmt: skip
    if age == "child" and bag == "handbag":
        bag = "backpack"
    if style == "sport":
        bag = ""
    if top in ("coat", "open_coat", "suit") and hat == "cap":
        hat = ""
    palette: Mapping[int, float] = _COLORS["tops"]
    if top in _WRAPS:
        palette = _COLORS["coats"]
    elif top == "shirt":
        palette = _COLORS["shirts"]
    if age == "child" or (sex == "female" and top != "suit" and share("bright") < 0.2):
        palette = _COLORS["bright"]
    top_color = color("top color", palette)
    bottom_color = color("bottom color", _COLORS["bottoms"])
    suited = top == "suit"
    return Person(
        age=age,
        sex=sex,
        height=_height(age, sex, share("height"), share("height more")),
        build=round(_bell(share("build"), share("build more"), 0.42, 1.0)
                    + 0.2 * (age == "elder"), 3),
        skin=_linear(tone[0]),
        hair_color=color("hair color", _COLORS["grey" if grey else "fair" if tone[2] else "dark"]),
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
        under_color=color("under color", _COLORS["shirts"]),
        bottom_color=top_color if suited and share("one cloth") < 0.8 else bottom_color,
        shoe_color=worn,
        sole_color=_linear(0xE2E0DA) if shoes == "trainers" else _linear(0x1A1816),
        hat_color=color("hat color", _COLORS["coats"]),
        tie_color=color("tie color", _COLORS["ties"]),
        bag_color=color("bag color", _COLORS["bags"]),
    )  # fmt: skip


def words_of(person: Person) -> str:
    """Describe a person in a few words."""
    from cityx.assets.library.measure import color_words

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
