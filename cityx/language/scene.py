"""A scene: what a text asks of a city, nested and typed, for rules and models alike.

A scene holds items: the site, quarters, streets, buildings, things, green, life, air, and what must
stay. Every item has the words of the text it stands for, may be denied, and gives numbers as
bounds. It says the same as the slots of a `Brief`: `slots_of` takes a scene apart into slots, from
which goals and actions follow, and `scene_of` puts the slots that rules read together. Lengths are
metres, areas square metres, shares 0 to 1.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from types import MappingProxyType
from typing import Annotated, Any, Literal

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    GetJsonSchemaHandler,
    model_serializer,
    model_validator,
)
from pydantic_core import CoreSchema
from typing_extensions import TypeAliasType

from cityx.assets.outside_words import outside_pieces, outside_styles
from cityx.checks.predicates.words import BESIDE, SITE_PARTS
from cityx.errors import nearest
from cityx.language.brief import Brief, Selector, Slot, Value
from cityx.language.goals import RISES, WORDS, goals_of
from cityx.language.here import LANDMARKS, SEVERAL
from cityx.language.lexicon.phrases import NOUNS, SLOTS, SPECIES, TABLES, outside_types
from cityx.language.measurable import (
    OF_A_KIND,
    SIDES,
    SIDES_OF_SKY,
    THING_MATERIALS,
    things,
)
from cityx.language.relations import INTO
from cityx.town.building_groups import OF_GROUPS, BuildingGroup, group_of
from cityx.town.elements import BARRIERS, ELEMENTS, HOMES, PLACES, RELATIONS, SIZES
from cityx.town.part_kinds import HOSTS, PART_KINDS, WALLS
from cityx.town.quarter_kinds import DWELLINGS, KINDS

ENDS = ("min", "max")
MOST = 40  # items of one kind; no instruction of a few sentences asks for more
MOST_LISTED = 60  # values of a field that a page lists
LONGEST = 200  # letters of a quote


class Part(BaseModel):
    """A part of a scene: exactly these fields."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    @classmethod
    def __get_pydantic_json_schema__(
        cls, core: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Return the schema in few letters: without titles, defaults and null."""
        schema = handler(core)
        body = handler.resolve_ref_schema(schema)
        for name in ("title", "additionalProperties"):
            body.pop(name, None)
        for name, told in body.get("properties", {}).items():
            body["properties"][name] = _short(told)
        return schema


_LEFT_OUT = ("title", "default", "maxItems", "maxLength", "anyOf")


def _short(told: dict[str, Any]) -> dict[str, Any]:
    ways = [one for one in told.get("anyOf", ()) if one.get("type") != "null"]
    rest = {name: value for name, value in told.items() if name not in _LEFT_OUT}
    if "enum" in rest or "pattern" in rest:
        rest.pop("type", None)
    if isinstance(rest.get("items"), dict):
        rest["items"] = _short(rest["items"])
    if len(ways) == 1:
        return {**rest, **ways[0]}
    return {**rest, "anyOf": ways} if ways else rest


@dataclass(frozen=True)
class Says:
    """What a field of an item says.

    Attributes
    ----------
    key
        Key of the slot; "{}" stands for the subject of the item.
    words
        Name of the list of words that it admits, "" for numbers alone.
    told
        Whether the schema lists the words; another field may do so.
    """

    key: str
    words: str = ""
    told: bool = True

    def __get_pydantic_json_schema__(
        self, core: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Return the schema of the field, with its words instead of any text."""
        schema = handler(core)
        if self.words and self.told:
            untold = {name for name, one in ELEMENTS.items() if not one.told}
            listed = sorted(choices(self) - untold)
            named: dict[str, Any] = {"enum": listed}
            if len(listed) > MOST_LISTED:  # in fewer letters than a list
                named = {"type": "string", "pattern": f"^({'|'.join(listed)})$"}
            if self.words == "time":
                named = {"anyOf": [named, {"type": "string", "pattern": "^[0-2][0-9]:[0-5][0-9]$"}]}
            schema["anyOf"] = [
                named if one.get("type") == "string" else one for one in schema.get("anyOf", ())
            ] or [named]
        return schema


class Number(Part):
    """A number between bounds; a plain one is exact."""

    at_least: float | None = None
    at_most: float | None = None

    @classmethod
    def __get_pydantic_json_schema__(
        cls, core: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Return the schema of a plain number or of bounds."""
        schema = super().__get_pydantic_json_schema__(core, handler)
        body = handler.resolve_ref_schema(schema)
        bounds = dict(body)
        body.clear()
        body["anyOf"] = [{"type": "number"}, bounds]
        return schema

    @model_validator(mode="before")
    @classmethod
    def _exact(cls, told: Any) -> Any:
        plain = isinstance(told, int | float) and not isinstance(told, bool)
        return {"at_least": told, "at_most": told} if plain else told

    @model_serializer
    def _plain(self) -> Any:
        low, high = self.at_least, self.at_most
        if low == high:
            return low
        return {
            name: end for name, end in (("at_least", low), ("at_most", high)) if end is not None
        }

    @model_validator(mode="after")
    def _bounded(self) -> Number:
        low, high = self.at_least, self.at_most
        if low is None and high is None:
            raise ValueError("give at_least, at_most or both, the same for an exact number")
        if low is not None and high is not None and low > high:
            raise ValueError(f"at_least = {low:g} is more than at_most = {high:g}")
        return self

    def ends(self) -> Iterator[tuple[str, float]]:
        """Yield the endings of keys and the values."""
        if self.at_least == self.at_most and self.at_least is not None:
            yield "", self.at_least
        else:
            yield from self.bounds()

    def bounds(self) -> Iterator[tuple[str, float]]:
        """Yield the endings of keys and the values of both bounds, the same of an exact number."""
        for end, value in zip(ENDS, (self.at_least, self.at_most), strict=True):
            if value is not None:
                yield f".{end}", value


# An alias by name stands once in the schema that a model is sent.
Quotes = TypeAliasType(
    "Quotes", Annotated[list[Annotated[str, Field(max_length=LONGEST)]], Field(max_length=MOST)]
)
Words = str | None
Amount = Number | None
WordOrNumber = Number | str | None


class Item(Part):
    """One thing that is asked for.

    Attributes
    ----------
    said
        The words of the text that it stands for, copied.
    denied
        Whether the text says not to have it.
    """

    said: Quotes = []
    denied: bool = False

    @classmethod
    def __get_pydantic_json_schema__(
        cls, core: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Return the schema without what every item has, which its reader is told once."""
        schema = super().__get_pydantic_json_schema__(core, handler)
        for name in ("said", "denied"):
            handler.resolve_ref_schema(schema)["properties"].pop(name, None)
        return schema

    @property
    def subject(self) -> str:
        """What "{}" stands for in the keys of the fields."""
        return ""


class Site(Item):
    """The ground: 600 x 400 m, hills, rivers that meet."""

    width: Annotated[Amount, Says("size.x")] = None
    depth: Annotated[Amount, Says("size.y")] = None
    area: Annotated[Amount, Says("size.area")] = None
    size: Annotated[Words, Says("size", "size")] = None
    density: Annotated[Words, Says("density", "density")] = None
    people: Annotated[Amount, Says("population")] = None
    terrain: Annotated[Words, Says("terrain", "terrain")] = None
    relief: Annotated[Amount, Says("terrain.relief")] = None
    slope: Annotated[Amount, Says("terrain.slope")] = None
    high_side: Annotated[Words, Says("terrain.side", "terrain.side", told=False)] = None
    land_axis: Annotated[Words, Says("terrain.axis", "terrain.axis")] = None
    grade: Annotated[Words, Says("terrain.grade", "terrain.grade")] = None
    terraces: Annotated[Amount, Says("terrain.steps")] = None
    rivers_that_meet: Annotated[Amount, Says("river.meet")] = None
    river_axis: Annotated[Words, Says("river.axis", "river.axis", told=False)] = None
    straight_canal: Annotated[Words, Says("canal.straight", "canal.straight")] = None
    plot_ratio: Annotated[Amount, Says("plot.ratio")] = None  # all floors over the site
    mean_height: Annotated[Amount, Says("height.mean")] = None  # of the buildings
    highest: Annotated[Amount, Says("height.highest")] = None  # building
    mean_floors: Annotated[Amount, Says("floors.mean")] = None
    taller: Annotated[Words, Says("building.gradient", "towards")] = None
    denser: Annotated[Words, Says("density.gradient", "towards", told=False)] = None


class Quarter(Item):
    """A kind of town or quarter, and style."""

    kind: Annotated[Words, Says("district", "district")] = None
    style: Annotated[Words, Says("style", "style")] = None


class Streets(Item):
    """All streets, or those of a rank."""

    rank: Literal["all", "main", "other", "avenue", "ring", "motorway"] = "all"
    pattern: Annotated[Words, Says("roads.pattern", "roads.pattern")] = None
    count: Annotated[Amount, Says("{}.count")] = None
    width: Annotated[WordOrNumber, Says("{}.width", "width")] = None
    lanes: Annotated[Amount, Says("{}.lanes")] = None
    length: Annotated[Amount, Says("{}.length")] = None
    axis: Annotated[Words, Says("roads.main.axis", "axis")] = None
    slope: Annotated[Amount, Says("roads.slope")] = None
    speed: Annotated[Amount, Says("roads.speed")] = None
    surface: Annotated[Words, Says("{}.surface", "surface")] = None
    oneway: Annotated[Words, Says("{}.oneway", "roads.oneway")] = None
    side: Annotated[Words, Says("traffic.side", "traffic.side")] = None  # that one drives on
    walk: Annotated[WordOrNumber, Says("sidewalk.width", "width", told=False)] = None
    turn: Annotated[Amount, Says("roads.turn")] = None  # degrees of a grid, counter-clockwise

    @property
    def subject(self) -> str:
        """The beginning of the keys of this rank."""
        return {"all": "roads", "avenue": "roads.main"}.get(self.rank, f"roads.{self.rank}")


class Blocks(Item):
    """Blocks between streets: number, shorter and longer side."""

    count: Annotated[Amount, Says("block.count")] = None
    columns: Annotated[Amount, Says("block.columns")] = None
    rows: Annotated[Amount, Says("block.rows")] = None
    width: Annotated[Amount, Says("block.width")] = None
    length: Annotated[Amount, Says("block.length")] = None
    filled: Annotated[Words, Says("blocks", "blocks")] = None  # those of a map that are empty
    zone: Annotated[Words, Says("blocks.zone", "blocks.zone")] = None
    floors: Annotated[Amount, Says("blocks.floors")] = None  # of what is built on those


class Buildings(Item):
    """Of a kind, or all; with part, by or added these alone. Some have a count at_least."""

    kind: Annotated[Words, Says("building.type", "building.type")] = None
    count: Annotated[Amount, Says("{}.count")] = None
    share: Annotated[Amount, Says("{}.share")] = None
    height: Annotated[WordOrNumber, Says("{}.height", "building.height")] = None
    floors: Annotated[Amount, Says("{}.floors")] = None
    material: Annotated[Words, Says("building.material", "material")] = None
    color: Annotated[Words, Says("building.color", "color")] = None
    roof: Annotated[Words, Says("building.roof", "building.roof")] = None
    roof_color: Annotated[Words, Says("roof.color", "color", told=False)] = None
    use: Annotated[Words, Says("building.use", "use")] = None
    part: Annotated[Words, Says("{}.part", "site part", told=False)] = None  # where most are of it
    by: Annotated[Words, Says("{}.by", "near", told=False)] = None  # beside what most are of it
    within: float | None = None  # metres of `by`
    added: bool = False  # to a map
    walls: Annotated[Words, Says("{}.walls", "walls")] = None  # that houses share
    each: bool = False  # every one of them, not most

    @property
    def subject(self) -> str:
        """The kind where things of it are measured by themselves."""
        return self.kind or "building"


class Thing(Item):
    """A church, park, river...: how many, where, how large, of what."""

    kind: Annotated[str, Says("element", "element")]
    count: Annotated[Amount, Says("{}.count")] = None
    side: Annotated[Words, Says("{}.side", "side")] = None
    width: Annotated[WordOrNumber, Says("{}.width", "width", told=False)] = None
    height: Annotated[WordOrNumber, Says("{}.height", "rank")] = None
    material: Annotated[Words, Says("{}.material", "stuff", told=False)] = None
    color: Annotated[Words, Says("{}.color", "color", told=False)] = None
    roof: Annotated[Words, Says("{}.roof", "building.roof", told=False)] = None
    roof_color: Annotated[Words, Says("{}.roof_color", "color", told=False)] = None
    length: Annotated[Amount, Says("{}.length")] = None
    area: Annotated[Amount, Says("{}.area")] = None
    share: Annotated[Amount, Says("{}.share")] = None
    spacing: Annotated[Amount, Says("{}.spacing")] = None
    near: Annotated[Words, Says("{}.near", "near or far", told=False)] = None  # a place, a thing
    relation: Annotated[Words, Says("{}.relation", "relation")] = None  # of the thing to `near`
    takes: Annotated[Words, Says("{}.size", "size of a thing")] = None  # ground
    enclosed: Annotated[Words, Says("{}.enclosed", "barrier", told=False)] = (
        None  # by what goes round it
    )
    second: Annotated[Words, Says("{}.second", "near", told=False)] = (
        None  # the other end of "between"
    )
    metres: Annotated[Amount, Says("{}.metres")] = None  # from `near`

    @model_validator(mode="before")
    @classmethod
    def _on_land(cls, told: Any) -> Any:
        """Take what is said to be on a square or in a park for in it, or near it."""
        kind = ELEMENTS.get(told.get("kind", "")) if isinstance(told, dict) else None
        if kind is None or told.get("relation") != "on" or told.get("near") not in INTO:
            return told
        return {**told, "relation": "in" if kind.where == "square" else "near"}

    @property
    def subject(self) -> str:
        """The kind."""
        return self.kind


class HostPart(Item):
    """A part of each building of a kind: two minarets of a mosque."""

    of: Annotated[str, Says("", "host", told=False)]
    part: Annotated[str, Says("", "host part")]
    count: Annotated[Amount, Says("{}.count")] = None
    height: Annotated[Amount, Says("{}.height")] = None
    area: Annotated[Amount, Says("{}.area")] = None  # of a garden
    material: Annotated[Words, Says("{}.material", "material", told=False)] = None
    color: Annotated[Words, Says("{}.color", "color", told=False)] = None

    @property
    def subject(self) -> str:
        """The kind of building and the part."""
        return f"{self.of}.{self.part}"


class Green(Item):
    """Trees, and the share of green ground; a row has its species."""

    trees: Annotated[Words, Says("nature.trees", "nature.trees")] = None
    species: Annotated[Words, Says("nature.species", "species")] = None
    street_species: Annotated[Words, Says("nature.species.streets", "species", told=False)] = None
    park_species: Annotated[Words, Says("nature.species.parks", "species", told=False)] = None
    row_by: Annotated[Words, Says("{}.by", "near", told=False)] = None  # where a row stands
    count: Annotated[Amount, Says("tree.count")] = None
    spacing: Annotated[Amount, Says("nature.spacing")] = None
    height: Annotated[Amount, Says("tree.height")] = None
    share: Annotated[Amount, Says("green.share")] = None

    @property
    def subject(self) -> str:
        """What is denied where it is, and what stands in a row."""
        return self.species if self.row_by is not None and self.species else "tree"


class Life(Item):
    """Vehicles and people: which, how many, how fast."""

    who: Annotated[str, Says("agent", "agent")]
    amount: Annotated[Words, Says("{}", "traffic")] = None
    count: Annotated[Amount, Says("{}.count")] = None
    share: Annotated[Amount, Says("{}.share")] = None  # of the vehicles, or of the people
    speed: Annotated[Amount, Says("{}.speed")] = None
    wears: Annotated[Words, Says("{}.wears", "wears")] = None  # what people have on
    beacons: Annotated[Words, Says("{}.beacons", "beacons")] = None  # blue lights

    @property
    def subject(self) -> str:
        """The kind."""
        return self.who


class Air(Item):
    """Weather, light, hour, season."""

    weather: Annotated[Words, Says("weather", "weather")] = None
    rain: Annotated[Words, Says("rain.intensity", "strength")] = None
    snow: Annotated[Words, Says("snow.intensity", "strength", told=False)] = None
    fog: Annotated[Words, Says("fog.intensity", "strength", told=False)] = None
    wetness: Annotated[Words, Says("wetness", "wetness")] = None
    time: Annotated[Words, Says("time", "time")] = None
    season: Annotated[Words, Says("season", "season")] = None
    lights: Annotated[Words, Says("lights", "lights")] = None
    visibility: Annotated[Amount, Says("visibility")] = None
    cloud: Annotated[Amount, Says("cloud.share")] = None
    lying_snow: Annotated[Words, Says("snow.cover", "snow.cover", told=False)] = None
    wind: Annotated[WordOrNumber, Says("wind", "wind", told=False)] = None
    wind_from: Annotated[Words, Says("wind.from", "compass", told=False)] = None
    sun_in: Annotated[Words, Says("sun.side", "compass", told=False)] = None
    sun: Annotated[Words, Says("sun.height", "sun.height")] = None
    moon: Annotated[Words, Says("moon", "moon")] = None
    lit_windows: Annotated[WordOrNumber, Says("windows.lit", "windows.lit", told=False)] = None
    date: Annotated[Words, Says("date", "date", told=False)] = None  # MM-DD


class Kept(Item):
    """What must stay."""

    what: str


class Then(Item):
    """A command for the finished city, for what no field says."""

    command: Annotated[str, Field(max_length=LONGEST)]


class Scene(Part):
    """All that a text asks for; `unread`: words of no item."""

    site: list[Site] = Field(default=[], max_length=MOST)
    quarters: list[Quarter] = Field(default=[], max_length=MOST)
    streets: list[Streets] = Field(default=[], max_length=MOST)
    blocks: list[Blocks] = Field(default=[], max_length=MOST)
    buildings: list[Buildings] = Field(default=[], max_length=MOST)
    things: list[Thing] = Field(default=[], max_length=MOST)
    parts: list[HostPart] = Field(default=[], max_length=MOST)
    green: list[Green] = Field(default=[], max_length=MOST)
    life: list[Life] = Field(default=[], max_length=MOST)
    air: list[Air] = Field(default=[], max_length=MOST)
    kept: list[Kept] = Field(default=[], max_length=MOST)
    then: list[Then] = Field(default=[], max_length=MOST)
    unread: Quotes = []

    def items(self) -> Iterator[Item]:
        """Yield the items, kind by kind."""
        for name in GROUPS:
            yield from getattr(self, name)

    def told(self) -> dict[str, Any]:
        """Return the scene as plain values without what is not said."""
        told: dict[str, Any] = self.model_dump(exclude_defaults=True)
        return told


class Change(Item):
    """A change of a city that exists: what is done, to what, and what it becomes."""

    verb: str
    target: Selector | None = None
    to: list[tuple[str, Value]] = []


class ChangedScene(Scene):
    """What a text asks of a city that exists."""

    changes: list[Change] = Field(default=[], max_length=MOST)


# Group of a scene -> the type of its items.
GROUPS: Mapping[str, type[Item]] = MappingProxyType(
    {
        "site": Site, "quarters": Quarter, "streets": Streets, "blocks": Blocks,
        "buildings": Buildings, "things": Thing, "parts": HostPart,
        "green": Green, "life": Life, "air": Air,
        "kept": Kept,
    }
)  # fmt: skip
# Keys that the subject of an item does not make.
_OWN_KEYS: Mapping[tuple[str, str], str] = MappingProxyType(
    {
        ("motorway", "axis"): "roads.motorway.axis",
        ("avenue", "count"): "roads.avenues", ("ring", "count"): "roads.rings",
        ("motorway", "count"): "roads.motorways",
        ("vehicle", "amount"): "traffic", ("pedestrian", "amount"): "pedestrians",
    }
)  # fmt: skip
_SELECTS = ("kind", "material", "color", "roof", "use")  # fields that a share may be of


@cache
def words(name: str) -> frozenset[str]:
    """Return the words of a list that fields admit."""
    found = frozenset((*SLOTS.get(name, ()), *TABLES.get(name, ()), *WORDS.get(name, ()))) - {"*"}
    if name == "element":
        named = (*NOUNS["element"], *ELEMENTS, *outside_pieces())
        return frozenset(one for one in named if things(one))
    if name in ("near", "near or far"):
        return frozenset((*PLACES, *ELEMENTS, *(HOMES if name == "near or far" else ())))
    if name == "relation":
        return frozenset((*RELATIONS, "over"))  # a bridge is over a river
    if name == "walls":
        return frozenset(WALLS)
    if name == "host":
        return frozenset(HOSTS)
    if name == "host part":
        return frozenset(PART_KINDS)
    if name == "size of a thing":
        return frozenset(SIZES)
    if name == "barrier":
        return frozenset(BARRIERS)
    if name == "stuff":
        return frozenset(THING_MATERIALS)
    if name == "rank":
        return frozenset(("tallest",))
    if name == "species":
        return frozenset(SPECIES)
    if name == "agent":
        return frozenset((*NOUNS["vehicle"], *NOUNS["person"]))
    if name == "building.type":
        return frozenset((*NOUNS["type"], *outside_types()))
    if name == "style":
        return found | outside_styles()
    if name == "compass":
        return frozenset(SIDES_OF_SKY)
    if name == "towards":
        return frozenset(("center", "edge", *SIDES))
    if name == "site part":
        return frozenset(SITE_PARTS)
    if name == "side":
        return frozenset((*SIDES, "middle", "edge", *RISES))
    return found


# Lists of words that are measured together with others, or of some things alone.
_TOGETHER = ("near", "near or far", "relation", "stuff", "barrier", "host", "host part")


@cache
def choices(says: Says) -> frozenset[str]:
    """Return the words of a field that something measures."""
    if says.words in _TOGETHER:
        return words(says.words)
    own = {
        "traffic": "traffic", "building.height": "building", "surface": "roads",
        "roads.oneway": "roads", "towards": "house", "site part": "house", "walls": "house",
        "side": "church", "rank": "church",
        "size of a thing": "school", **dict.fromkeys(OF_A_KIND.values(), "church"),
        **dict.fromkeys(("material", "color"), "church"),
    }  # fmt: skip
    example = says.key.format(own.get(says.words, "park"))
    found = frozenset(word for word in words(says.words) if goals_of([Slot(example, word)])[0])
    return found - frozenset(LANDMARKS) if says.words == "building.type" else found  # things


def fields_of(kind: type[Item]) -> Iterator[tuple[str, Says]]:
    """Yield the fields of a type of item that say something, with what they say."""
    for name, info in kind.model_fields.items():
        says = next((one for one in info.metadata if isinstance(one, Says)), None)
        if says is not None:
            yield name, says


def key_of(item: Item, name: str, says: Says) -> str:
    """Return the key of a field."""
    about = next((getattr(item, one) for one in ("rank", "who") if hasattr(item, one)), "")
    if (own := _OWN_KEYS.get((about, name))) is not None:
        return own
    if name == "share" and isinstance(item, Buildings):
        return f"{getattr(item, _shared(item) or 'kind') or 'building'}.share"
    return says.key.format(item.subject)


def pairs_of(item: Item, *, alone: bool = True) -> list[tuple[str, Value]]:
    """Return what an item says as keys and values; of a denied one, what is denied.

    Parameters
    ----------
    item
        The item.
    alone
        Whether buildings of its kind are the only ones of a kind that the scene names; then their
        number is that of the buildings.
    """
    if item.denied and isinstance(item, HostPart):
        return [(f"{item.subject}.count", 0)]
    if item.denied:
        return [("not", value) for value in _denied(item)]
    if isinstance(item, Kept):
        return [("keep", item.what)]
    found: list[tuple[str, Value]] = []
    group = place_of(item)
    if group is not None and isinstance(item, Buildings):
        return _pairs_of_group(item, group)
    some = _are_some(item) or _stand_among_others(item)
    alone = alone and not _are_some(item)
    for name, says in fields_of(type(item)):
        value = getattr(item, name)
        if value is None or name in (_shared(item), _in_row(item)):
            continue
        key = key_of(item, name, says)
        # "glass on all offices"
        apart = isinstance(item, Buildings) and (item.each or some or not alone)
        if apart and item.subject != "building" and name in OF_A_KIND:
            key = f"{item.subject}.{name}"
        if isinstance(item, Buildings) and alone and item.kind not in ELEMENTS and not some:
            key = "building.count" if name == "count" else key
        elif name == "kind" and getattr(item, "count", None) is not None:
            continue  # what is counted among others
        if name == "kind" and isinstance(item, Buildings) and (item.part or item.by):
            continue  # what some are, in one place
        if isinstance(value, Number):
            each = isinstance(item, Buildings) and item.each and name in ("height", "floors")
            ends = value.bounds() if each else value.ends()
            found += [(f"{key}{end}", _whole(number)) for end, number in ends]
        elif name not in ("kind", "who", "of", "part") or isinstance(item, (Quarter, Buildings)):
            found.append((key, value))
    return _with_presence(item, found)


def place_of(item: Item) -> BuildingGroup | None:
    """Return the group that buildings of an item are, None where they stand in no one place."""
    if not isinstance(item, Buildings) or not (item.part or item.by or item.added):
        return None
    group = BuildingGroup(
        item.kind or "building",
        item.part or "",
        item.by or "",
        round(BESIDE if item.within is None else item.within),
        item.added,
    )
    return group if group.is_known else None


def _pairs_of_group(item: Buildings, group: BuildingGroup) -> list[tuple[str, Value]]:
    """Return what an item says of the buildings of a group; its kind alone is what most there are.

    What cannot be said of some alone, such as a share, has a key that nothing measures.
    """
    found: list[tuple[str, Value]] = []
    of_all = item.count is None and not item.added and item.within is None and item.kind is not None
    for name, says in fields_of(type(item)):
        value = getattr(item, name)
        if value is None or name == "kind":
            continue
        if name in ("part", "by"):
            found += [(key_of(item, name, says), value)] if of_all else []
        elif name == "walls":
            found.append((key_of(item, name, says), value))
        elif isinstance(value, Number):
            ends = value.bounds() if item.each and name in ("height", "floors") else value.ends()
            found += [(f"{group.text}.{name}{end}", _whole(number)) for end, number in ends]
        else:
            found.append((f"{group.text}.{name}", value))
    return found or [(f"{group.text}.count.min", 1)]


def _stand_among_others(item: Item) -> bool:
    """Return whether buildings are counted that are not what a town is of: six offices."""
    if not isinstance(item, Buildings) or item.count is None:
        return False
    return item.kind in KINDS and item.kind not in DWELLINGS


def _are_some(item: Item) -> bool:
    """Return whether buildings are some among others, of whatever number."""
    count = getattr(item, "count", None)
    if not isinstance(item, Buildings) or not isinstance(count, Number):
        return False
    return count.at_most is None and count.at_least is not None and count.at_least <= SEVERAL


def _shared(item: Item) -> str:
    """Return the field that says what the share of an item is of, "" where it has none."""
    if not isinstance(item, Buildings) or item.share is None:
        return ""
    return next((name for name in _SELECTS if getattr(item, name) is not None), "")


def _in_row(item: Item) -> str:
    """Return the field that says of what a row of trees is, "" where there is none."""
    return "species" if isinstance(item, Green) and item.row_by is not None else ""


def _with_presence(item: Item, found: list[tuple[str, Value]]) -> list[tuple[str, Value]]:
    """Add that there is such a thing at all, where no count says so."""
    counted = any(key.startswith(f"{item.subject}.count") for key, _ in found)
    if isinstance(item, HostPart) and not counted:
        return [(f"{item.subject}.count.min", 1), *found]
    if isinstance(item, Thing) and not counted:
        return [("element", item.kind), *found]
    if isinstance(item, Life) and all(key.endswith((".wears", ".beacons")) for key, _ in found):
        busy = _OWN_KEYS.get((item.who, "amount"))
        return [("agent", item.who) if busy is None else (busy, "medium"), *found]
    if isinstance(item, Streets) and not found and item.rank != "all":
        return [(_OWN_KEYS.get((item.rank, "count"), f"{item.subject}.count") + ".min", 1)]
    return found


def _denied(item: Item) -> list[str]:
    """Return the words that a denied item denies."""
    told = [str(value) for name, _ in fields_of(type(item))
            if isinstance(value := getattr(item, name), str)]  # fmt: skip
    if isinstance(item, Kept):
        return []
    if isinstance(item, Green) and item.row_by is not None:
        return [item.subject, item.row_by]  # no one thing
    if isinstance(item, Green) and item.trees is not None:
        return ["tree"]  # "no trees", however many are said
    if isinstance(item, Streets) and not told:
        return ["road" if item.rank == "all" else item.rank]
    return told or ([item.subject] if item.subject else [])


def _whole(value: float) -> Value:
    return int(value) if value == int(value) else round(value, 4)


def kinds_of(scene: Scene) -> frozenset[str]:
    """Return the kinds of buildings that a scene names, and that are not counted as elements."""
    named = (one.kind for one in scene.buildings if not one.denied)
    return frozenset(kind for kind in named if kind is not None and kind not in ELEMENTS)


# -- from slots ----------------------------------------------------------------------------------


@dataclass
class Reading:
    """An item in the making, and the slots that it comes from.

    Attributes
    ----------
    group
        Group of the scene, "" where no field says it.
    told
        Fields of the item.
    slots, denied, kept
        What the rules read.
    """

    group: str
    told: dict[str, Any]
    slots: list[Slot] = field(default_factory=list)
    denied: list[Slot] = field(default_factory=list)
    kept: list[Slot] = field(default_factory=list)

    @property
    def item(self) -> Item:
        """The item."""
        return GROUPS[self.group](**self.told)

    def says(self, item: Item) -> bool:
        """Return whether another item says the same, in whichever words."""
        if type(item) is not GROUPS.get(self.group):
            return False
        apart = place_of(item) is not None or _stand_among_others(item)  # and not of all
        if apart and {slot.key for slot in self.slots} != {key for key, _ in pairs_of(item)}:
            return False
        return {**item.model_dump(), "said": []} == {**self.item.model_dump(), "said": []}


def readings_of(brief: Brief) -> list[Reading]:
    """Return what rules read as items with their slots; what no field says is in no group."""
    found: list[Reading] = []
    for slot in brief.slots:
        place = _place(slot.key)
        if place is None:
            found.append(Reading("", {}, slots=[slot]))
        else:
            _put(found, place, slot)
    for slot in brief.negated:
        group, told = _place_of_denied(str(slot.value))
        if told is not None:
            told = {**told, "said": _said(slot), "denied": True}
        found.append(Reading(group if told else "", told or {}, denied=[slot]))
    for slot in brief.kept:
        kept = {"what": str(slot.value), "said": _said(slot)}
        found.append(Reading("kept", kept, kept=[slot]))
    return found


def _said(slot: Slot) -> list[str]:
    return [slot.text[:LONGEST]] if slot.text else []


def scene_of(brief: Brief) -> Scene:
    """Return what rules read as a scene; what has no field is not in it."""
    readings = readings_of(brief)
    groups: dict[str, list[Item]] = {
        name: [one.item for one in readings if one.group == name] for name in GROUPS
    }
    groups["then"] = [
        Then(command=one.text, said=[brief.text[slice(*one.span)][:LONGEST]])
        for one in brief.then[:MOST]
    ]
    unread = list(brief.words_unread)[:MOST]
    if not brief.edits:
        return Scene(**groups, unread=unread)  # type: ignore[arg-type]
    changes = [
        Change(
            verb=edit.verb, target=edit.target, to=list(edit.change),
            said=[brief.text[slice(*edit.span)][:LONGEST]] if edit.span[1] else [],
        )
        for edit in brief.edits[:MOST]
    ]  # fmt: skip
    return ChangedScene(**groups, unread=unread, changes=changes)  # type: ignore[arg-type]


@dataclass(frozen=True)
class _Place:
    """Where a slot stands in a scene."""

    group: str
    name: str  # of the field
    end: str
    subject: tuple[tuple[str, Value], ...] = ()


def _place(key: str) -> _Place | None:
    """Return the place of a key, None where no field says it."""
    end = next((one for one in ENDS if key.endswith(f".{one}")), "")
    base = key.removesuffix(f".{end}") if end else key
    if key in ("element", "agent"):
        return _Place(*(("things", "kind") if key == "element" else ("life", "who")), "")
    if (some := group_of(key)) is not None:
        name = base.rpartition(".")[2]
        return _Place("buildings", name, end, _fields_of_group(some)) if _is_told(name) else None
    fixed = _fixed_places().get(base)
    if fixed is not None:
        return _Place(fixed.group, fixed.name, end, fixed.subject)
    kind, _, name = base.rpartition(".")
    if name == "by" and kind in ("tree", *words("species")):
        return _Place("green", "row_by", end, () if kind == "tree" else (("species", kind),))
    if name == "share" and kind in words("material"):
        return _Place("buildings", "share", end, (("material", kind),))
    host, _, part = kind.partition(".")
    if host in HOSTS and part in PART_KINDS and name in HostPart.model_fields:
        return _Place("parts", name, end, (("of", host), ("part", part)))
    for group, subject, listed in (
        ("things", "kind", "element"), ("life", "who", "agent"),
        ("buildings", "kind", "building.type"),
    ):  # fmt: skip
        if kind in words(listed) and name in GROUPS[group].model_fields:
            return _Place(group, name, end, ((subject, kind),))
    return None


def _is_told(name: str) -> bool:
    return name in OF_GROUPS and name in Buildings.model_fields


def _fields_of_group(group: BuildingGroup) -> tuple[tuple[str, Any], ...]:
    """Return the fields of an item by which it is of a group."""
    told: dict[str, Any] = {
        "kind": "" if group.kind == "building" else group.kind,
        "part": group.part, "by": group.near, "added": group.added,
    }  # fmt: skip
    if group.near and group.within != BESIDE:
        told["within"] = float(group.within)
    return tuple((name, value) for name, value in told.items() if value)


@cache
def _fixed_places() -> Mapping[str, _Place]:
    """Return the places of the keys that are no families."""
    found: dict[str, _Place] = {}
    bare: list[tuple[str, Item]] = [
        ("buildings", Buildings()),
        ("site", Site()),
        ("blocks", Blocks()),
        ("quarters", Quarter()),
        ("green", Green()),
        ("air", Air()),
    ]
    ranked = [("streets", Streets(rank=one)) for one in
              ("all", "main", "other", "ring", "motorway", "avenue")]  # fmt: skip
    busy = [("life", Life(who=one)) for one in ("vehicle", "pedestrian")]
    for group, item in (*bare, *ranked, *busy):
        subject = tuple((name, getattr(item, name)) for name in ("rank", "who")
                        if hasattr(item, name))  # fmt: skip
        for name, says in fields_of(type(item)):
            if name != "share" or group == "green":
                found.setdefault(key_of(item, name, says), _Place(group, name, "", subject))
    return found


def _put(readings: list[Reading], place: _Place, slot: Slot) -> None:
    """Put a slot into the item of its subject, or into one of its own."""
    about = dict(place.subject)
    name, value = place.name, slot.value
    if slot.key == "building.type" and _is_of_kind(readings, str(value), slot):
        about, name = {"kind": value}, ""
    if slot.key in ("element", "agent"):
        about, name = {"kind" if slot.key == "element" else "who": value}, ""
    one = next((one for one in readings if _takes(one, place, about, name, slot)), None)
    if one is None:
        one = Reading(place.group, {**about, "said": [], **_each(place, slot)})
        readings.append(one)
    if name and isinstance(value, str):
        one.told[name] = value
    elif name:
        ends = [_end(place)] if place.end else ["at_least", "at_most"]
        one.told[name] = {**one.told.get(name, {}), **dict.fromkeys(ends, float(value))}
    one.told["said"] = list(dict.fromkeys((*one.told["said"], *_said(slot))))[:MOST]
    one.slots.append(slot)


def _each(place: _Place, slot: Slot) -> dict[str, bool]:
    """Return that an item is of each of its things, where it can say so."""
    told = slot.every and "each" in GROUPS[place.group].model_fields
    return {"each": True} if told else {}


def _is_of_kind(readings: Iterable[Reading], kind: str, slot: Slot) -> bool:
    """Return whether an item of a kind of building is there already."""
    place = _Place("buildings", "", "")
    return any(_takes(one, place, {"kind": kind}, "", slot) for one in readings)


def _takes(one: Reading, place: _Place, about: Mapping[str, Value], name: str, slot: Slot) -> bool:
    """Return whether an item is of the subject of a slot and has nothing yet where it goes."""
    if one.group != place.group or one.denied:
        return False
    if bool(one.told.get("each")) != bool(_each(place, slot)):
        return False
    if any(one.told.get(name_) != value for name_, value in about.items()):
        return False
    if name == "row_by" or "row_by" in one.told:
        return False  # a row is an item of its own
    if one.group == "buildings" and _place_told(one) != _place_told(slot):
        return False
    held = one.told.get(name) if name else None
    if isinstance(held, dict) and place.end and _end(place) not in held:
        low, high = sorted(
            (*held.values(), slot.value), key=float
        )  # a contradiction makes two items
        return {_end(place): slot.value, **held} == {"at_least": low, "at_most": high}
    return held is None


def _place_told(of: Reading | Slot) -> str:
    """Return the group that a slot, or what was read of an item, is of, "" where of none."""
    slots = of.slots if isinstance(of, Reading) else [of]
    groups = (group_of(slot.key) for slot in slots)
    return next((group.text for group in groups if group is not None), "")


def _end(place: _Place) -> str:
    return "at_least" if place.end == "min" else "at_most"


def _place_of_denied(value: str) -> tuple[str, dict[str, Any] | None]:
    """Return the group and the fields of something denied; no fields where none says it."""
    if value in words("element"):
        return "things", {"kind": value}
    if value in ("vehicle", "pedestrian") or value in words("agent"):
        return "life", {"who": value}
    if value == "tree":
        return "green", {}
    ranks = {"road": "all", "motorway": "motorway", "ring_road": "ring", "avenue": "avenue"}
    if value in ranks:
        return "streets", {"rank": ranks[value]}
    for group, kind in GROUPS.items():
        for name, says in fields_of(kind):
            if says.words and name not in ("amount",) and value in words(says.words):
                return group, {name: value}
    return "buildings", {} if value == "building" else None


# -- what is wrong -------------------------------------------------------------------------------


def faults_of(items: Iterable[Item]) -> list[str]:
    """Return which words of items are none of those that their fields admit, in sentences."""
    faults = []
    for item in items:
        group = next(name for name, kind in GROUPS.items() if type(item) is kind)
        for name, says in fields_of(type(item)):
            value = getattr(item, name)
            if isinstance(value, str) and not _admitted(says, value):
                known = choices(says)
                listed = f" It is one of {', '.join(sorted(known))}." if len(known) < 30 else ""
                near = nearest(value, known)
                faults.append(f'{group}: {name} = "{value}" is not known.{near or listed}')
        if (
            isinstance(item, Thing)
            and item.relation == "between"
            and not (item.near and item.second)
        ):
            faults.append(f'{group}: "between" needs two places, in near and in second.')
            continue
        if (fault := _fault_of_place(item)) and not item.denied:
            faults.append(f"{group}: {fault}")
            continue
        told = pairs_of(item)
        if not told:
            faults.append(f"{group}: an item says nothing; leave it out.")
        elif item.denied and len(told) > 1:
            both = " and ".join(str(value) for _, value in told)
            faults.append(f"{group}: a denied item says one thing alone, not {both}.")
    return faults


def _fault_of_place(item: Item) -> str:
    """Return what is wrong with where some buildings stand, "" where nothing is."""
    if not isinstance(item, Buildings) or (item.within is None and not item.added):
        return ""
    if item.within is not None and not item.by:
        return '"within" needs a place, in by.'
    known = ", ".join(sorted(KINDS))
    told = "" if place_of(item) is not None else item.kind or "buildings"
    return told and f'nothing measures "within" or "added" of {told}; of {known} it does.'


def _admitted(says: Says, value: str) -> bool:
    clock = says.words == "time" and _is_clock(value)
    clock |= says.words == "date" and _is_date(value)
    return bool(says.words) and (clock or value in choices(says))


def _is_date(value: str) -> bool:
    month, _, day = value.partition("-")
    digits = month.isdigit() and day.isdigit() and len(month) == len(day) == 2
    return digits and 1 <= int(month) <= 12 and 1 <= int(day) <= 31


def _is_clock(value: str) -> bool:
    hours, _, minutes = value.partition(":")
    digits = hours.isdigit() and minutes.isdigit() and len(minutes) == 2
    return digits and int(hours) < 24 and int(minutes) < 60


def table_of_scene() -> str:
    """Return what the items of a scene may say as a table of Markdown, things apart."""
    rows = ["| item | fields |", "| --- | --- |"]
    for group, kind in GROUPS.items():
        told = []
        for name, says in fields_of(kind):
            listed = sorted(choices(says)) if says.words and says.words != "element" else []
            if len(listed) > MOST_LISTED:
                listed = ["one of the elements or places"]
            listed = listed or ["MM-DD"] * (says.words == "date")
            number = ["a number"] if "Number" in str(kind.model_fields[name].annotation) else []
            told.append(f"`{name}`: {', '.join([*number, *listed]) or 'one of the elements'}")
        if told:
            rows.append(f"| {group} | {'; '.join(told)} |")
    return "\n".join(rows)
