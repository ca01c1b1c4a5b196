from importlib import import_module
from pathlib import Path
from textwrap import dedent
from typing import Annotated

import pytest
import shapely

from cityx.assets.fixtures import fixture
from cityx.assets.styles.palette_tables import REDS
from cityx.building.catalogue import NAMES, generators
from cityx.building.generators import TABLES, action_of, generator
from cityx.building.generators.packaged import _faults
from cityx.building.massing.massing import Mass, Plot
from cityx.city import City, Frame, Layout
from cityx.errors import InputError
from cityx.protocol import Range, encapsulation_of

TABLE = """
title = "Kiosk"
levels = [1, 4]
labels = ["kiosk"]
limits = ["Nobody sells."]
[shared]
lamp = [{name = "lamp", at = "door"}]
[look]
walls = [[2, "brick", ["$REDS[:2]", 0xFFFFFF]]]
own_trim = true
[look.facade]
mode = "punched"
bay = 3
windows = {window_small = 2, window_single = 1}
doors = "door_service"
fixtures = ["$lamp", {name = "bench", at = "foot"}]
[zones.back]
own_trim = false
[zones.back.facade]
fixtures = "$lamp"
[zones.top.facade]
like = ""
mode = "shed"
bay = 2
windows = ""
doors = "door_service"
[zones.roof]
like = "back"
old = true
"""


def masses(
    plot: Plot, *, wing: Annotated[float, Range(2.0, 9.0)] = 4.0, hidden: int = 1
) -> tuple[Mass, ...]:
    """Build kiosks.

    Parameters
    ----------
    wing
        Metres of the wing.
    """
    return (plot.body,) * int(wing) * hidden


@pytest.fixture
def made(tmp_path):
    def make(text=TABLE, **fixed):
        path = tmp_path / "kiosk.toml"
        path.write_text(text)
        return generator(masses, table=path, **fixed)

    return make


def test_a_look_names_palettes_and_shared_lists(made):
    look = made().look
    assert look.walls == ((2.0, "brick", (*REDS[:2], 0xFFFFFF)),)
    assert [each.name for each in look.facade.fixtures] == ["lamp", "bench"]
    assert look.facade.windows == (("window_small", 2.0), ("window_single", 1.0))


def test_a_zone_keeps_what_it_does_not_say_from_the_look_that_it_is_like(made):
    kind = made()
    back, top, roof = (kind.zones[name] for name in ("back", "top", "roof"))
    assert back.walls == top.walls == kind.look.walls
    assert (kind.look.own_trim, back.own_trim, top.own_trim, roof.own_trim) == (1, 0, 1, 0)
    assert [each.name for each in back.facade.fixtures] == ["lamp"]
    assert back.facade.bay == 3.0
    assert top.facade.fixtures == ()
    assert roof.facade == back.facade
    assert roof.old
    assert list(kind.zones) == ["back", "top", "roof"]


@pytest.mark.parametrize(
    ("was", "becomes", "message"),
    [
        ("bay = 3", "bay = 3\nbalcon = 1",
         'kiosk.toml, look, facade: there is no key "balcon". Did you mean "balcony"'),
        ('"$lamp"', '"$lump"', 'kiosk.toml: nothing is named "$lump". Did you mean "lamp"?'),
        ('like = "back"', 'like = "bak"',
         'kiosk.toml, roof: no look "bak" comes before. Did you mean "back"?'),
        ("title =", "titel =", 'kiosk.toml: there is no key "titel". Did you mean "title"'),
        ("bay = 3", 'bay = "3"', "kiosk.toml, look, facade, bay: '3' is not of type number."),
    ],
)  # fmt: skip
def test_a_fault_of_a_table_names_file_look_and_what_would_be_right(made, was, becomes, message):
    with pytest.raises(InputError) as error:
        made(TABLE.replace(was, becomes))
    assert str(error.value).startswith(message)


def test_the_action_has_the_described_inputs_between_the_common_ones(made):
    record = encapsulation_of(action_of("building/kiosk-v1", made(), masses))
    assert [each.name for each in record.parameters] == [
        "share", "floors", "building", "wing", "noise",
    ]  # fmt: skip
    floors, wing = record.parameters[1], record.parameters[3]
    assert (floors.low, floors.high, floors.default) == (0, 4, 0)
    assert (wing.low, wing.high, wing.description) == (2.0, 9.0, "Metres of the wing.")
    assert record.description == "Build kiosks."
    assert record.limits[1:] == ("Nobody sells.",)
    assert record.labels == ("kiosk",)


def test_no_storeys_are_asked_for_where_a_table_sets_no_bound(made):
    unbounded = made(TABLE.replace("levels = [1, 4]\n", ""))
    record = encapsulation_of(action_of("building/kiosk-v1", unbounded, masses))
    assert "floors" not in [each.name for each in record.parameters]


def test_a_call_passes_its_inputs_to_the_volumes_and_the_rest_to_the_design(made, monkeypatch):
    seen = {}

    def redesign(city, kind, *, mass, **given):
        seen.update(given, **mass.keywords, title=kind.title)
        return city

    monkeypatch.setattr("cityx.building.design.redesign", redesign)
    kiosk = action_of("building/kiosk-v1", made(hidden=3), masses)
    city = City("kiosks", Frame(48.0, 15.6), Layout(shapely.box(0, 0, 9, 9)))
    assert kiosk(city, wing=7.0, floors=2) is city
    assert seen == {"share": 1.0, "floors": 2, "building": None, "noise": 0.5, "wing": 7.0,
                    "title": "Kiosk"}  # fmt: skip


def test_the_generator_of_the_documentation_is_one(tmp_path, monkeypatch):
    page = (Path(__file__).parents[2] / "docs" / "generators.md").read_text()
    for language, suffix in (("python", "py"), ("toml", "toml")):
        block = page.partition(f"```{language}\n")[2].partition("```")[0]
        (tmp_path / f"kiosk.{suffix}").write_text(dedent(block))
    monkeypatch.setattr("cityx.building.generators.TABLES", tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    kiosk = import_module("kiosk")
    assert kiosk.GENERATOR.zones["back"].facade.mode == "shed"
    things = [each.name for each in kiosk.GENERATOR.look.facade.fixtures]
    assert all(len(fixture(name).mesh.vertices) for name in things)
    grown = kiosk.masses(Plot(shapely.box(0, 0, 6, 5), 3.0, 1, 7, 0, (0.0, -1.0)), canopy=1.0)
    assert [(each.plan.area, each.high) for each in grown] == [(12.0, 2.7), (30.0, 3.0)]
    assert encapsulation_of(kiosk.kiosk).id == "building/kiosk-v1"


def test_every_word_of_every_table_names_something():
    assert [fault for kind in generators().values() for fault in _faults(kind)] == []


def test_each_generator_has_its_table_and_no_table_is_left_over():
    assert {path.stem for path in TABLES.glob("*.toml")} == set(NAMES) == set(generators())
