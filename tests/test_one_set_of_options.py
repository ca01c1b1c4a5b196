import pytest
from hypothesis import given
from hypothesis import strategies as st

from cityx.dataset.order import Order
from cityx.errors import UsageError
from cityx.options import (
    FORMATS,
    PIXELS,
    BuildOptions,
    HowToRead,
    PlannerChoice,
    RenderOptions,
    declared,
    options_from,
)
from cityx.projects.file_formats import BUILT_IN

KINDS = (BuildOptions, RenderOptions, PlannerChoice, Order)


@pytest.mark.parametrize("kind", KINDS)
def test_every_option_has_a_help_text_and_a_flag_of_its_own(kind):
    options = list(declared(kind))
    assert options
    assert all(item.option.help for item in options)
    assert len({item.flag.split("/")[0] for item in options}) == len(options)


@pytest.mark.parametrize("kind", KINDS)
def test_a_default_as_text_is_read_as_the_default(kind):
    spelled = [item for item in declared(kind) if item.option.spelling and item.default is not None]
    for item in spelled:
        text = item.option.spelling.write(item.default)
        assert item.option.value_of(text, item.kind, item.name) == item.default


@given(st.tuples(st.integers(16, 16384), st.integers(16, 16384)))
def test_pixels_are_written_as_they_are_read(size):
    assert PIXELS.read(PIXELS.write(size), "size") == size


def test_options_of_all_that_a_build_holds_are_given_by_name():
    made = options_from(BuildOptions, {
        "lod": 3, "size": [300, 200], "at": "60.17,24.94", "pixel": 0.5, "planner": "openai:m",
        "settings": ["pattern=radial"], "formats": "glb, usd", "kinds": "a.png=osm",
    })  # fmt: skip
    assert made == BuildOptions(
        lod=3, size=(300, 200), at=(60.17, 24.94), formats=("glb", "usd"),
        settings=("pattern=radial",), read=HowToRead(pixel=0.5, kinds=("a.png=osm",)),
        choice=PlannerChoice("openai:m"),
    )  # fmt: skip


def test_every_fault_is_told_at_once():
    with pytest.raises(UsageError) as caught:
        options_from(BuildOptions, {"lodd": 1, "lod": 9, "render": 1, "seed": True, "samples": 0,
                                    "size": (300, float("nan")), "picture": "1x1"})  # fmt: skip
    assert str(caught.value).splitlines() == [
        'There is no option "lodd". Did you mean "lod" or "look"?',
        "lod is 9; it takes 0 to 3.",
        "render is 1; it takes True or False.",
        "seed is True; it takes a whole number.",
        "samples is 0; it takes 1 to 65536.",
        "size is (300, nan); write numbers such as (800.0, 600.0).",
        'Picture size "1x1" is outside 16x16 to 16384x16384.',
    ]


def test_help_names_the_formats_that_are_built_in():
    assert [each.name for each in BUILT_IN] == list(FORMATS)
