"""A town without any map: a window of an endless plane."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated

import numpy as np

from cityx.city import City, Goal, Layout
from cityx.errors import ActionFailed, UsageError
from cityx.ids import hash_bits
from cityx.places.profiles import profile_of
from cityx.protocol import Choice, Port, Range, action
from cityx.town.asked_blocks import size_of_blocks
from cityx.town.bounded_town import layout_of_site
from cityx.town.hillside import Land, earth_moved, is_steep, streets_of
from cityx.town.plane import COASTS, PATTERNS, WIDTHS, ZONES, Plan, StreetBounds
from cityx.town.window import layout_of_window, origin_of

FAR = 4e10  # metres; a hundred million districts from the origin
SMALLEST, USUAL, LARGEST = 50.0, 600.0, 20_000.0  # metres of a side
SAID = 0.98  # share of what height files reach over; a town on less of it says so
ANYWHERE = 1.0  # metres of the extent of a city that is still nowhere, at most
WIDEST, LANES = 60.0, 12  # metres of a carriageway, and its lanes
MOST_BLOCKS = 2000
TOLD = 1.0  # metres of earth that streets move at most, from which it is said
# Kinds of area of the height files on which no town stands.
_TAKEN_AS: Mapping[str, str] = {
    "sea": "sea: level at or below 0 m, or void beside low land, and joined to the border",
    "void": "void, without ground; nothing is built there",
}
TAKEN = tuple(_TAKEN_AS)


@action(
    "layout/town-v1",
    limits=["The plane lies nowhere on Earth; roofs and traffic are those of the city's frame."],
    after=("background/driving_side-v1",),
    gives=(Port("layout", "scene_layout"),),
)
def town(
    city: City,
    *,
    x: Annotated[float, Range(-FAR, FAR)] = 0.0,
    y: Annotated[float, Range(-FAR, FAR)] = 0.0,
    width: Annotated[float | None, Range(SMALLEST, LARGEST)] = None,
    depth: Annotated[float | None, Range(SMALLEST, LARGEST)] = None,
    pattern: Annotated[str, Choice(*PATTERNS)] = "mixed",
    density: Annotated[float, Range(0.0, 1.0)] = 0.66,
    radius: Annotated[float, Range(100.0, 3000.0)] = 500.0,
    zone: Annotated[str, Choice("", *ZONES, "semi", "industry")] = "",
    district: Annotated[float, Range(260.0, 900.0)] = 330.0,
    block: Annotated[float, Range(80.0, 220.0)] = 110.0,
    parks: Annotated[float, Range(0.0, 0.5)] = 0.10,
    plazas: Annotated[float, Range(0.0, 1.0)] = 0.7,
    industry: Annotated[float, Range(0.0, 1.0)] = 0.15,
    river: bool = False,
    river_width: Annotated[float, Range(12.0, 60.0)] = 26.0,
    lakes: Annotated[float, Range(0.0, 0.5)] = 0.0,
    coast: Annotated[str, Choice(*COASTS)] = "none",
    shore: Annotated[float, Range(0.0, 5000.0)] = 400.0,
    streets: Annotated[str, Choice(*WIDTHS)] = "usual",
    avenues: Annotated[int, Range(3, 16)] = 6,
    rings: Annotated[int, Range(1, 8)] = 2,
    built: Annotated[float, Range(0.0, 0.8)] = 0.0,
    main_least: Annotated[float, Range(0.0, WIDEST)] = 0.0,
    main_most: Annotated[float, Range(3.0, WIDEST)] = WIDEST,
    main_least_lanes: Annotated[int, Range(1, LANES)] = 1,
    main_most_lanes: Annotated[int, Range(1, LANES)] = LANES,
    local_least: Annotated[float, Range(0.0, WIDEST)] = 0.0,
    local_most: Annotated[float, Range(3.0, WIDEST)] = WIDEST,
    local_least_lanes: Annotated[int, Range(1, LANES)] = 1,
    local_most_lanes: Annotated[int, Range(1, LANES)] = LANES,
    blocks: Annotated[int, Range(0, MOST_BLOCKS)] = 0,
    columns: Annotated[int, Range(0, 100)] = 0,
    rows: Annotated[int, Range(0, 100)] = 0,
    block_width: Annotated[float, Range(0.0, 500.0)] = 0.0,
    block_depth: Annotated[float, Range(0.0, 500.0)] = 0.0,
    turn_deg: Annotated[float, Range(-90.0, 90.0)] = 0.0,
    fitted: bool = False,
    bounded: bool = True,
    variant: Annotated[int, Range(0, 1000)] = 0,
) -> City:
    """Lay out a town by rule, or any other window of the plane that it lies in.

    Parameters
    ----------
    city
        Its seed and frame are kept, its layout is replaced.
    x, y
        Middle of the window in the plane, metres; the first town has its middle at (0, 0).
    width, depth
        Size of the window in east and north direction, metres; 600 when left out, or what the
        height files cover where that is less.
    pattern
        Of the streets; "mixed" gives each district its own. "grid", "radial" and "organic" are one
        over all of a bounded town that has no river, lakes or coast of the plane.
    density
        Of the middle of the town: 0.1 scattered houses, 0.3 rows, 0.6 flats, 1 towers.
    radius
        Metres from the middle of the town to its outskirts.
    zone
        One zone for all of it, or "" to let the density decide.
    district
        Metres between main roads.
    block
        Metres along a block.
    parks
        Share of the blocks' land that is parks.
    plazas
        Share of the dense districts that have a plaza.
    industry
        Share of the outer districts that are industrial.
    river
        Whether a river flows through the town.
    river_width
        Metres of water.
    lakes
        Share of the districts that are lakes.
    coast
        Where the sea lies.
    shore
        Metres from the origin to the sea.
    streets
        How wide streets are: narrow ones have no parked cars, wide ones 13 metres and more.
    avenues
        Of a bounded radial town: how many leave its main square.
    rings
        Of a bounded radial town: how many rings join the avenues.
    built
        Share of the parcels that buildings take; 0 leaves it to the zone.
    main_least, main_most
        Least and greatest metres of the carriageways of main roads, kerb to kerb.
    main_least_lanes, main_most_lanes
        Their lanes, both directions together.
    local_least, local_most
        The same of all other streets.
    local_least_lanes, local_most_lanes
        The same of all other streets.
    blocks, columns, rows
        Of a bounded town with a grid: blocks that its streets enclose, and how many of them from
        west to east and from south to north; 0 for as many as there is room for.
    block_width, block_depth
        Metres of such a block between the walks of its streets, 0 for what is usual.
    turn_deg
        Degrees counter-clockwise by which the grid is turned.
    fitted
        Whether the site is as large as these blocks with their streets, whatever width and depth.
    bounded
        Whether the town ends at its window, which is then exactly that large and cuts no building;
        else a window of the plane, that goes on in the windows beside it.
    variant
        Which of the towns that all of this describes; each is another one.
    """
    plan = Plan(
        pattern, density, radius, district, block, zone, parks, plazas, industry, river,
        river_width, lakes, coast, shore, streets, avenues, rings, built,
        street_bounds("main", (main_least, main_most), (main_least_lanes, main_most_lanes)),
        street_bounds("local", (local_least, local_most), (local_least_lanes, local_most_lanes)),
        blocks, columns, rows, block_width, block_depth, turn_deg,
    )  # fmt: skip
    if plan.asks_for_blocks and not (bounded and pattern == "grid" and plan.is_dry):
        raise UsageError(
            f"Blocks of a number, a size or a direction are laid in a grid; pattern is {pattern}"
            + (", and it has rivers, lakes or a coast of the plane." if not plan.is_dry else ".")
        )
    seed = hash_bits(city.seed, "town", variant) >> 1 if variant else city.seed
    if fitted and plan.asks_for_blocks:
        width, depth = size_of_blocks(plan, seed, (x, y), profile_of(city.frame))
    reach = _reach(city)
    width, depth = _size(reach[0], width), _size(reach[1], depth)
    window = (x - width / 2, y - depth / 2, x + width / 2, y + depth / 2)
    land = _land(city)
    if bounded:
        layout = layout_of_site(window, plan, seed, frame=city.frame, land=land)
    else:
        layout = layout_of_window(window, plan, seed, frame=city.frame)
    origin = origin_of(window)
    notes = city.notes
    if width < SAID * reach[0] or depth < SAID * reach[1]:
        notes = (*notes, f"town: {width:,.0f} x {depth:,.0f} m of the heights, which reach over "
                 f"{_said(city, 0)} x {_said(city, 1)} m")  # fmt: skip
    if origin != (0, 0):
        notes = (*notes, f"town: the scene's origin is the plane's ({origin[0]}, {origin[1]}) m")
    if land is not None:
        notes = (*notes, *_taken_notes(layout), *_slope_notes(layout, land))
    goals = city.goals
    if river:
        goals = (*goals, Goal("a river that is crossed", "n(bridge, over=water) >= 1"))
    goals = (*goals, *_block_goals(plan))
    return replace(
        city, layout=layout, notes=notes, goals=goals, stages_done=city.stages_done | {"layout"}
    )


def street_bounds(of: str, width: tuple[float, float], lanes: tuple[int, int]) -> StreetBounds:
    """Return bounds of the carriageways of "main" or "local" streets.

    Raises
    ------
    UsageError
        If a least is more than its most.
    """
    for name, (least, most) in (("", width), ("_lanes", lanes)):
        if least > most:
            raise UsageError(
                f"{of}_least{name} = {least:g} is more than {of}_most{name} = {most:g}."
            )
    return StreetBounds(*width, *lanes)


def _reach(city: City) -> tuple[float, float]:
    """Return the metres about the origin that height files reach over, 0 without them."""
    xmin, ymin, xmax, ymax = city.layout.extent
    alone = not len(city.layout.roads) + len(city.layout.buildings)
    if xmax - xmin <= ANYWHERE or not alone:
        return 0.0, 0.0
    return 2 * min(-xmin, xmax), 2 * min(-ymin, ymax)


def _land(city: City) -> Land | None:
    """Return what height files say of the land of a town, None without them."""
    if city.survey is None:
        return None
    areas = city.layout.areas
    taken = areas["kind"].isin(TAKEN).to_numpy()
    pairs = zip(areas.geometry.to_numpy()[taken], areas["kind"][taken], strict=True)
    return Land(city.survey.around, tuple(pairs))


def _taken_notes(layout: Layout) -> tuple[str, ...]:
    """Say how much of a town's site is sea, or has no heights."""
    xmin, ymin, xmax, ymax = layout.extent
    areas = layout.areas[layout.areas["source"].str.startswith("heights/").to_numpy(bool)]
    share = areas.geometry.area.groupby(areas["kind"]).sum() / ((xmax - xmin) * (ymax - ymin))
    return tuple(f"heights: {share[kind]:.0%} of the site is {_TAKEN_AS[kind]}"
                 for kind in TAKEN if kind in share)  # fmt: skip


def _slope_notes(layout: Layout, land: Land) -> tuple[str, ...]:
    """Say how much earth the streets of a town move on a slope, and what is too steep to build."""
    if not len(layout.roads):
        return ()
    moved = earth_moved(land.terrain, streets_of(layout))
    if moved.max() < TOLD:
        return ()
    woods = layout.areas.geometry.to_numpy()[(layout.areas["kind"] == "wood").to_numpy(bool)]
    steep = int(is_steep(land.terrain, woods).sum())
    left = f"; {steep} blocks are too steep for houses and wooded" if steep else ""
    return (
        f"town: its streets move up to {np.percentile(moved, 95):.1f} m of earth at 95 % of their "
        f"length, {moved.max():.1f} m at most{left}",
    )


def _size(reach: float, asked: float | None) -> float:
    """Return the metres of a side of a town: as asked, or as far as its height files reach."""
    if asked is not None or not reach:
        return USUAL if asked is None else asked
    if reach < SMALLEST:
        raise ActionFailed(
            f"About the middle of the town the height files reach over {reach:.0f} m; a town takes "
            f"at least {SMALLEST:g} m."
        )
    return min(USUAL, reach)


def _said(city: City, axis: int) -> str:
    return f"{city.layout.extent[axis + 2] - city.layout.extent[axis]:,.0f}"


def _block_goals(plan: Plan) -> tuple[Goal, ...]:
    """Return what blocks that were asked for are measured by."""
    count = plan.blocks or plan.columns * plan.rows
    found = [Goal(f"{count} blocks", f"n(block) == {count}")] if count else []
    if plan.block_width and plan.block_depth:
        sides = sorted((plan.block_width, plan.block_depth))
        found += [
            Goal(f"blocks {side:g} m in {name}",
                 f"stat(block, {name}, p50) in [{0.95 * side:g}, {1.05 * side:g}]")
            for side, name in zip(sides, ("width", "length"), strict=True)
        ]  # fmt: skip
    return tuple(found)
