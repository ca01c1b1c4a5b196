"""Options of a build reach the actions they are about."""

import pytest

from cityx.options import BuildOptions
from cityx.projects.build import make_job


@pytest.mark.parametrize(
    ("options", "wanted"),
    [
        (BuildOptions(size=(200.0, 210.0)), {"width": 200.0, "depth": 210.0}),
        (
            BuildOptions(window=(10.0, 20.0, 300.0, 200.0)),
            {"x": 160.0, "y": 120.0, "width": 300.0, "depth": 200.0, "bounded": False},
        ),
    ],
)
def test_size_and_window_are_those_of_the_town_where_there_is_no_map(options, wanted):
    (town,) = (item for item in make_job([], options).first_plan() if "town" in item.action)
    assert dict(town.args) == wanted
