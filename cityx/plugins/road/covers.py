"""Covers in carriageways: gullies along the kerbs, manholes in the lanes."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from cityx.assets.covers import cover
from cityx.city.city import City
from cityx.city.scene import Instances
from cityx.geometry.identity import hash_ids, uniform
from cityx.plugins.road.carriageway import kerbed_edges, road_labels
from cityx.plugins.road.kerbs import join_places, places_along
from cityx.protocol import Port, Range, action, has_network

ACTION = "road/covers-v1"
NAMES = ("manhole", "gully")
GULLY_IN = -0.2  # metres from the kerb to the middle of a grate
MANHOLE_IN = 1.7  # metres from the kerb: near the middle of the lane
LEAST_HALF = 2.4  # metres of half carriageway that has manholes
SLACK = 0.5  # share of their spacing by which manholes leave their places
MARGIN = 3.0  # metres behind the junction


@action(
    ACTION,
    limits=["Runs at level of detail 2 and above; below it changes nothing."],
    requires=("layout", has_network()),
    after=("road/ground-v1",),
    takes=(Port("network", "line", role="road_network"),),
    gives=(Port("covers", "point", role="street_cover"),),
)
def covers(
    city: City, *,
    gullies: Annotated[float, Range(8.0, 200.0)] = 26.0,
    manholes: Annotated[float, Range(10.0, 500.0)] = 44.0,
) -> City:  # fmt: skip
    """Set gullies along the kerbs of streets and manholes into their lanes.

    Parameters
    ----------
    gullies, manholes
        Metres between them along the street.
    """
    network = city.network
    if city.lod < 2 or network is None or not network.edge_count:
        return city
    table = city.layout.roads.iloc[network.edge_road]
    asphalt = road_labels(table["surface"].to_numpy()) == road_labels(["asphalt"])[0]
    flat = ~table["bridge"].to_numpy(bool) & ~table["tunnel"].to_numpy(bool)
    flat &= ~table["passage"].to_numpy(bool) & (table["layer"].to_numpy() == 0)
    street = kerbed_edges(city.layout, network) & flat
    edges = np.flatnonzero(street)
    wide = np.flatnonzero(street & asphalt & (network.half_width >= LEAST_HALF))
    grates = join_places(*(
        places_along(network, edges, side, spacing=gullies, beyond=GULLY_IN, margin=MARGIN)
        for side in (1, -1)
    ))  # fmt: skip
    holes = join_places(*(
        places_along(network, wide, side, spacing=manholes, beyond=-MANHOLE_IN, margin=2 * MARGIN,
                     phase=phase)
        for side, phase in ((1, 0.0), (-1, 0.5))
    ))  # fmt: skip
    ids = [
        hash_ids(0, f"{ACTION}/{name}", network.edge_id[places.edge],
                 2 * places.number + (places.side > 0))
        for name, places in zip(NAMES, (holes, grates), strict=True)
    ]  # fmt: skip
    moved = uniform(city.seed, f"{ACTION}/along", ids[0]) - 0.5
    aside = uniform(city.seed, f"{ACTION}/aside", ids[0]) - 0.5
    reach = np.minimum(SLACK * manholes / 2, 2 * MARGIN - 1.0)
    xy = holes.xy + holes.ahead * (reach * moved)[:, None]
    xy = xy + holes.toward_road * (0.5 * aside)[:, None]
    places = np.concatenate([xy, grates.xy])
    ahead = np.concatenate([holes.ahead, grates.ahead])
    kind = np.repeat([0, 1], [len(xy), len(grates.xy)])
    inside = _inside(places, city.layout.extent)
    return _with_covers(city, places[inside], ahead[inside], kind[inside],
                        np.concatenate(ids)[inside])  # fmt: skip


def _inside(
    xy: NDArray[np.float64], extent: tuple[float, float, float, float]
) -> NDArray[np.bool_]:
    low, high = np.array(extent[:2]), np.array(extent[2:])
    return np.asarray(((xy >= low) & (xy <= high)).all(axis=1))


def _with_covers(
    city: City, xy: NDArray[np.float64], ahead: NDArray[np.float64], kind: NDArray[np.int64],
    ids: NDArray[np.uint64],
) -> City:  # fmt: skip
    """Lay the covers on the slope of the street."""
    height = city.terrain.height_at
    step = 0.3
    rise = height(xy + step * ahead) - height(xy - step * ahead)
    left = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    across = height(xy + step * left) - height(xy - step * left)
    rotation = np.column_stack([
        np.arctan2(across, 2 * step), -np.arctan2(rise, 2 * step),
        np.arctan2(ahead[:, 1], ahead[:, 0]),
    ])  # fmt: skip
    order = np.argsort(ids, kind="stable")
    count = len(order)
    rows = Instances(
        kind[order].astype(np.int32),
        ids[order],
        np.zeros(count, np.uint64),
        np.column_stack([xy, height(xy)])[order],
        rotation[order].astype(np.float32),
        np.ones((count, 3), np.float32),
        np.ones((count, 3), np.float32),
    )
    prototypes = [cover(name) for name in NAMES]
    return replace(city, scene=city.scene.with_instances("street_covers", prototypes, rows))
