"""A town that ends at its border: one pattern of streets over all of it, no building cut."""

from __future__ import annotations

import numpy as np
import shapely

from cityx.city import Frame, Layout
from cityx.city.sites import cut_to
from cityx.geometry.arrays import FloatArray
from cityx.geometry.parcels.blind_streets import Net, with_blind_streets
from cityx.geometry.parcels.lattice import PER_METRE
from cityx.geometry.parcels.street_fit import no_ways, settled
from cityx.geometry.parcels.street_patterns import Pattern, curved, divided, grid
from cityx.geometry.parcels.winding_patterns import radial, winding, with_main_streets
from cityx.ids import draw, hash_bits
from cityx.places.profile import Profile
from cityx.places.profiles import profile_of
from cityx.sources.features.gather import gather
from cityx.sources.features.resolve import resolve
from cityx.sources.features.tagged import Report, Tagged, joined
from cityx.town.asked_blocks import MAIN_EVERY, SMALL, district_of_blocks
from cityx.town.blocks import blocks_of
from cityx.town.districts import (
    BLIND,
    DENSE,
    LEAST_BLIND,
    SHAPE,
    SPARSE,
    District,
    Sketch,
    left_out,
    zone_of,
)
from cityx.town.plane import Plan, Plane
from cityx.town.procedural_streets import MAIN_LINE, half_width, local_tags
from cityx.town.rims import SITE, rim_of_site
from cityx.town.window import (
    Box,
    Found,
    add_land,
    add_streets,
    buildings_on,
    features_of_window,
    origin_of,
)

WHOLE = ("grid", "radial", "organic")  # patterns that are one over all of a site
BEYOND = 1.5  # blocks beyond the border of a site that are laid out, so that those on it are whole
GAPS = 0.03  # share of the links of a grid that are left out
WAVE, REACH = 1.5, 0.16  # of a block, of the waves of winding streets and how far they swing
MAIN_WAYS = 5  # main streets that lead out of the middle of a town of winding streets


def layout_of_site(window: Box, plan: Plan, seed: int, *, frame: Frame) -> Layout:
    """Make the layout of a town that ends at its border.

    Parameters
    ----------
    window
        (xmin, ymin, xmax, ymax) in the plane, metres; the site is exactly that.
    plan
        What is asked of the town. A pattern of `WHOLE` is one over all of the site, unless rivers,
        lakes or a coast of the plane are asked for, which follow districts.
    seed
        Key of every draw.
    frame
        Where on Earth the plane is taken to lie.
    """
    x, y = origin_of(window)
    box = (window[0] - x, window[1] - y, window[2] - x, window[3] - y)
    whole = plan.pattern in WHOLE and plan.is_dry
    if whole:
        features = _of_one_pattern(window, plan, seed, profile_of(frame))
    else:
        features = features_of_window(window, plan, seed, profile_of(frame), halo=0.0)
    return cut_to(resolve(gather(features, box, Report()), frame, seed=seed), box)


def _of_one_pattern(window: Box, plan: Plan, seed: int, profile: Profile) -> Tagged:
    """Return what lies in a site whose streets are one pattern, in the scene frame."""
    plane = Plane(plan, seed, profile)
    x, y = origin_of(window)
    found = Found(np.array([x, y], np.int64) * PER_METRE)
    district = _district(plane, window)
    add_streets(found, plane, district)
    blocks = blocks_of(plane, district)
    land = found.moved(blocks.shapes, district.sketch.rim.anchor)
    add_land(found, district, blocks, land, seed)
    return joined(found.tagged(), *buildings_on([(blocks, land)], window, (x, y), seed, plan.built))


def _district(plane: Plane, window: Box) -> District:
    """Lay out the streets of a site."""
    plan = plane.plan
    if plan.asks_for_blocks:
        return district_of_blocks(plane, window)
    block, depth, _ = SHAPE[plan.pattern]
    low, high = np.array(window[:2]), np.array(window[2:])
    anchor = np.rint((low + high) / 2 * PER_METRE).astype(np.int64)
    density = float(plane.density(anchor[None])[0])
    identity = hash_bits(plane.seed, "site", *SITE)
    zone = zone_of(plane, identity, density)
    larger = plan.block * SPARSE.get(zone, 1.0)
    sizes = (block * larger, depth * larger)
    half = (high - low) / 2
    ringed = plan.pattern == "grid" and _is_small(half)
    rim = rim_of_site(anchor, half if ringed else half + BEYOND * max(sizes))
    pattern = _pattern(plane, half, sizes, zone)
    inside = shapely.contains_xy(rim.polygon(), pattern.nodes)
    pattern = pattern.take(inside[pattern.links].any(axis=1))
    if plan.pattern == "grid" and not ringed:
        gap = left_out(plane, identity, pattern, GAPS) & (pattern.street[:, 0] != MAIN_LINE)
        pattern = pattern.take(~gap)
    places = rim.places(pattern.nodes)
    nodes = rim.local(places)
    loose = ~shapely.contains_xy(shapely.box(*-half, *half), nodes)
    if not loose[pattern.links].any():  # no street leaves the site
        loose[:] = True
    kept = settled(pattern.links, nodes, loose, loose)
    net = Net(nodes, pattern.links[kept], pattern.street[kept])
    net, ends = with_blind_streets(
        net, rim.lines(), [np.zeros((0, 2))] * len(rim.sides),
        often=BLIND[plan.pattern], least=LEAST_BLIND[zone], blind=zone not in DENSE,
        drawn=lambda k: draw(plane.seed, "site/blind", identity, k),
    )  # fmt: skip
    sketch = Sketch(rim, plan.pattern, zone, density, pattern, no_ways())
    places = np.concatenate([places, rim.places(net.nodes[len(places) :])])
    return District(sketch, places, net.links, net.street, ends)


def _pattern(plane: Plane, half: FloatArray, sizes: tuple[float, float], zone: str) -> Pattern:
    """Lay the streets of a site about its middle."""
    plan = plane.plan
    if plan.pattern == "radial":
        return radial(
            (float(half[0]), float(half[1])), sizes, avenues=plan.avenues, rings=plan.rings
        )
    reach = half + BEYOND * max(sizes)
    box = (float(-reach[0]), float(-reach[1]), float(reach[0]), float(reach[1]))
    small = _is_small(half)
    if plan.pattern == "grid":
        found = _street_grid(
            half,
            box,
            sizes,
            half_width(local_tags(plane, SITE, zone, "grid", 0, 0), plane.profile)
            if small
            else 0.0,
        )
        return divided(found if small else _with_main_lines(found))
    seed = hash_bits(plane.seed, "site/streets", *SITE) >> 1
    pitch = float(np.sqrt(sizes[0] * sizes[1]))
    found = winding(box, seed, pitch=pitch, angle=plane.lattice.angle)
    if not small:
        found = with_main_streets(found, MAIN_LINE, count=MAIN_WAYS, reach=float(np.hypot(*half)))
    return curved(found, seed, wave=WAVE * pitch, reach=REACH * pitch)


def _is_small(half: FloatArray) -> bool:
    return bool(2 * half.min() < SMALL)


def _street_grid(half: FloatArray, box: Box, sizes: tuple[float, float], edge: float) -> Pattern:
    """Lay a grid of which whole blocks fill the site.

    Parameters
    ----------
    edge
        Metres from the border to the streets all round; 0 for none, the border running through
        the middle of blocks.
    """
    inner = 2 * (half - edge)
    counts = np.maximum(np.rint(inner / sizes), 1)
    size = inner / counts
    odd = (counts % 2 == 1) != (edge > 0)
    found = grid(box, np.where(odd, 0.0, size / 2), 0.0, (float(size[0]), float(size[1])))
    if not edge:
        return found
    ends = np.abs(found.nodes[found.links]) <= inner / 2 + 1e-6
    return found.take(ends.all(axis=(1, 2)))


def _with_main_lines(pattern: Pattern) -> Pattern:
    """Make every so many lines of a grid main streets."""
    family, line = pattern.street.T
    main = line % MAIN_EVERY == 0
    street = pattern.street.copy()
    street[main] = np.column_stack([np.full(main.sum(), MAIN_LINE), 2 * line[main] + family[main]])
    return Pattern(pattern.nodes, pattern.links, street, pattern.name)
