"""What is to be taller than all other buildings: a church, three hotels, a town hall."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np

from cityx.checks.predicates.measuring import rows_of
from cityx.city import City, Goal
from cityx.city.bounds import is_stated
from cityx.errors import ActionFailed
from cityx.protocol import Choice, Port, action
from cityx.town.elements import ELEMENTS, taller_than_others
from cityx.town.rebuilding import with_heights
from cityx.town.wishes.limits import within_limits

ABOVE = 1.08  # times the tallest of the others
STRETCHED = 2.0  # times that a building is made higher at most; then the others become lower


@action(
    "layout/tallest-v1",
    limits=["A building is stretched to twice its height at most; then others are lowered."],
    requires=("layout",),
    after=("layout/highest-v1", "layout/floor_area-v1"),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("tallest", "highest", "taller than", "dominates", "landmark", "skyline"),
)
def tallest(
    city: City,
    *,
    kind: Annotated[str, Choice(*(name for name, one in ELEMENTS.items() if one.building))],
) -> City:
    """Make every building of a kind taller than all others.

    Parameters
    ----------
    city
        City with buildings of that kind.
    kind
        Which are to be the tallest.
    """
    layout = city.layout
    own = np.zeros(len(layout.buildings), bool)
    own[rows_of(ELEMENTS[kind].measure, city)] = True
    if not own.any():
        raise ActionFailed(f"There is no {kind.replace('_', ' ')} that could be the tallest.")
    old = layout.buildings["height"].to_numpy(float)
    top = old[~own].max(initial=0.0)
    new = np.round(np.where(own, np.clip(ABOVE * top, old, STRETCHED * old), old), 2)
    layout = with_heights(layout, np.flatnonzero(own), new[own])
    others = np.flatnonzero(~own & ~is_stated(layout.buildings))
    limit = (0.0, float(new[own].min()) / ABOVE)  # which binds what designs them, too
    layout = within_limits(replace(city, layout=layout), others, height=limit)
    goal = Goal(f"no building is as tall as a {kind.replace('_', ' ')}", taller_than_others(kind))
    return replace(city, layout=layout, goals=(*city.goals, goal))
