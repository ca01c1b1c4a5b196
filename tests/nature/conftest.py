"""The crossroads with its rows in another order."""

from dataclasses import replace

import pytest


@pytest.fixture
def shuffled(crossroads):
    """The same city with the rows of every table in reverse."""
    layout = crossroads.layout
    names = ("buildings", "areas", "lines", "points")
    tables = {n: getattr(layout, n).iloc[::-1].reset_index(drop=True) for n in names}
    return replace(crossroads, layout=replace(layout, **tables))
