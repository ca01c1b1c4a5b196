"""Art deco houses: flats and shops of the nineteen-thirties, streamlined, zigzag or stepped."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, Any

import shapely

from cityx.building.generators import action_of, generator
from cityx.building.massing.massing import Mass, Plot, Site, carve, disc, site_of
from cityx.protocol import Choice, Range

FORMS = ("streamline", "zigzag", "stepped")
HANDS = ("both", "left", "right")  # corners of the front that are round
LEAST = 7.5  # metres of front and depth under which a house is one plain body
CUT = 0.012  # of the plan, that a rounded or stepped corner may take
FACETS = 16  # sides of the drum that a rounded corner belongs to
TIGHT, SMALL = 3.2, 2.2  # metres of radius under which it has fewer of them, or is square
ROUNDED = 0.204  # of a square, that a quarter of such a drum leaves out
STAIRS = 3.6  # metres of depth of the bay that stands up in the front
NARROW = 14.0  # metres of front under which the parapet rises in one step
TERRACED = 0.7  # share of high houses with a top storey drawn in
JOINT = 0.12  # metres by which upper walls stand behind those below
TALL = 1.3  # storeys of the ground floor of stepped houses
SCREEN = 0.9  # metres of depth of the front wall that stands up as a parapet


def masses(
    plot: Plot,
    *,
    form: Annotated[str, Choice("any", *FORMS)] = "any",
    corner: Annotated[float, Range(0.0, 8.0)] = 4.5,
    parapet: Annotated[float, Range(0.6, 2.0)] = 1.1,
    attic: Annotated[float, Range(0.5, 5.0)] = 2.4,
) -> tuple[Mass, ...]:
    """Build art deco houses of three to ten storeys.

    Streamlined ones turn rounded corners in bands of steel windows under eyebrows and speed lines,
    with stairs behind glass blocks; zigzag ones rise in pilasters and gilt chevrons to a stepped
    parapet with a sunburst; stepped ones draw in at their corners below a pylon.

    Round the corners of a house, step its parapet, or step its corners and its top storey.

    Parameters
    ----------
    form
        Which kind of art deco.
    corner
        Metres of the radius of rounded corners; stepped ones follow it.
    parapet
        Metres of a step of the parapet.
    attic
        Metres that the top storey of a high house stands back.
    """
    site = site_of(plot)
    x, y = site.half
    if (
        plot.said or plot.levels < 2 or min(2 * x, 2 * y) < LEAST
        or plot.plan.area < 2.4 * x * y
    ):  # fmt: skip
        return (plot.body,)
    word = plot.pick("deco form", FORMS, (5, 4, 3)) if form == "any" else form
    if word == "streamline":
        found = _streamlined(site, plot, corner, parapet, attic)
    elif word == "zigzag":
        found = _zigzag(site, plot, parapet)
    else:
        found = _stepped(site, plot, corner, attic)
    return tuple(found)


def _streamlined(
    site: Site, plot: Plot, corner: float, parapet: float, attic: float
) -> Sequence[Mass]:
    """Round corners of the front, raise the stairs between them, draw in the top storey."""
    x, y = site.half
    eave = plot.height - plot.rise
    round_ = plot.between("radius", 0.8, 1.2) * corner
    radius = min(round_, _leg(plot, ROUNDED), 0.4 * x, 0.7 * y)
    hands = plot.pick("hands", HANDS, (3, 2, 2)) if plot.noise else "both"
    rest: Any = site.plan
    found: list[Mass] = []
    for hand, other in ((-1.0, "right"), (1.0, "left")):
        x0, x1 = sorted((hand * x, hand * (x - radius)))
        square = shapely.box(x0, y - radius, x1, y)
        if hands == other or radius < SMALL or (site.plan & square).area < 0.97 * square.area:
            continue
        drum = disc(hand * (x - radius), y - radius, radius, FACETS if radius > TIGHT else 12)
        inside, rest = carve(rest, square)
        found += site.masses(inside & drum, 0.0, eave, "drum")
        found += site.masses(_within(inside & drum), eave, eave + 0.9 * parapet, "lip")
    wide = min(max(0.13 * 2 * x, 2.6), 3.4)
    if 2 * x - 2 * radius > 2.6 * wide:
        middle = {"both": 0.0, "left": 0.22 * x, "right": -0.22 * x}[hands]
        tower = shapely.box(middle - wide / 2, y - STAIRS, middle + wide / 2, 2 * y)
        stair, rest = carve(rest, tower)
        found += site.masses(stair, 0.0, eave, "stair")
        found += site.masses(_within(stair), eave, eave + 2.4 * parapet, "head")
    level = eave - plot.storey
    room = shapely.box(attic - x, -2 * y, x - attic, y - attic)
    upper = shapely.intersection(_within(rest), room)
    low = plot.levels < 4 or min(2 * x, 2 * y) < 2 * attic + LEAST or upper.area < 40.0
    if low or plot.draws("attic", 1)[0] >= TERRACED:
        return [*found, *site.masses(rest, 0.0, eave)]
    found += site.masses(rest, 0.0, level)
    return [*found, *site.masses(upper, level, eave, "attic")]


def _within(plan: Any) -> Any:
    """Draw a plan in by a joint: walls that stand on one another lie in no common plane."""
    return shapely.buffer(plan, -JOINT, join_style="mitre")


def _leg(plot: Plot, lost: float) -> float:
    """Return the longest corner, metres, of which this share of its square may be cut off."""
    return math.sqrt(CUT * plot.plan.area / lost)


def _zigzag(site: Site, plot: Plot, parapet: float) -> Sequence[Mass]:
    """Raise the parapet of the front in steps to its middle."""
    x, y = site.half
    eave = plot.height - plot.rise
    share = plot.between("middle", 0.26, 0.36)
    edges = [-1.0, -share - 0.24, -share, share, share + 0.24, 1.0]
    steps: tuple[float, ...] = (0.6, 1.2, 2.4, 1.2, 0.6)
    if 2 * x < NARROW:
        edges, steps = [-1.0, -0.4, 0.4, 1.0], (0.7, 2.0, 0.7)
    rest: Any = site.plan
    found: list[Mass] = []
    crest = _within(site.plan) & shapely.box(-2 * x, y - SCREEN, 2 * x, 2 * y)
    for number, (a, b) in enumerate(pairwise(edges)):
        x0 = -2 * x if number == 0 else a * x
        x1 = 2 * x if number == len(steps) - 1 else b * x
        strip = shapely.box(x0, -2 * y, x1, 2 * y)
        middle = 2 * number == len(steps) - 1
        if middle:
            front, rest = carve(rest, strip & shapely.box(-2 * x, y - STAIRS, 2 * x, 2 * y))
            found += site.masses(front, 0.0, eave, "middle")
        top = eave + steps[number] * parapet
        found += site.masses(crest & strip, eave, top, "crown" if middle else "crest")
    return [*found, *site.masses(rest, 0.0, eave, "clad")]


def _stepped(site: Site, plot: Plot, corner: float, attic: float) -> Sequence[Mass]:
    """Step the corners of the front in plan, and set a pylon on a top storey drawn in."""
    x, y = site.half
    eave, storey = plot.height - plot.rise, plot.storey
    step = min(0.36 * corner, 0.1 * x, 0.2 * y)
    plan: Any = site.plan
    for hand in (-1.0, 1.0):
        for far, near in ((2.0, 1.0), (1.0, 2.0)):
            x0, x1 = sorted((2 * hand * x, hand * (x - far * step)))
            plan = shapely.difference(plan, shapely.box(x0, y - near * step, x1, 2 * y))
    plan = _within(plan)
    shops = TALL * storey
    found = site.masses(site.plan, 0.0, shops, "shops")
    deep = min(0.3 * x, 0.3 * y, 3.6)
    room = shapely.box(1.4 * attic - x, attic - y, x - 1.4 * attic, y - attic - step)
    upper = shapely.intersection(plan, room)
    if plot.levels < 4 or upper.area < 60.0 or deep < 2.0:
        return [*found, *site.masses(plan, shops, eave, "bays")]
    found += site.masses(plan, shops, eave - storey, "bays")
    front = y - attic - step
    pylon, rest = carve(upper, shapely.box(-deep, front - 2 * deep, deep, 2 * y))
    found += site.masses(rest, eave - storey, eave, "penthouse")
    return [*found, *site.masses(pylon, eave - storey, eave + 0.8 * storey, "pylon")]


GENERATOR = generator(masses)
art_deco = action_of("building/art_deco-v1", GENERATOR, masses)
