"""Carriageways, walks, paths and tracks of one tier of structures as regions of its deck."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city.ground import KERB_WIDTH, LABEL, SURFACES
from cityx.city.layout import Layout
from cityx.city.roads import RoadNetwork
from cityx.city.terrain import Terrain
from cityx.geometry.polylines import to_linestrings
from cityx.ground.arrangement import Regions, join_regions, regions
from cityx.places.painting import Painting
from cityx.road.ground.landcover import rail_strips
from cityx.road.heights.structure_tiers import CEILING, PARAPET_FROM, STORY, Tier, heights_on
from cityx.road.network.stations import RAILS
from cityx.road.surface.carriageway import FINE, MITRE
from cityx.road.surface.carriageway_regions import STONE, plain_carriageways
from cityx.road.surface.street_surfaces import street_regions

Shapes = NDArray[Any]

ISLAND = 150.0  # square metres; a larger hole in a deck stays open
PAST = 0.6  # metres past the end of a deck that its kerbs could reach


def tier_regions(layout: Layout, part: Tier, detail: bool, painting: Painting) -> Regions:
    """Return the surfaces of a tier, made as those of the ground are.

    Parameters
    ----------
    layout
        The city's.
    part
        The tier.
    detail
        Whether to lay kerbs, walks and markings; else plain strips.
    painting
        What the country paints.
    """
    sub = part.network
    found = [_other_regions(layout, part)]
    if sub.edge_count:
        if detail:
            found += [street_regions(layout, sub, painting)[0], _shoulders(sub)]
        else:
            found.append(plain_carriageways(layout, sub, np.ones(sub.edge_count, bool)))
    return join_regions([*found, _islands(found), _ends(part)])


def open_wells(found: Regions, part: Tier, network: RoadNetwork) -> Regions:
    """Cut away lawns of large islands under which a carriageway passes.

    Parameters
    ----------
    found
        The surfaces of the tier.
    part
        The tier.
    network
        The whole city's, with heights.

    Returns
    -------
    found
        The same regions, those lawns labelled as void.
    """
    lawn = np.flatnonzero((found.label == LABEL["grass"]) & (shapely.area(found.polygons) > ISLAND))
    if not len(lawn):
        return found
    polygons = found.polygons[lawn]
    shapes = to_linestrings(network.lines)
    well, edge = shapely.STRtree(shapes).query(polygons, predicate="intersects")
    lowest = np.minimum.reduceat(network.z, network.point_start[:-1])
    height = heights_on(part, shapely.get_coordinates(shapely.point_on_surface(polygons)))
    rows = lawn[np.unique(well[lowest[edge] < height[well] - STORY])]
    label = found.label.copy()
    label[rows] = LABEL["void"]  # at a lawn's priority: carriageways that cross it stay
    return replace(found, label=label)


def _islands(found: list[Regions]) -> Regions:
    """Pave what surfaces leave open between them, up to the size of a traffic island."""
    shapes = np.concatenate([part.polygons for part in found])
    whole = shapely.unary_union(shapely.make_valid(shapes))
    rings = shapely.get_rings(shapely.get_parts(whole))
    inner = shapely.polygons(rings[~shapely.is_ccw(rings)])
    return regions(inner[shapely.area(inner) < ISLAND], LABEL["sidewalk"], 0)


def _ends(part: Tier) -> Regions:
    """Return what lies past the ends of ways, where kerbs run across them: it is cut away."""
    lines = part.lines
    count, cars = lines.count, part.network.edge_count
    foot = np.concatenate([lines.start[:-1], lines.start[1:] - 1])
    inward = np.concatenate([lines.start[:-1] + 1, lines.start[1:] - 2])
    place = np.unique(np.rint(lines.points[foot] * 1000), axis=0, return_inverse=True)[1].ravel()
    for side in (0, 1):
        place[side * count : side * count + cars] = -1 - part.network.edge_nodes[:, side]
    _, which, often = np.unique(place, return_inverse=True, return_counts=True)
    alone = np.flatnonzero(often[which] == 1)
    at = lines.points[foot[alone]]
    out = at - lines.points[inward[alone]]
    out /= np.maximum(np.hypot(*out.T), 1e-9)[:, None]
    across = np.column_stack([-out[:, 1], out[:, 0]])
    across *= (part.reach[lines.line_of_point()[foot[alone]]] + 1.0)[:, None]
    past = at + PAST * out
    ring = np.stack([at - across, at + across, past + across, past - across], axis=1)
    return regions(shapely.polygons(ring), LABEL["void"], SURFACES[LABEL["void"]].priority)


def _shoulders(sub: RoadNetwork) -> Regions:
    """Lay a band of kerb stones along carriageways without walks, for the parapets to stand on."""
    lines = shapely.simplify(to_linestrings(sub.lines), FINE)
    reach = sub.half_width + 2 * KERB_WIDTH
    bands = shapely.buffer(lines, reach, cap_style="flat", join_style="mitre", mitre_limit=MITRE)
    return regions(shapely.unary_union(bands), LABEL["kerb"], 1)


def _other_regions(layout: Layout, part: Tier) -> Regions:
    """Return paths and tracks."""
    other = part.others
    if not other.count:
        return Regions()
    kind = layout.roads["kind"].to_numpy().astype(str)[other.road]
    ids = layout.roads["id"].to_numpy()[other.road]
    surface = layout.roads["surface"].to_numpy().astype(str)[other.road]
    lines = shapely.simplify(to_linestrings(other.lines), FINE)
    bands = shapely.buffer(lines, other.half_width, cap_style="flat", join_style="mitre",
                           mitre_limit=MITRE)  # fmt: skip
    rails = np.isin(kind, RAILS)
    stone = np.isin(surface, STONE) | (kind == "steps") | (kind == "pedestrian")
    label = np.select([rails, stone], [LABEL["railway"], LABEL["sidewalk"]], LABEL["path"])
    found = [regions(bands, label, SURFACES[LABEL["path"]].priority, ids)]
    if rails.any():
        found.append(regions(rail_strips(lines[rails]), LABEL["rail"], 60))
    return join_regions(found)


def streets_above(part: Tier, terrain: Terrain, beside: Shapes) -> Regions:
    """Return where streets at the rim of open cuttings keep their ground: no walk lies there.

    Parameters
    ----------
    part
        The tier.
    terrain
        The city's.
    beside
        Polygons of the carriageways on the ground, scene frame, metres.
    """
    lines, lift = part.lines, part.z - terrain.height_at(part.lines.points)
    owner = lines.line_of_point()
    roofed = (part.level[owner] < 0) & (lift < -(part.room + CEILING)[owner])
    deep = (lift < -PARAPET_FROM) & ~roofed
    first = np.flatnonzero((owner[1:] == owner[:-1]) & deep[1:] & deep[:-1])
    runs = shapely.linestrings(np.stack([lines.points[first], lines.points[first + 1]], axis=1))
    cut = shapely.buffer(runs, part.reach[owner[first]] + 2 * KERB_WIDTH, cap_style="flat")
    one, other = shapely.STRtree(beside).query(cut, predicate="intersects")
    shapes = shapely.get_parts(shapely.intersection(cut[one], beside[other]))
    shapes = shapes[shapely.get_dimensions(shapes) == 2]
    label = LABEL["void"]
    return regions(shapes, label, SURFACES[LABEL["carriageway"]].priority - 1)
