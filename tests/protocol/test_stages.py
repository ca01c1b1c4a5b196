import pytest

from cityx.errors import UsageError
from cityx.protocol.stages import (
    ORDER,
    is_linear_extension,
    stages_after,
    stages_before,
    to_stage,
    topological_order,
)


def test_every_stage_comes_after_those_it_waits_for():
    order = topological_order(ORDER)
    for stage, followers in ORDER.items():
        assert all(order.index(stage) < order.index(name) for name in followers)


def test_a_cycle_is_an_error_that_shows_it():
    with pytest.raises(UsageError) as caught:
        topological_order({"a": ["b"], "b": ["c"], "c": ["b"], "d": ["a"]})
    assert str(caught.value) in (
        "The order has a cycle: b -> c -> b.",
        "The order has a cycle: c -> b -> c.",
    )


@pytest.mark.parametrize(
    ("plan", "fits"),
    [
        (["layout/osm-v1", "terrain/dem-v1", "building/shell-v1", "road/network-v1"], True),
        (["layout", "terrain", "road", "building"], True),
        (["layout", "building", "road", "building"], True),
        (["layout", "building", "edit", "render", "road", "convert"], True),
        (["building", "road"], True),
        (["building", "layout"], False),
        (["layout", "road", "terrain"], False),
        (["dynamic", "road"], False),
        (["layout", "background", "nature"], True),
        (["dynamic", "layout"], False),
        ([], True),
    ],
)
def test_a_plan_is_a_linear_extension_or_not(plan, fits):
    assert is_linear_extension(plan) is fits


def test_stages_before_and_after_reach_through_others():
    assert stages_before("dynamic") == {"layout", "terrain", "road"}
    assert stages_after("layout") == {"terrain", "building", "road", "nature", "dynamic"}
    assert "road" not in stages_before("building")
    assert "building" not in stages_before("road")


def test_an_unknown_stage_shows_the_near_one():
    with pytest.raises(UsageError) as caught:
        to_stage("roads")
    assert str(caught.value) == 'There is no stage "roads". Did you mean "road"?'
