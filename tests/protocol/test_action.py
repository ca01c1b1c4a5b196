from __future__ import annotations

import json
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
import pytest

from cityx.errors import ActionRejected, UsageError
from cityx.protocol import Choice, Color, Encapsulation, InputFiles, Port, Range, action, has_layer
from cityx.protocol.values import Footprint, Lines, Surfaces

if TYPE_CHECKING:
    from pathlib import Path

    from cityx.city import City, MeshBatch


@action(
    "road/network-v1",
    limits=["Tunnels are left out."],
    requires=("layout", has_layer("roads")),
    takes=(Port("roads", "line", role="road_centerline"),),
    gives=(Port("network", "line", role="road_network"),),
)
def network(
    city: City,
    *,
    smooth: Annotated[float, Range(0, 1)] = 0.3,
    mode: Literal["fast", "exact"] = "fast",
    paint: Annotated[int, Color()] = 0xFF0000,
    size: tuple[float, float, float] = (1.0, 2.0, 3.0),
    most: int | None = None,
    word: Annotated[str, Choice("left", "right")] = "left",
    lit: bool = False,
) -> City:
    """Make the network
    of the roads.

    More words.

    Parameters
    ----------
    smooth
        How much corners are rounded,
        0 to 1.
    mode, word : str
        A word.
    paint
        A colour.
    size
        Three numbers.
    most
        Greatest number.
    lit
        Whether lit.
    """
    del smooth, mode, paint, size, most, word, lit
    return city


def test_an_action_stays_a_plain_function():
    assert network("a city", smooth=7.0) == "a city"


def test_the_record_is_read_from_docstring_and_signature():
    record = network.encapsulation
    assert (record.classname, record.stage, record.version) == ("network", "road", 1)
    assert record.description == "Make the network of the roads."
    assert record.parameter("smooth").description == "How much corners are rounded, 0 to 1."
    assert record.parameter("word").description == "A word."
    assert record.run == "test_action:network"
    assert record.scope == "city"
    assert record.limitation == (
        "Needs stage layout to have run. Needs at least one object in layer roads. "
        "Tunnels are left out. Comes after layout, terrain where planned. smooth: 0 to 1. "
        "paint: 0 to 16777215."
    )


def test_the_record_survives_json():
    text = json.dumps(network.encapsulation.to_json())
    assert Encapsulation.from_json(json.loads(text)) == network.encapsulation


@pytest.mark.parametrize("field", sorted(network.encapsulation.to_json()))
def test_a_missing_field_is_refused_by_name(field):
    record = network.encapsulation.to_json()
    del record[field]
    with pytest.raises(UsageError, match=f"field {field} is missing"):
        Encapsulation.from_json(record)


@pytest.mark.parametrize(
    ("field", "value", "message"),
    [
        ("classname", "", "classname is empty"),
        ("description", " ", "description is empty"),
        ("run", "", "run is empty"),
        ("gives", [], "gives is empty"),
        ("id", "road/Network", "the id is not of the form"),
        ("kind", "magic", "kind 'magic' is none of"),
    ],
)
def test_an_empty_field_is_refused(field, value, message):
    record = network.encapsulation.to_json() | {field: value}
    with pytest.raises(UsageError, match=message):
        Encapsulation.from_json(record)


def test_an_action_without_any_limit_is_refused():
    record = network.encapsulation.to_json()
    record |= {"limits": [], "requires": [], "preconditions": []}
    with pytest.raises(UsageError, match="limits is empty: say what the action cannot do"):
        Encapsulation.from_json(record)


@pytest.mark.parametrize(
    ("args", "message"),
    [
        ({"smooth": 2.0}, "road/network-v1: smooth = 2.0 is outside 0 to 1."),
        ({"smooth": float("nan")}, "road/network-v1: smooth = nan is not a finite number."),
        ({"smooth": True}, "road/network-v1: smooth = True is not a finite number."),
        ({"most": 1.5}, "road/network-v1: most = 1.5 is not a whole number."),
        ({"lit": 1}, "road/network-v1: lit = 1 is not true or false."),
        (
            {"smoth": 0},
            'road/network-v1 has no parameter "smoth". Did you mean "smooth" or "most"?',
        ),
        (
            {"mode": "fas"},
            'road/network-v1: mode = \'fas\' is none of "fast", "exact". Did you mean "fast"?',
        ),
        ({"size": [1, 2]}, "road/network-v1: size = [1, 2] is not an array of 3 numbers."),
        ({"paint": -1}, "road/network-v1: paint = -1 is outside 0 to 16777215."),
        ({"smooth": None}, "road/network-v1: smooth = null is not a finite number."),
    ],
)
def test_bad_arguments_are_refused_word_for_word(args, message):
    with pytest.raises(ActionRejected) as caught:
        network.encapsulation.arguments(args)
    assert str(caught.value) == message
    assert caught.value.code == "BAD_ARGS"


def test_all_faults_are_told_at_once():
    faults = network.encapsulation.argument_faults({"smooth": 9, "lit": "yes", "x": 1})
    assert len(faults) == 3


def test_arguments_become_python_values():
    args = network.encapsulation.arguments({"size": [1, 2, 3], "smooth": 1, "most": 4.0})
    assert args == {"size": (1.0, 2.0, 3.0), "smooth": 1.0, "most": 4}
    assert isinstance(args["most"], int)


def test_the_record_checks_ranges_when_it_runs():
    with pytest.raises(ActionRejected):
        network.encapsulation.call(None, smooth=4)


@pytest.mark.parametrize(
    "text", ["http://a.b", "/etc/passwd", "~/x", "..", "a\\b", "a\nb", "x" * 81]
)
def test_a_text_that_reaches_outside_is_refused(text):
    @action("nature/words-v1", limits=["None known."])
    def words(city: City, *, word: str = "") -> City:
        """Say a word.

        Parameters
        ----------
        word
            Any.
        """
        del word
        return city

    assert len(words.encapsulation.argument_faults({"word": text})) == 1
    assert words.encapsulation.argument_faults({"word": "osm/way/12, Straße"}) == []


def _bad(name, annotation, doc="x\n        A thing."):
    def bad(city: City, *, x: int) -> City:
        """Do."""
        del x
        return city

    bad.__annotations__["x"] = annotation
    bad.__doc__ = f"Do.\n\n    Parameters\n    ----------\n    {doc}\n"
    return action(f"edit/{name}-v1", limits=["None known."])(bad)


@pytest.mark.parametrize(
    ("annotation", "doc", "message"),
    [
        ("int", "y\n        A thing.", "parameter x is not described in the docstring"),
        ("Path", "x\n        A thing.", "annotation Path is unknown when the plugin runs"),
        ("dict[str, int]", "x\n        A thing.", "is no type a call can carry"),
    ],
)
def test_a_bad_parameter_is_refused_when_the_plugin_loads(annotation, doc, message):
    with pytest.raises(UsageError, match=r"Action edit/bad-v1: .*" + message):
        _bad("bad", annotation, doc)


def test_a_parameter_without_annotation_is_refused():
    def bad(city: City, *, x=1) -> City:
        """Do."""
        del x
        return city

    with pytest.raises(UsageError, match="Action edit/bad-v1: parameter x has no annotation"):
        action("edit/bad-v1", limits=["None known."])(bad)


def test_a_parameter_that_is_a_path_is_refused():
    def bad(city: City, *, path: str = "") -> City:
        """Do.

        Parameters
        ----------
        path
            Where.
        """
        del path
        return city

    with pytest.raises(UsageError, match="no action takes code, a path or an address"):
        action("edit/bad-v1", limits=["None known."])(bad)


def test_a_default_outside_its_range_is_refused():
    def bad(city: City, *, x: Annotated[float, Range(0, 1)] = 2.0) -> City:
        """Do.

        Parameters
        ----------
        x
            Number.
        """
        del x
        return city

    with pytest.raises(UsageError, match=r"The default of x is refused: x = 2.0 is outside 0 to 1"):
        action("edit/bad-v1", limits=["None known."])(bad)


def test_ports_follow_from_types():
    @action("convert/widen-v1", limits=["Loses ends."])
    def widen(lines: Lines, rng: np.random.Generator, *, width: float = 2.0) -> Surfaces:
        """Widen lines.

        Parameters
        ----------
        lines
            Lines.
        width
            Metres.
        """
        raise NotImplementedError

    record = widen.encapsulation
    assert record.takes == (Port("lines", "line"),)
    assert record.gives == (Port("result", "surface"),)
    assert [p.name for p in record.parameters] == ["width"]
    assert (record.scope, record.kind) == ("value", "conversion")


def test_a_footprint_makes_an_action_for_one_building():
    @action("building/hut-v1", limits=["Small."])
    def hut(footprint: Footprint, rng: np.random.Generator) -> MeshBatch:
        """Make a hut.

        Parameters
        ----------
        footprint
            Outline.
        """
        raise NotImplementedError

    assert hut.encapsulation.scope == "thing"


def test_an_unknown_format_names_the_near_ones():
    with pytest.raises(UsageError) as caught:
        Port("roads", "lines")
    assert str(caught.value) == 'There is no format "lines". Did you mean "line"?'


def test_input_files_are_named_by_number(tmp_path: Path):
    from cityx.errors import ActionFailed

    files = InputFiles((tmp_path / "a.osm",))
    assert files.path(0, (".osm",)).name == "a.osm"
    with pytest.raises(ActionFailed, match=r"There is no input 1; 1 input files were given\."):
        files.path(1)
    with pytest.raises(ActionFailed, match=r"Input 0 is a\.osm; this action reads \.tif\."):
        files.path(0, (".tif",))
