"""A large park in the middle of a city, with a lake in it if so asked."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import City, Layout
from cityx.city.asked_goals import asked, with_goal
from cityx.errors import ActionFailed
from cityx.ids import draw
from cityx.protocol import Port, Range, action
from cityx.sources.features.tagged import Owner
from cityx.town.cutting import given_up_in
from cityx.town.rebuilding import WET, cleared, street_blocks, with_area

LANE = 36.0  # metres; streets with their walks up to so wide are built over between two blocks
ENOUGH = 0.97  # of the wanted area, from which no block is added
MOST = 0.7  # of the site that a park may take
LAKE = 0.28  # of the park that its lake takes
CLEAR = 14.0  # metres from a lake to the border of its park at least
RIPPLE, POINTS = 0.16, 48  # of its radius that a lake's shore swings by; its points


@action(
    "layout/central_park-v1",
    limits=["Buildings and streets in the way are taken down; the park ends at streets."],
    requires=("layout",),
    after=("layout/street_rows-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("park", "lake", "pond", "green", "gardens"),
)
def central_park(
    city: City, *, share: Annotated[float, Range(0.02, 0.6)] = 0.12, lake: bool = True
) -> City:
    """Lay out a large park by the middle of a city, with a lake in it.

    Parameters
    ----------
    city
        City with streets.
    share
        Of the site that the park takes, about: whole blocks are joined.
    lake
        Whether a lake lies in its middle.
    """
    layout = city.layout
    site = shapely.box(*layout.extent)
    ground = _joined_blocks(layout, share * site.area)
    layout = given_up_in(cleared(layout, ground), ground)
    owner = Owner(("made", "park", "central"), {"name": "Central Park"})
    layout = with_area(layout, "park", ground, owner)
    if lake:
        water = _lake(ground, draw(city.seed, "layout/lake", 1))
        layout = with_area(layout, "water", water, Owner(("made", "lake", "central"), {}))
    city = asked(replace(city, layout=layout), "a park", "n(park)", least=1)
    return with_goal(city, "a lake in the park", "inside(lake, park)") if lake else city


def _joined_blocks(layout: Layout, wanted: float) -> Any:
    """Join blocks, from the middle outwards, with the streets between them, until they suffice."""
    site = shapely.box(*layout.extent)
    blocks = _free(layout)
    # By their farthest corners, so that what is joined is as round as can be.
    away = np.round(shapely.hausdorff_distance(blocks, site.centroid), 2)
    blocks = blocks[np.argsort(away, kind="stable")]
    ground = shapely.Polygon()
    for block in blocks.tolist():
        if ground.area >= ENOUGH * wanted:
            break
        grown = _closed(shapely.union(ground, block)) if not ground.is_empty else block
        if grown.geom_type == "Polygon" and grown.area <= MOST * site.area:
            ground = shapely.Polygon(grown.exterior)
    if ground.area < 0.5 * wanted:
        raise ActionFailed(
            f"There is room for a park of {ground.area:.0f} square metres, {wanted:.0f} are asked "
            "for; ask for a smaller share or a larger site."
        )
    return shapely.orient_polygons(shapely.simplify(ground, 0.1))


def _free(layout: Layout) -> NDArray[Any]:
    """Return the blocks that hold neither water nor a building that was asked for."""
    blocks = street_blocks(layout)
    made = layout.buildings["source"].str.startswith("made/tower").to_numpy(bool)
    wet = layout.areas["kind"].isin([*WET, "sand"]).to_numpy()
    kept = [layout.buildings.geometry.to_numpy()[made], layout.areas.geometry.to_numpy()[wet]]
    free = np.ones(len(blocks), bool)
    found = shapely.STRtree(np.concatenate(kept))
    free[found.query(shapely.buffer(blocks, -1.0), predicate="intersects")[0]] = False
    return np.asarray(blocks[free])


def _closed(shape: Any) -> Any:
    """Fill gaps as wide as a street."""
    grown = shapely.buffer(shape, LANE / 2, join_style="mitre")
    return shapely.buffer(grown, -LANE / 2, join_style="mitre")


def _lake(park: Any, phase: float) -> Any:
    """Return a lake about the widest place of a park."""
    middle = shapely.maximum_inscribed_circle(park, tolerance=1.0)
    centre = np.array(middle.coords[0])
    radius = np.sqrt(LAKE * park.area / np.pi)
    turn = 2 * np.pi * np.arange(POINTS) / POINTS
    swing = np.sin(2 * turn + 2 * np.pi * phase) + 0.6 * np.sin(3 * turn - 2 * np.pi * phase)
    box = shapely.oriented_envelope(park)
    ring = shapely.get_coordinates(box)
    sides = ring[1] - ring[0], ring[3] - ring[0]
    long, short = sorted(sides, key=lambda way: -float(np.hypot(*way)))
    stretch = min(np.sqrt(np.hypot(*long) / np.hypot(*short)), 1.6)
    u, v = long / np.hypot(*long), short / np.hypot(*short)
    away = radius * (1 + RIPPLE * swing)
    along, across = away * np.cos(turn) * stretch, away * np.sin(turn) / stretch
    points = centre + np.outer(along, u) + np.outer(across, v)
    room = shapely.buffer(park, -CLEAR)
    parts = shapely.get_parts(shapely.intersection(shapely.Polygon(points), room))
    largest = parts[int(np.argmax(shapely.area(parts)))]
    return shapely.orient_polygons(shapely.simplify(largest, 0.05))
