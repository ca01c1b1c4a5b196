from dataclasses import replace
from typing import Annotated

import numpy as np
import pytest
import shapely

from cityx.city import City, MeshBatch, one_mesh
from cityx.city.layout import is_mesh
from cityx.errors import ActionFailed, ActionRejected
from cityx.ids import id_text
from cityx.protocol import (
    InputFiles,
    ObjectName,
    Port,
    Range,
    Registry,
    action,
    has_layer,
    registry,
)
from cityx.protocol.example_city import example_city
from cityx.protocol.fingerprint import fingerprint
from cityx.protocol.gate import Budget, GateRejection, check, find_faults
from cityx.protocol.running import Call, run_action, run_step
from cityx.protocol.values import Footprint, Points, Surfaces, make_surfaces

NETWORK = Port("network", "line", "road_network")


@action("road/lamps-v1", limits=["None known."], requires=("layout", has_layer("signs")))
def lamps(city: City, *, spacing: Annotated[float, Range(5, 100)] = 30.0) -> City:
    """Place lamps.

    Parameters
    ----------
    spacing
        Metres.
    """
    return replace(city, notes=(*city.notes, f"{spacing:g}"))


@action("dynamic/cars-v1", limits=["None known."], takes=(NETWORK,), requires=("road",))
def cars(city: City) -> City:
    """Drive cars."""
    return city


@action("terrain/raise-v1", limits=["None known."])
def lift(city: City) -> City:
    """Raise the terrain."""
    return replace(city, terrain=replace(city.terrain, heights=city.terrain.heights + 1))


@action("edit/paint-v1", limits=["None known."], needs=("no_such_module",))
def paint(city: City, *, target: Annotated[str, ObjectName()]) -> City:
    """Paint an object.

    Parameters
    ----------
    target
        Its name.
    """
    del target
    return city


@action("edit/paint_all-v1", limits=["Test only."])
def paint_all(city: City, *, targets: Annotated[tuple[str, ...], ObjectName()]) -> City:
    """Paint objects.

    Parameters
    ----------
    city
        The city.
    targets
        The objects.
    """
    assert all(isinstance(name, str) for name in targets)
    return city


@action("edit/break-v1", limits=["None known."])
def break_it(city: City) -> City:
    """Fail."""
    city.terrain.heights.sum()
    raise ZeroDivisionError("by nothing")


@action("edit/forget-v1", limits=["None known."])
def forget(city: City) -> City:
    """Return nothing."""
    del city


@action("building/hut-v1", limits=["None known."])
def hut(footprint: Footprint, rng: np.random.Generator) -> MeshBatch:
    """Make a hut.

    Parameters
    ----------
    footprint
        Outline.
    """
    if footprint.holes:
        raise ValueError("courtyards are too hard")
    low = np.column_stack([footprint.ring[:3], np.zeros(3)])
    top = [*low[:2].mean(axis=0)[:2], rng.uniform(2, 9)]
    return one_mesh(0, [*low, top], [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])


@action("road/paver-v1", limits=["None known."], takes=(Port("bands", "surface", "road_surface"),))
def paver(bands: Surfaces) -> Surfaces:
    """Pave faces.

    Parameters
    ----------
    bands
        Faces.
    """
    return replace(bands, kind=np.full(bands.count, "parking"))


@action("nature/moss-v1", limits=["None known."])
def moss(points: Points) -> Surfaces:
    """Grow moss.

    Parameters
    ----------
    points
        Places.
    """
    return make_surfaces(shapely.buffer(shapely.points(points.position[:, :2]), 1), "grass")


MADE = Registry.of([lamps, cars, lift, paint, break_it, forget, hut])


def refusal(call, city=None, actions=MADE, **options):
    with pytest.raises(ActionRejected) as caught:
        run_step(example_city() if city is None else city, call, actions, **options)
    return str(caught.value)


def test_an_unknown_action_is_refused_with_the_near_ones():
    assert refusal(Call("road/lamp")) == (
        'UNKNOWN_ACTION: There is no action "road/lamp". '
        'Did you mean "road/lamps" or "road/lamps-v1" or "lamps"?'
    )


def test_every_fault_is_told_at_once():
    text = refusal(Call("lamps", {"spacing": 1, "colour": 3}))
    assert text == (
        'BAD_ARGS: road/lamps-v1 has no parameter "colour". It has spacing.\n'
        "BAD_ARGS: road/lamps-v1: spacing = 1 is outside 5 to 100.\n"
        "PRECONDITION: road/lamps-v1: Needs at least one object in layer signs."
    )


def test_a_missing_input_and_a_missing_stage_are_told():
    assert refusal(Call("cars")) == (
        "MISSING_INPUT: dynamic/cars-v1 needs network: line (road_network), "
        "which no action has made yet.\n"
        "STAGE_ORDER: dynamic/cars-v1 needs stage road to have run first."
    )


def test_a_stage_that_comes_too_late_is_refused():
    city = replace(example_city(), stages_done=frozenset({"layout", "building", "road"}))
    assert refusal(Call("terrain/raise"), city) == (
        "STAGE_ORDER: terrain/raise-v1 is too late: stage terrain comes before building and road, "
        "which already ran."
    )


def test_objects_and_capabilities_are_checked():
    assert refusal(Call("paint", {"target": "Long Stret"})) == (
        'NO_SUCH_OBJECT: edit/paint-v1: target = "Long Stret" names no single object. '
        'Did you mean "Long Street" or "High Street"?\n'
        "CAPABILITY: edit/paint-v1 needs no_such_module, which is not installed."
    )


def test_objects_are_found_by_id_source_and_name():
    city = example_city()
    number = int(city.layout.buildings["id"].iloc[0])
    for name in (id_text(number), "example/building/0", "The Tower"):
        codes = [f.code for f in find_faults(Call("paint", {"target": name}), city, MADE)]
        assert codes == ["CAPABILITY"]


def test_a_repeated_call_and_a_spent_budget_are_refused():
    call = Call("terrain/raise")
    assert refusal(call, seen={call.key}, budget=Budget(0, 5.0)) == (
        "BUDGET: The budget is spent: 0 steps and 5 seconds are left.\n"
        "DUPLICATE: terrain/raise-v1 already ran with these arguments on this very city."
    )


def test_an_untrusted_package_is_refused_before_it_is_imported():
    from cityx.protocol.registry import Entry

    made = Registry(trusted=frozenset({"friend"}))
    made.put(Entry("road/evil-v1", "evil_module:f", "evil", "", "stranger"))
    assert refusal(Call("evil"), actions=made) == (
        "UNTRUSTED: road/evil-v1 comes from package stranger, which is not trusted."
    )


def test_a_failed_action_leaves_the_city_as_it_was():
    city = example_city()
    before = fingerprint(city)
    with pytest.raises(ActionFailed) as caught:
        run_step(city, Call("edit/break"), MADE)
    assert str(caught.value) == "edit/break-v1 failed: ZeroDivisionError: by nothing"
    assert fingerprint(city) == before
    with pytest.raises(ActionFailed) as caught:
        run_step(city, Call("edit/forget"), MADE)
    assert str(caught.value) == "edit/forget-v1 failed: it returned NoneType, not City."


def test_a_stage_counts_as_done_after_its_action():
    city = replace(example_city(), stages_done=frozenset())
    after = run_step(city, Call("terrain/raise"), MADE)
    assert after.stages_done == {"terrain"}
    assert city.stages_done == frozenset()


def test_an_action_for_one_building_is_mapped_and_failures_are_named():
    city = run_step(example_city(), Call("hut"), MADE)
    assert city.layout.buildings["generator"].tolist().count("hut") == 3
    assert is_mesh(city.layout).sum() == 3
    (failure,) = city.failures
    assert (failure.action, failure.error) == (
        "building/hut-v1",
        "ValueError: courtyards are too hard",
    )


def test_each_building_has_its_own_stream():
    city = example_city()
    rows = city.layout.buildings
    fewer = replace(city, layout=replace(city.layout, buildings=rows.iloc[1:]))
    whole, part = (
        run_step(each, Call("hut"), MADE).layout.buildings.set_index("id")["height"]
        for each in (city, fewer)
    )
    assert whole.nunique() == 4
    assert whole[part.index].equals(part)


def test_road_lines_become_faces_without_being_planned():
    actions = registry(outside=False)
    actions.add(paver)
    city = example_city()
    outcome = run_action(city, Call("paver"), actions)
    path = outcome.conversions["bands"]
    assert path.source == ("line", "road_centerline")
    assert path.steps == ("Line_to_face_conversion",)
    assert outcome.value.count == 3
    assert len(outcome.city.layout.areas) == len(city.layout.areas) + 3
    assert outcome.city.layout.roads.equals(city.layout.roads)


def test_a_port_may_be_bound_to_another_source():
    actions = registry(outside=False)
    actions.add(moss)
    first = run_action(example_city(), Call("moss"), actions)
    assert first.conversions["points"].source == ("point", "thing")
    other = run_action(example_city(), Call("moss", bind={"points": "barrier"}), actions)
    assert other.conversions["points"].steps == ("Line_to_point_conversion",)
    assert refusal(Call("moss", bind={"points": "moon"}), actions=actions) == (
        'MISSING_INPUT: nature/moss-v1: The city holds nothing of role "moon"; it holds area, '
        "barrier, building_footprint, building_part, layout, road_centerline, thing."
    )


def test_input_files_reach_the_action_that_asks_for_them(tmp_path):
    @action("layout/count_inputs-v1", limits=["None known."])
    def count_inputs(city: City, inputs: InputFiles) -> City:
        """Count the inputs."""
        return replace(city, notes=(str(len(inputs.paths)),))

    city = replace(example_city(), stages_done=frozenset())
    files = InputFiles((tmp_path / "a.osm",))
    after = run_step(city, Call("count_inputs"), Registry.of([count_inputs]), inputs=files)
    assert after.notes == ("1",)


def test_every_name_of_a_list_must_lead_to_an_object():
    actions = Registry()
    actions.add(paint_all)
    city = example_city()
    known = [f"{number:016x}" for number in city.layout.buildings["id"].tolist()]
    check(Call("edit/paint_all-v1", {"targets": [*known, "The Tower"]}), city, actions)
    with pytest.raises(GateRejection) as caught:
        check(Call("edit/paint_all-v1", {"targets": [*known, "0" * 16, "nobody"]}), city, actions)
    assert [fault.code for fault in caught.value.faults] == ["NO_SUCH_OBJECT"] * 2
    assert 'targets = "nobody" names no single object.' in str(caught.value)
    with pytest.raises(GateRejection, match="is not an array of 1 to 200000 names of objects"):
        check(Call("edit/paint_all-v1", {"targets": []}), city, actions)
