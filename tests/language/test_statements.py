"""What is told of some things alone becomes a command; what is not there is asked about."""

import pytest

from cityx.language import read_brief


def commands_of(text, **more):
    return [one.text for one in read_brief(text, **more).then]


@pytest.mark.parametrize(
    ("text", "command"),
    [
        (
            "A town where the buildings on the main street are brick and two storeys high.",
            "make the buildings on the main street brick and two storeys high",
        ),
        (
            "A city with a river; the houses facing the river are yellow.",
            "make the houses facing the river yellow",
        ),
        (
            "A small town. Houses within 100 m of the church should be white with red roofs.",
            "make houses within 100 m of the church white with red roofs",
        ),
        (
            "Every building near the station has a flat roof.",
            "give every building near the station a flat roof",
        ),
        ("A city. All towers over 100 m in white.", "make all towers over 100 m white"),
    ],
)
def test_a_statement_of_some_is_a_command(text, command):
    brief = read_brief(text)
    assert [one.text for one in brief.then] == [command]
    assert not any(key.startswith(("building.", "house.")) for key, _ in brief.items())


@pytest.mark.parametrize(
    "text",
    [
        "Some of the houses near the river are white.",
        "Buildings that nobody grumbles about are red.",
        "If the houses by the river are red, the rest is white.",
    ],
)
def test_what_no_command_says_stays_open(text):
    assert not commands_of(text)


def test_each_order_of_a_sentence_is_one_by_itself():
    text = "Give every building over three storeys a brick facade, and plant zorgs along the zib."
    found = commands_of(text, inputs=[("map.osm", "osm")])
    assert found == ["Give every building over three storeys a brick facade"]


@pytest.mark.parametrize(
    ("text", "asked"),
    [
        ("Rebuild my nan's street as it was.", "my nan's street"),
        ("Build the village where I grew up.", "the village where I grew up"),
        ("The same as last time but with more trees.", "The same as last time"),
        ("Move it 30 m to the left.", "it"),
        ("Make that one twice as tall.", "that"),
        ("Make the tower like the one I showed you.", "the one I showed"),
    ],
)
def test_what_only_its_writer_knows_is_asked_about(text, asked):
    questions = [one.text for one in read_brief(text).questions]
    assert any(f'"{asked}"' in one for one in questions), questions


@pytest.mark.parametrize(
    "text",
    [
        "Four towers, two of glass, the other two of brick.",
        "A town by the river with its market; add it to the square.",
        "A village with our kind of pubs.",
        "My robot needs a town with ramps.",
    ],
)
def test_what_is_told_is_not_asked_about(text):
    assert not read_brief(text).questions


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("30 houses on a plot of 40 by 40 m, each with a garden of 500 m2.", "30 buildings"),
        ("400 houses, each on its own 800 square metre plot, on 300 by 300 m.", "about 112 do"),
        ("60 houses, each at least 80 m from any other, on 200 by 200 m.", "60 buildings"),
        ("Make the town car-free, with a busy road full of traffic in the middle.", "traffic"),
        ("Midnight with the sun high overhead over a town.", "no sun in the sky"),
    ],
)
def test_what_cannot_both_hold_is_named(text, words):
    assert any(words in one.text for one in read_brief(text).conflicts)


@pytest.mark.parametrize(
    ("text", "share"),
    [
        ("A street at night, only a handful of windows lit.", 0.06),
        ("Night, most windows dark.", 0.25),
        ("Night. Half the windows are dark.", 0.5),
        ("A city at night, most of the windows are lit.", 0.75),
    ],
)
def test_how_many_windows_are_lit_is_read(text, share):
    assert read_brief(text).value("windows.lit") == pytest.approx(share)


MAP = [("map.osm", "osm")]


@pytest.mark.parametrize(
    ("text", "zone"),
    [
        ("Fill the empty blocks with plausible housing.", None),
        ("Roads only here, so please invent the buildings.", None),
        ("populate the vacant plots with terraced houses", "row"),
        ("Complete the missing blocks with offices of 5 to 8 floors.", "core"),
        ("Fill the blocks without buildings with flats and tell me what is invented.", "midrise"),
    ],
)
def test_empty_blocks_of_a_map_are_filled(text, zone):
    brief = read_brief(text, inputs=MAP)
    assert ("blocks", "filled") in brief.items()
    assert brief.value("blocks.zone") == zone
    assert not any("iou(building" in one.predicate for one in brief.goals)


@pytest.mark.parametrize(
    "text", ["fill the gaps with gardens", "Fill the pond with sand", "invent no buildings"]
)
def test_other_land_is_not_built_on(text):
    assert ("blocks", "filled") not in read_brief(text, inputs=MAP).items()


@pytest.mark.parametrize(
    ("text", "key", "value"),
    [
        ("Twelve white hotels along the beach of a town.", "hotel.color", "white"),
        ("A town with brick schools.", "school.material", "brick"),
        ("60 houses, most of them white with red tile roofs.", "building.color", "white"),
        ("A ski village. One main street with shops.", "shop.by", "main_street"),
        ("An old railway and towers from 60 to 200 metres.", "tower.height.min", 60),
    ],
)
def test_a_look_or_a_measure_is_of_what_has_it(text, key, value):
    assert read_brief(text).value(key) == value


@pytest.mark.parametrize("text", ["Give every house a garage.", "give the school a bell tower"])
def test_giving_a_building_replaces_none(text):
    brief = read_brief(text, base=True)
    assert [edit.verb for edit in brief.edits] in ([], ["unspecified"])
    assert any("stand" in one.text for one in (*brief.questions, *brief.left))


@pytest.mark.parametrize("said", ["single storey", "one storey", "single-storey", "one floor"])
def test_a_single_storey_is_one_floor(said):
    brief = read_brief(f"A village of 12 houses, all {said}, each over 30 m tall.")
    assert brief.value("building.floors") == 1
    assert any("cannot reach 30 m" in one.text for one in brief.conflicts)


@pytest.mark.parametrize(
    ("text", "key", "value"),
    [
        ("15 skyscrapers, the tallest 260 m.", "height.highest", 260),
        ("A resort with a beach, then a row of hotels 8 to 12 storeys.", "hotel.floors.max", 12),
        ("A town, traffic keeps to 20 mph.", "vehicle.speed.max", pytest.approx(8.94, abs=0.01)),
        ("A village at night, streetlights on.", "lights", "on"),
        ("A town where traffic drives on the left.", "traffic.side", "left"),
        ("A village, keep right.", "traffic.side", "right"),
    ],
)
def test_more_of_what_is_said_is_read(text, key, value):
    assert read_brief(text).value(key) == value


@pytest.mark.parametrize(
    ("text", "gone"),
    [
        (
            "Lose anything modern such as parked cars and lamp posts.",
            {"parked_vehicle", "streetlight"},
        ),
        ("Drop all the buildings.", {"building"}),
        ("Lose the street lamps and the benches.", {"streetlight", "bench"}),
    ],
)
def test_what_an_order_takes_away_is_denied(text, gone):
    assert {str(one.value) for one in read_brief(text, inputs=MAP).negated} == gone


def test_the_office_of_somebody_is_no_office_building():
    assert not read_brief("A town with a saloon and a sheriff's office.").value("office.count.min")


def test_what_is_said_of_invented_buildings_is_not_said_of_mapped_ones():
    text = "Fill the empty blocks with brick houses of two floors with red roofs."
    brief = read_brief(text, inputs=MAP)
    assert brief.value("blocks.floors.max") == 2
    assert not any(key.startswith(("building.", "roof.")) for key, _ in brief.items())
    assert any("red" in one for one in brief.told)


@pytest.mark.parametrize("text", ["60 houses with gardens of 500 m2 on 100 x 100 m."])
def test_a_place_that_houses_stand_on_is_the_site(text):
    assert read_brief(text).value("size.x") == 100


@pytest.mark.parametrize(
    ("text", "command"),
    [
        ("Half of the houses are white, half of them yellow.",
         "paint half of the houses white and the rest yellow"),
        ("Two thirds of the offices are glass, the rest brick.",
         "make two thirds of the offices glass and the rest brick"),
        ("30% of the houses have balconies.", "give 30% of the houses balconies"),
        ("A quarter of the buildings have four floors.",
         "give a quarter of the buildings four floors"),
    ],
)  # fmt: skip
def test_what_a_part_of_the_buildings_is_is_a_change_of_so_many(text, command):
    assert [one.text for one in read_brief(text).then] == [command]


def test_parts_that_take_turns_are_not_put_on_all():
    brief = read_brief("A third of the houses yellow, a third blue and a third white.")
    assert brief.value("building.color") is None
    assert [one.text for one in brief.then] == [
        "paint a third of the houses yellow, a third blue and a third white"
    ]
