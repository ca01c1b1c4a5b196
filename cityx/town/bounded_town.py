"""A town that ends at its border: one pattern of streets over all of it, no building cut."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from cityx.city import Frame, Layout
from cityx.city.sites import cut_to
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.parcels.blind_streets import BLIND as BLIND_STREET
from cityx.geometry.parcels.blind_streets import CROSS, LENGTH, Net, with_blind_streets
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
from cityx.town import hillside
from cityx.town.asked_blocks import MAIN_EVERY, SMALL, district_of_blocks
from cityx.town.blocks import Blocks, blocks_of
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
from cityx.town.hillside import Land
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


def layout_of_site(
    window: Box, plan: Plan, seed: int, *, frame: Frame, land: Land | None = None
) -> Layout:
    """Make the layout of a town that ends at its border.

    Where streets that know nothing of the land would move more than a few metres of it, they are
    laid out by it.

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
    land
        What is known of the land, in the scene frame, if anything is.
    """
    x, y = origin_of(window)
    box = (window[0] - x, window[1] - y, window[2] - x, window[3] - y)

    def laid_out(features: Tagged) -> Layout:
        return cut_to(resolve(gather(features, box, Report()), frame, seed=seed), box)

    profile = profile_of(frame)
    land = land.within(box) if land else None
    bound = plan.asks_for_blocks or not plan.is_dry  # to what does not follow the land
    if land is None or bound or not land.taken:
        if plan.pattern in WHOLE and plan.is_dry:
            usual = laid_out(_of_one_pattern(window, plan, seed, profile))
        else:
            usual = laid_out(features_of_window(window, plan, seed, profile, halo=0.0))
        if land is None:
            return usual
        if bound or not hillside.cuts_the_hill(usual, land):
            return hillside.without_taken(usual, land)
    return hillside.without_taken(
        laid_out(_of_one_pattern(window, plan, seed, profile, land)), land
    )


def _of_one_pattern(
    window: Box, plan: Plan, seed: int, profile: Profile, land: Land | None = None
) -> Tagged:
    """Return what lies in a site whose streets are one pattern, in the scene frame."""
    plane = Plane(plan, seed, profile)
    x, y = origin_of(window)
    found = Found(np.array([x, y], np.int64) * PER_METRE)
    district = _district(plane, window) if land is None else _by_the_land(plane, window, land)
    add_streets(found, plane, district)
    if land is None:
        blocks = blocks_of(plane, district)
        shapes = found.moved(blocks.shapes, district.sketch.rim.anchor)
    else:
        middle = found.scene(district.sketch.rim.anchor)
        blocks = blocks_of(plane, district, shapely.buffer(land.about(middle).out, hillside.SHORE))
        shapes = found.moved(blocks.shapes, district.sketch.rim.anchor)
        blocks = _green_where_steep(blocks, land, shapes)
    add_land(found, district, blocks, shapes, seed)
    return joined(
        found.tagged(), *buildings_on([(blocks, shapes)], window, (x, y), seed, plan.built)
    )


def _green_where_steep(blocks: Blocks, land: Land, shapes: NDArray[Any]) -> Blocks:
    """Leave blocks green on which no house stands well."""
    steep = hillside.is_steep(land.terrain, shapes) & (blocks.zone != "")
    kind, zone = blocks.kind.copy(), blocks.zone.copy()
    kind[steep], zone[steep] = "wood", ""
    return replace(blocks, kind=kind, zone=zone)


def _district(plane: Plane, window: Box) -> District:
    """Lay out the streets of a site."""
    plan = plane.plan
    if plan.asks_for_blocks:
        return district_of_blocks(plane, window)
    block, depth, _ = SHAPE[plan.pattern]
    low, high = np.array(window[:2]), np.array(window[2:])
    anchor, density, identity, zone = _place(plane, window)
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


def _place(plane: Plane, window: Box) -> tuple[IntArray, float, int, str]:
    """Return the middle of a site, its density, the key of its draws and its zone."""
    low, high = np.array(window[:2]), np.array(window[2:])
    anchor = np.rint((low + high) / 2 * PER_METRE).astype(np.int64)
    density = float(plane.density(anchor[None])[0])
    identity = hash_bits(plane.seed, "site", *SITE)
    return anchor, density, identity, zone_of(plane, identity, density)


def _by_the_land(plane: Plane, window: Box, land: Land) -> District:
    """Lay out the streets of a site by its land.

    Of the patterns that may be, each in several directions, the one that moves the least earth is
    taken; its points slide along the slopes, streets that would still cut the hill are left out,
    and ramps join what falls apart.
    """
    anchor, density, identity, zone = _place(plane, window)
    half = (np.array(window[2:]) - np.array(window[:2])) / 2
    origin = np.array(origin_of(window), np.int64)
    land = land.about(anchor / PER_METRE - origin)
    kind, pattern, sizes = _of_least_earth(plane, half, zone, land)
    grade = _grades(plane, zone, kind, pattern)
    pattern = hillside.slid(pattern, land.terrain, grade, hillside.SLID * min(sizes))
    rim = rim_of_site(anchor, half + BEYOND * max(sizes))
    inside = shapely.contains_xy(rim.polygon(), pattern.nodes)[pattern.links].any(axis=1)
    inside &= ~land.takes(pattern.nodes[pattern.links])
    pattern, grade = pattern.take(inside), grade[inside]
    kept = hillside.without_cuts(pattern, land.terrain, grade)
    pattern, grade = pattern.take(kept), grade[kept]
    beyond = ~shapely.contains_xy(shapely.box(*-half, *half), pattern.nodes)
    pattern = pattern.take(hillside.stubs_gone(pattern.links, pattern.nodes, beyond, LENGTH[0]))
    ramp = hillside.grade_of(local_tags(plane, SITE, zone, kind, hillside.RAMP, 0)["highway"])
    pattern = hillside.joined_by_ramps(pattern, land, ramp, half)
    pattern = _with_main_streets_on(plane, pattern, land, half, zone, kind)
    places = rim.places(pattern.nodes)
    nodes = rim.local(places)
    beyond = ~shapely.contains_xy(shapely.box(*-half, *half), nodes)
    degree = np.bincount(pattern.links.ravel(), minlength=len(nodes))
    leads_out = beyond[pattern.links].any()
    ways_out = beyond if leads_out else np.ones(len(nodes), bool)
    kept = settled(pattern.links, nodes, ways_out, degree == 1)
    net = Net(nodes, pattern.links[kept], pattern.street[kept])
    net, _ = with_blind_streets(
        net, rim.lines(), [np.zeros((0, 2))] * len(rim.sides),
        often=BLIND[kind], least=LEAST_BLIND[zone], blind=zone not in DENSE,
        drawn=lambda k: draw(plane.seed, "site/blind", identity, k),
    )  # fmt: skip
    net = _without_steep_blind_streets(net, land, _grades(plane, zone, kind, net))
    degree = np.bincount(net.links.ravel(), minlength=len(net.nodes))
    ends = np.flatnonzero(
        (degree == 1) & shapely.contains_xy(shapely.box(*-half, *half), net.nodes)
    )
    places = np.concatenate([places, rim.places(net.nodes[len(places) :])])
    sketch = Sketch(rim, kind, zone, density, pattern, no_ways())
    return District(sketch, places, net.links, net.street, ends)


def _of_least_earth(
    plane: Plane, half: FloatArray, zone: str, land: Land
) -> tuple[str, Pattern, tuple[float, float]]:
    """Return the kind and the pattern that move the least earth of those that may be laid."""
    asked = plane.plan.pattern
    kinds = ("grid", "organic") if asked not in WHOLE else (asked,)
    turns = (
        hillside.along_contours(land.terrain, half)
        + np.pi / 2 * np.arange(hillside.DIRECTIONS) / hillside.DIRECTIONS
    )
    tried = []
    for kind in kinds:
        block, depth, _ = SHAPE[kind]
        larger = plane.plan.block * SPARSE.get(zone, 1.0)
        sizes = (block * larger, depth * larger)
        for turn in turns.tolist() if kind != "radial" else [0.0]:
            pattern = _pattern_of(plane, kind, half, sizes, turn)
            inner = (np.abs(pattern.nodes) <= half).all(axis=1)[pattern.links].all(axis=1)
            net = hillside.Links(
                pattern.nodes, pattern.links[inner],
                _grades(plane, zone, kind, pattern.take(inner)),
            )  # fmt: skip
            earth = hillside.earth_moved(land.terrain, net)
            tried.append(
                (float(np.percentile(earth, 95)) if len(earth) else 0.0, kind, pattern, sizes)
            )
    _, kind, pattern, sizes = min(tried, key=lambda one: one[0])
    return kind, pattern, sizes


def _pattern_of(
    plane: Plane, kind: str, half: FloatArray, sizes: tuple[float, float], turn: float
) -> Pattern:
    """Lay local streets of a kind about the middle of a site and beyond it, turned."""
    if kind == "radial":
        plan = plane.plan
        return radial(
            (float(half[0]), float(half[1])), sizes, avenues=plan.avenues, rings=plan.rings
        )
    reach = half + BEYOND * max(sizes)
    box = (float(-reach[0]), float(-reach[1]), float(reach[0]), float(reach[1]))
    if kind == "grid":
        return divided(grid(box, np.zeros(2), turn, sizes))
    seed = hash_bits(plane.seed, "site/streets", *SITE) >> 1
    return divided(winding(box, seed, pitch=float(np.sqrt(sizes[0] * sizes[1])), angle=turn))


def _grades(plane: Plane, zone: str, kind: str, streets: Pattern | Net) -> FloatArray:
    """Return the greatest grade of each link, (m,)."""
    named, of = np.unique(streets.street, axis=0, return_inverse=True)
    own = [
        hillside.grade_of(local_tags(plane, SITE, zone, kind, family, line)["highway"])
        for family, line in named.tolist()
    ]
    return np.asarray(np.array(own)[of.ravel()], float)


def _with_main_streets_on(
    plane: Plane, pattern: Pattern, land: Land, half: FloatArray, zone: str, kind: str
) -> Pattern:
    """Make main streets of the shortest ways out, where their grades hold without more earth."""
    if _is_small(half) or kind == "radial" or not len(pattern.links):
        return pattern
    found = with_main_streets(pattern, MAIN_LINE, count=MAIN_WAYS, reach=float(np.hypot(*half)))
    street = found.street.copy()
    for line in range(MAIN_WAYS):
        tried = np.where((found.street == (MAIN_LINE, line)).all(axis=1)[:, None], found.street, pattern.street)  # fmt: skip  # noqa: E501
        grade = _grades(plane, zone, kind, replace(pattern, street=tried))
        net = hillside.Links(pattern.nodes, pattern.links, grade)
        if hillside.earth_moved(land.terrain, net).max() > hillside.MOVED:
            own = (street == (MAIN_LINE, line)).all(axis=1)
            street[own] = pattern.street[own]
    return replace(pattern, street=street)


def _without_steep_blind_streets(net: Net, land: Land, grade: FloatArray) -> Net:
    """Leave out streets into blocks that would cut the hill, or that end in water."""
    earth = hillside.earth_moved(land.terrain, hillside.Links(net.nodes, net.links, grade))
    bad = (earth > hillside.CUT) | land.takes(net.nodes[net.links])
    new = np.isin(net.street[:, 0], (BLIND_STREET, CROSS))
    gone = np.unique(net.street[bad & new], axis=0)
    kept = ~(net.street[:, None] == gone).all(axis=2).any(axis=1) if len(gone) else ~(bad & new)
    return Net(net.nodes, net.links[kept], net.street[kept])


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
