"""Options: what decides a build, who plans it and how pictures are taken, each declared once.

A field made by `option` carries its help text, its flag, its bounds and how it is written as text.
The command line makes its flags of these fields (`cityx.cli.flags`), the Python API its keyword
arguments (`cityx.build`). This module imports nothing heavy: every start of a command needs it.
"""
# Annotations stay values here, so that nobody has to evaluate them again.

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, fields, is_dataclass
from math import inf, isfinite
from typing import Any, Protocol, TypeVar, get_type_hints

from cityx.errors import UsageError, nearest

FORMATS = ("blend", "glb", "packed", "usd", "bodies", "sumo", "mjcf")  # packages add theirs
DEFAULT_FORMATS = ("blend", "glb")  # what needs no extra
LARGEST_SEED = 2**63 - 1
_OPTION = "option"  # key of a field's metadata

T = TypeVar("T")


class Spelling(Protocol):
    """How values of an option are written as text, such as "800x600"."""

    def read(self, text: str, name: str) -> Any:
        """Return the value that a text stands for; `name` is what messages call the option."""

    def write(self, value: Any) -> str:
        """Return a value as text."""


@dataclass(frozen=True)
class Numbers:
    """Numbers with something between them: "AxB", "A,B" or "A,B,C,D".

    Attributes
    ----------
    separator, example
        What stands between them, and a text of the right form.
    low, high
        Bounds of each.
    whole
        Whether they are whole numbers.
    name
        What messages call them; the name of the option when "".
    """

    separator: str
    example: str
    low: float = -inf
    high: float = inf
    whole: bool = False
    name: str = ""

    def read(self, text: str, name: str) -> Any:  # a tuple as long as the example
        """Return as many numbers as the example has."""
        name = self.name or name
        try:
            words = [float(word) for word in text.lower().split(self.separator)]
            numbers = tuple(int(one) if self.whole and one.is_integer() else one for one in words)
            return self.checked(numbers)
        except (ValueError, OverflowError):
            raise UsageError(f'{name} "{text}" is not of the form {self.example}.') from None
        except UsageError as error:
            raise UsageError(f'{name} "{text}" {error}') from None

    def checked(self, value: Any) -> Any:
        """Return numbers that are admitted.

        Raises
        ------
        ValueError
            If they are no numbers, or too many or few.
        UsageError
            If they are out of bounds, which the message says.
        """
        numbers = tuple(value)
        if len(numbers) != len(self.example.split(self.separator)):
            raise ValueError(value)
        if not all(map(isfinite, numbers)) or (self.whole and any(n != int(n) for n in numbers)):
            raise ValueError(value)
        if not all(self.low <= number <= self.high for number in numbers):
            low, high = (self.separator.join([f"{end}"] * len(numbers))
                         for end in (self.low, self.high))  # fmt: skip
            raise UsageError(f"is outside {low} to {high}.")
        return numbers

    def write(self, value: Any) -> str:
        """Return the numbers as text."""
        return self.separator.join(f"{number:g}" for number in value)


@dataclass(frozen=True)
class Words:
    """Words with commas between them, without spaces around them; empty ones are left out.

    Attributes
    ----------
    nothing
        A word that stands for none, and is left out.
    """

    nothing: str = ""

    def read(self, text: str, name: str = "") -> tuple[str, ...]:
        """Return the words."""
        del name
        return tuple(word for word in words_of(text) if word != self.nothing)

    def write(self, value: Any) -> str:
        """Return the words as text."""
        return ",".join(value)


def words_of(text: str) -> tuple[str, ...]:
    """Return the words of "osm, height": without spaces around them, empty ones left out."""
    return tuple(word for part in text.split(",") if (word := part.strip()))


class _Moment:
    """Seconds, or a word."""

    def read(self, text: str, name: str) -> float | str:
        del name
        try:
            return float(text)
        except ValueError:
            return text  # refused where it means nothing

    def write(self, value: Any) -> str:
        return f"{value}"


class _Processes:
    """A number of processes, or "auto" for one for each core."""

    def read(self, text: str, name: str) -> int | None:
        if text == AUTO:
            return None
        if not text.isdecimal() or not 1 <= int(text) <= MOST_PROCESSES:
            raise UsageError(f'{name} "{text}" takes {AUTO}, or 1 to {MOST_PROCESSES}.')
        return int(text)

    def write(self, value: Any) -> str:
        return AUTO if value is None else f"{value}"


AUTO, MOST_PROCESSES = "auto", 64
SIZE = Numbers("x", "800x600")
PIXELS = Numbers("x", "960x540", 16, 16384, whole=True, name="Picture size")
LAT_LON = Numbers(",", "60.17,24.94")


@dataclass(frozen=True)
class Option:
    """What an option is to its users.

    Attributes
    ----------
    help
        What it means, in a few words.
    flag
        How the command line spells it, "" for its name with "--".
    low, high
        Bounds of a number.
    spelling
        How a value is written as text, None where the text is the value.
    """

    help: str
    flag: str = ""
    low: float | None = None
    high: float | None = None
    spelling: Spelling | None = None

    def value_of(self, value: Any, kind: Any, name: str) -> Any:
        """Return a value as the option holds it: a text is read, a list becomes a tuple.

        Parameters
        ----------
        value
            Of Python or of the command line.
        kind
            Type of the field.
        name
            What messages call the option.

        Raises
        ------
        UsageError
            If it is none of the option.
        """
        if value is None:
            return None
        if self.spelling is not None and isinstance(value, str):
            return self.spelling.read(value, name)
        if isinstance(self.spelling, Numbers):
            try:
                return self.spelling.checked(value)
            except (TypeError, ValueError):
                few = self.spelling.read(self.spelling.example, name)
                raise UsageError(f"{name} is {value!r}; write numbers such as {few}.") from None
            except UsageError as error:
                raise UsageError(f"{name} {value!r} {error}") from None
        if kind == tuple[str, ...]:
            return (value,) if isinstance(value, str) else tuple(map(str, value))
        plain = _plain_type(kind)
        if plain is not None:
            if not isinstance(value, _ADMITTED[plain]) or (plain is not bool and value is True):
                raise UsageError(f"{name} is {value!r}; it takes {_SAID[plain]}.")
            self._bounded(value, name)
        return value

    def _bounded(self, value: Any, name: str) -> None:
        low, high = self.low, self.high
        if (low is not None and value < low) or (high is not None and value > high):
            ends = f"{low} or more" if high is None else f"{low} to {high}"
            raise UsageError(f"{name} is {value!r}; it takes {ends}.")


_ADMITTED: Mapping[type, tuple[type, ...]] = {
    bool: (bool,), int: (int,), float: (int, float), str: (str,),
}  # fmt: skip
_SAID = {bool: "True or False", int: "a whole number", float: "a number", str: "a text"}


def _plain_type(kind: Any) -> type | None:
    """Return int of ``int`` and of ``int | None``; None of what is no plain type."""
    kinds = [one for one in getattr(kind, "__args__", (kind,)) if one is not type(None)]
    return kinds[0] if len(kinds) == 1 and kinds[0] in _ADMITTED else None


def option(
    default: Any,
    help: str,  # noqa: A002  as everywhere on the command line
    flag: str = "",
    *,
    low: float | None = None,
    high: float | None = None,
    spelling: Spelling | None = None,
) -> Any:
    """Declare a field of a dataclass as an option; see `Option`."""
    declared = Option(help, flag, low, high, spelling)
    return field(default=default, metadata={_OPTION: declared})


def place_profile_option() -> Any:
    """Declare the profile of a place, of whatever builds cities."""
    return option("", "How the place builds and drives: de, jp, ..., or a TOML file.")


@dataclass(frozen=True)
class Declared:
    """An option with what its dataclass says of it: its name, its type and its default."""

    name: str
    kind: Any
    default: Any
    option: Option

    @property
    def flag(self) -> str:
        """The flag of the command line."""
        return self.option.flag or "--" + self.name.replace("_", "-")


def declared(kind: type) -> Iterator[Declared]:
    """Yield the options of a dataclass in order, those of dataclasses that it holds among them."""
    types = get_type_hints(kind)
    for item in fields(kind):
        if is_dataclass(types[item.name]):
            yield from declared(types[item.name])
        elif _OPTION in item.metadata:
            yield Declared(item.name, types[item.name], item.default, item.metadata[_OPTION])


def with_values(kind: type[T], values: Mapping[str, Any]) -> T:
    """Make a dataclass, and those that it holds, from the values of their options by name."""
    found: dict[str, Any] = {}
    types = get_type_hints(kind)
    for item in fields(kind):  # type: ignore[arg-type]
        if is_dataclass(types[item.name]):
            found[item.name] = with_values(types[item.name], values)
        elif _OPTION in item.metadata and item.name in values:
            found[item.name] = values[item.name]
    return kind(**found)


def options_from(
    kind: type[T],
    given: Mapping[str, Any],
    defaults: Mapping[str, Any] | None = None,
    *,
    flags: bool = False,
) -> T:
    """Make options from the keyword arguments of a caller, or the words of a command line.

    Parameters
    ----------
    kind
        Their dataclass.
    given
        Values by name, or texts as on the command line.
    defaults
        Values instead of those of the dataclass.
    flags
        Whether messages call an option by its flag.

    Raises
    ------
    UsageError
        With every name that is none, and every value that is not admitted.
    """
    known = {item.name: item for item in declared(kind)}
    faults, values = [], dict(defaults or {})
    for name, value in given.items():
        if name not in known:
            hint = nearest(name, known) or f" There are {', '.join(known)}."
            faults.append(f'There is no option "{name}".{hint}')
            continue
        item = known[name]
        try:
            values[name] = item.option.value_of(value, item.kind, item.flag if flags else name)
        except UsageError as error:
            faults.append(str(error))
    if faults:
        raise UsageError("\n".join(faults))
    return with_values(kind, values)


@dataclass(frozen=True)
class HowToRead:
    """What a user says of inputs that do not say it themselves.

    Attributes
    ----------
    seed
        Key of every draw for what an input does not say.
    at
        Latitude and longitude of what does not say where it lies.
    place
        Profile of the place that the user asked for, as of `cityx.city.frame.Frame`.
    kinds
        "NAME=KIND", what a file is, where its content says something else.
    legend, confirm_legend
        Preset or file of a semantic map's classes; whether to take those that are proposed.
    pixel
        Metres of a pixel.
    fidelity
        "exact" or "plausible", of images.
    segmenter
        ONNX file that tells the classes of a photograph, "none" for colour and texture alone, ""
        for the network that comes with CityX.
    height_range
        Metres of the lowest and the highest number of heights that are no metres.
    height_crs
        Coordinate system of heights that do not name theirs.
    """

    seed: int = 0
    at: tuple[float, float] | None = None
    place: str = ""
    kinds: tuple[str, ...] = option((), "NAME=KIND: osm, semantic, satellite, ...", "--as")
    legend: str = option("", "Classes of a semantic map: preset or file.")
    confirm_legend: bool = option(False, "Take the classes proposed.")
    pixel: float | None = option(None, "Metres of an image's pixel.")
    fidelity: str = option("exact", "Of images: exact, plausible.")
    segmenter: str = option("", 'Of aerial images: ONNX file, or "none" for colours alone.')
    height_range: tuple[float, float] | None = option(
        None, "LOW,HIGH: metres of heights in other numbers.", spelling=Numbers(",", "0,120")
    )
    height_crs: str = option("", "Coordinate system of heights: EPSG:3067.")


@dataclass(frozen=True)
class PlannerChoice:
    """Who plays the roles of the agents.

    Attributes
    ----------
    planner
        "offline", or a language model; see `cityx.agents.models.spec.read_spec`.
    base_url
        Address of another server than the model's own, or "".
    record, replay
        File that the model's decisions are added to, or played from; "" for none.
    budget_tokens
        Tokens that models may be given and answer.
    look
        Whether a model looks at pictures of what was built or changed, if it can see.
    export
        File of prompts for a model that is asked by hand, "" for none.
    shown
        What of the actions' records is planned by; see `cityx.agents.ablation`.
    """

    planner: str = option("offline", "offline, or openai:MODEL, anthropic:MODEL, ollama:MODEL, ...")
    base_url: str = option("", "Server of the model, for openai-chat:MODEL.")
    record: str = option("", "File to add the model's decisions to.")
    replay: str = option("", "File of decisions to play, asking nobody.")
    budget_tokens: int = option(400_000, "Tokens that models may use.", low=0)
    look: bool = option(True, "Let the model look at pictures.", "--look/--no-look")
    export: str = ""
    shown: str = "DIL"


@dataclass(frozen=True)
class BuildOptions:
    """Everything that decides a build besides its inputs.

    Attributes
    ----------
    seed, workers
        Key of all draws; processes that work at a time, None for as many as there are cores. The
        number changes no byte of what is built.
    lod
        Level of detail, 0 to 3.
    style, time, weather
        Words for the buildings, the hour and the air; "" or None for those of the place.
    size
        (width, depth) of a window to cut out of the map, metres, or None for all of it. Without
        a map, the size of the town.
    at
        (latitude, longitude) of the window's centre, degrees; the site's centre when None. Where
        no input says where it lies, the place of their origin.
    window
        (x, y, width, depth), metres: the part of the plane of towns to build when no input gives a
        layout; x and y are its south-west corner.
    formats
        What to write beside the store, of `FORMATS`.
    render
        Whether to make the three pictures.
    samples
        Cycles samples per pixel.
    picture
        (width, height) of the pictures, pixels.
    text
        The instruction, in words, or "".
    read
        What the user says of inputs that do not say it themselves; seed and place are those above.
    place
        Name or rectangle of a place whose map is fetched, or "".
    place_profile
        Profile of a place such as "de", or a TOML file of one (docs/places.md); "" for that of the
        country in which the city lies.
    choice
        Who plans.
    settings, wishes
        Arguments of actions and actions of the user's own; see `cityx.agents.requests`.
    """

    seed: int = option(0, "Key of all draws.", low=0, high=LARGEST_SEED)
    workers: int | None = option(
        None, "Processes that work at a time; auto: one for each core.", low=1,
        high=MOST_PROCESSES, spelling=_Processes(),
    )  # fmt: skip
    lod: int = option(2, "Level of detail.", low=0, high=3)
    style: str = option("", "Style of buildings, e.g. european, brick.")
    time: str | None = option(None, "HH:MM, dusk, 2026-12-21 16:00, ...; midsummer without a date.")
    weather: str | None = option(None, "clear, fog, rain, storm dusk, ...")
    size: tuple[float, float] | None = option(
        None, "WxH of a window to cut out, metres.", spelling=SIZE
    )
    at: tuple[float, float] | None = option(
        None, "LAT,LON of the window's centre.", spelling=LAT_LON
    )
    window: tuple[float, float, float, float] | None = option(
        None, "X,Y,W,H of the plane of towns, metres, without a map.",
        spelling=Numbers(",", "-300,-300,600,600"),
    )  # fmt: skip
    formats: tuple[str, ...] = option(
        DEFAULT_FORMATS, f"Comma-separated: {', '.join(FORMATS)}, or of a plugin.", spelling=Words()
    )
    render: bool = option(True, "Make pictures.", "--render/--no-render")
    samples: int = option(48, "Samples per pixel.", low=1, high=65536)
    picture: tuple[int, int] = option((960, 540), "Size of the pictures, pixels.", spelling=PIXELS)
    text: str = ""
    read: HowToRead = field(default_factory=HowToRead)
    place: str = option("", "Place whose map is fetched: a name, or WEST,SOUTH,EAST,NORTH.")
    place_profile: str = place_profile_option()
    choice: PlannerChoice = field(default_factory=PlannerChoice)
    settings: tuple[str, ...] = option(
        (), "[ACTION.]NAME=VALUE of an action of the build; may repeat.", "--set"
    )
    wishes: tuple[str, ...] = option(
        (), '"ACTION NAME=VALUE ...", an action to add; may repeat.', "--do"
    )


@dataclass(frozen=True)
class RenderOptions:
    """How pictures of a built city are taken; the city stays as it is.

    Attributes
    ----------
    camera
        "street", "aerial", "top", or a JSON file of cameras, which brings its own light.
    samples, size
        Samples per pixel and (width, height); those of the file, else the defaults, when None.
    time, weather
        Instead of the city's own, as of `cityx.light.weather.lit_anew`; "" keeps them.
    moment
        Seconds into the tracks that are shown; when None the city's own, or for each picture the
        next at which nothing that moves is within five metres before the lens. "busiest" takes, of
        all moments with nine metres free, the one at which most that moves is within sixty.
    frames
        "FROM:TO" or "FROM:TO:STEP", a span of frames of which each becomes a picture, 25 a second;
        "" for none.
    exact
        Whether pictures show what the files hold alone: no mirror image of the site beyond its
        borders, no twigs on bare trees.
    """

    camera: str = option("street", "street, aerial, top or FILE.json.")
    samples: int | None = option(None, "Samples per pixel.", low=1)
    size: tuple[int, int] | None = option(None, "Size in pixels, WxH.", spelling=PIXELS)
    time: str | None = option(None, "As of build; the city stays as it is.")
    weather: str | None = option(None, "As of build, or two: storm dusk.")
    moment: float | str | None = option(
        None, 'Seconds into what moves, or "busiest" of each picture.', spelling=_Moment()
    )
    frames: str | None = option(None, "A picture per frame, FROM:TO[:STEP], 25 a second.")
    exact: bool = option(False, "Show nothing beyond the site that no file holds.")
