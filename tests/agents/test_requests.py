import pytest

from cityx.agents.planning.workflow import Item
from cityx.agents.requests import with_requests
from cityx.errors import UsageError
from cityx.protocol import registry

ACTIONS = registry(outside=False)
CALLS = [
    ("background/sun-v1", {"time": "12:00"}),
    ("layout/crop-v1", {"width": 300.0}),
    ("road/network-v1", {}),
    ("nature/trees-v2", {}),
]


def planned(*settings, wishes=(), calls=CALLS):
    items = [Item(action, args) for action, args in calls]
    found = with_requests(items, settings, wishes, ACTIONS)
    return [(item.action, dict(item.args)) for item in found]


def test_arguments_are_set_by_their_name():
    assert ("layout/crop-v1", {"width": 500, "depth": 40.5}) in planned(
        "width=500", "crop.depth=40.5"
    )
    assert ("background/sun-v1", {"time": "18:30"}) in planned("background/sun-v1.time=18:30")
    assert CALLS[1] == ("layout/crop-v1", {"width": 300.0})


def test_an_added_action_runs_before_its_stage_is_done():
    found = planned(wishes=['scale_object scaled_obj_name="The Tower" scale_factor=1,1,2'])
    assert found[:-1] == CALLS
    args = {"scaled_obj_name": "The Tower", "scale_factor": [1, 1, 2]}
    assert found[-1] == ("edit/scale_object-v1", args)
    found = planned(wishes=["layout/crop-v1 width=90", "layout/crop-v1 width=80"])
    assert [args.get("width") for _, args in found] == [None, 300.0, 90, 80, None, None]
    found = planned(wishes=["nature/trees-v2", "road/network"])
    assert [action for action, _ in found] == [
        "background/sun-v1", "layout/crop-v1", "road/network-v1", "road/network-v1",
        "nature/trees-v2", "nature/trees-v2",
    ]  # fmt: skip


def test_arguments_of_an_added_action_are_set_too():
    found = planned("set_height.height=25", "width=90", wishes=["edit/set_height objects=a"])
    assert found[-1] == ("edit/set_height-v1", {"objects": ["a"], "height": 25})
    assert ("layout/crop-v1", {"width": 90}) in found


def test_every_fault_of_every_request_is_told_at_once():
    with pytest.raises(UsageError) as caught:
        planned(
            "wide=3", "width", "roads.width=3", "layout/crop.wide=2", "layout/crop-v1.depth=deep",
            wishes=["layout/corp width=3", "layout/crop-v1 width=-4 x", ""],
        )  # fmt: skip
    said = str(caught.value).splitlines()
    for start in (
        '--set "wide=3": no action has "wide". Did you mean "width"',
        '--set "width" is not of the form',
        '--set "roads.width=3": this build has no action "roads"',
        '--set "layout/crop.wide=2": no action has "wide"',
        '--do "layout/corp width=3":',
        '--do "layout/crop-v1 width=-4 x": "x" is not of the form NAME=VALUE',
        '--do "" is not of the form',
        "layout/crop-v1: depth = 'deep' is not a finite number",
        "layout/crop-v1: width = -4 is outside",
    ):
        assert any(line.startswith(start) for line in said), (start, said)


def test_a_name_that_several_actions_have_must_be_qualified():
    calls = [("layout/crop-v1", {}), ("layout/crop-v1", {})]
    with pytest.raises(UsageError, match="several actions have"):
        planned("width=3", calls=calls)


@pytest.mark.parametrize(
    ("name", "text", "value"),
    [
        ("scale_factor", "1,1,2", [1, 1, 2]),
        ("scale_factor", "[1, 1, 2]", [1, 1, 2]),
        ("scale_factor", "wide", "wide"),
        ("scaled_obj_name", "12", "12"),
    ],
)
def test_texts_become_values_of_the_kind_wanted(name, text, value):
    assert ACTIONS["scale_object"].parameter(name).read(text) == value


def test_what_needs_its_own_stage_comes_after_it():
    calls = [*CALLS, ("building/design-v1", {}), ("building/shell-v1", {})]
    found = [action for action, _ in planned(wishes=("building/neon_signs",), calls=calls)]
    assert found.index("building/neon_signs-v1") > found.index("building/shell-v1")
