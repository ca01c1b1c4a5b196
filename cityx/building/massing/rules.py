"""Rules of massing: what a grammar may do to a volume; `massing.grow` runs them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import shapely
from shapely import affinity

from cityx.building.massing.massing import (
    COURT,
    GRID,
    Mass,
    Plot,
    Rule,
    Successors,
    axes_of,
    carve,
    cut_level,
    pieces,
    site_of,
    stacked,
)


def setback(
    inset: float, share: float, *, then: str, foot: str = "", zone: str | None = None,
    foot_zone: str | None = None, least: float = 9.0,
) -> Rule:  # fmt: skip
    """Draw the upper part of a volume in by `inset` metres, above `share` of its height.

    Nothing happens where the upper part would be narrower than `least` metres.
    """

    def rule(mass: Mass, plot: Plot) -> Successors:
        depth = plot.waver("setback", inset, mass)
        level = cut_level(mass, plot, plot.waver("setback level", share, mass))
        upper = mass.plan.buffer(-depth, join_style="mitre", mitre_limit=3.0)
        if upper.is_empty or upper.buffer(-least / 2).is_empty:
            return ()
        return stacked(mass, level, upper, foot=foot, then=then, zone=zone, foot_zone=foot_zone)

    return rule


def podium(
    storeys: int, cover: float, *, then: str, foot: str = "", zone: str | None = None,
    foot_zone: str = "podium",
) -> Rule:  # fmt: skip
    """Stand a tower that covers a share of the plan on a podium of some storeys."""

    def rule(mass: Mass, plot: Plot) -> Successors:
        axes = axes_of(mass.plan, plot.front)
        level = mass.low + storeys * plot.storey
        if level > mass.high - 2 * plot.storey:
            return ()
        share = math.sqrt(min(max(plot.waver("podium", cover, mass), 0.2), 0.95))
        x, y = 0.5 * share * axes.length, 0.5 * share * axes.width
        room_x, room_y = axes.length / 2 - x, axes.width / 2 - y
        swing = 2 * min(plot.noise, 0.5)
        dx = room_x * (2 * plot.draw("podium x") - 1) * 0.6 * swing
        dy = room_y * (2 * plot.draw("podium y") - 1) * 0.6 * swing
        upper = axes.box(dx - x, dy - y, dx + x, dy + y).intersection(mass.plan.buffer(-0.6))
        return stacked(mass, level, upper, foot=foot, then=then, zone=zone, foot_zone=foot_zone)

    return rule


def light_court(width: float, *, then: str = "", foot: str = "", above: float = 0.0) -> Rule:
    """Leave a court open above `above` metres, with wings `width` metres deep around it."""

    def rule(mass: Mass, plot: Plot) -> Successors:
        court = mass.plan.buffer(-plot.waver("court", width, mass), join_style="mitre")
        court = court.buffer(-0.01)
        if court.area < 25 or court.geom_type != "Polygon":
            return ()
        ring = mass.plan.difference(court)
        if above <= 0:
            return [(then, replace(mass, plan=each)) for each in pieces(ring)]
        return stacked(mass, mass.low + above, ring, foot=foot, then=then)

    return rule


def combed(teeth: int, wing: float, spine: float, *, then: str = "", above: float = 0.0,
           foot: str = "", to_front: bool = True) -> Rule:  # fmt: skip
    """Make an L, U or E of a plan: a spine with wings, courts open to one side.

    Parameters
    ----------
    teeth
        Number of wings: 1 is an L, 2 a U, 3 an E.
    wing, spine
        Metres of their widths.
    above
        Metres below which the plan stays whole.
    to_front
        Whether the courts open to the street.
    """

    def rule(mass: Mass, plot: Plot) -> Successors:
        axes = axes_of(mass.plan, plot.front)
        half_l, half_w = axes.length / 2, axes.width / 2
        across = plot.waver("comb wing", wing, mass)
        back = plot.waver("comb spine", spine, mass)
        gaps = max(teeth - 1, 1)
        room = axes.length - teeth * across
        if room / gaps < 5.0 or axes.width - back < 4.0:
            return ()
        cut = []
        for number in range(gaps):
            x0 = -half_l + (number + 1) * across + number * room / gaps
            y0, y1 = (-half_w + back, half_w + 1) if to_front else (-half_w - 1, half_w - back)
            x1 = x0 + room / gaps + (0 if teeth > 1 else 1)
            cut.append(axes.box(x0, y0, x1, y1))
        upper = mass.plan.difference(shapely.union_all(np.array(cut)))
        if above > 0:
            return stacked(mass, mass.low + above, upper, foot=foot, then=then)
        return [(then, replace(mass, plan=each)) for each in pieces(upper)]

    return rule


def notched(size: float, *, then: str = "") -> Rule:
    """Cut squares of `size` metres from the corners of the plan's box."""

    def rule(mass: Mass, plot: Plot) -> Successors:
        axes = axes_of(mass.plan, plot.front)
        edge = min(plot.waver("notch", size, mass), 0.25 * axes.width)
        if edge < 0.8:
            return ()
        x, y = axes.length / 2, axes.width / 2
        cut = [
            axes.box(min(sx * x, sx * (x - edge)), min(sy * y, sy * (y - edge)),
                     max(sx * x, sx * (x - edge)), max(sy * y, sy * (y - edge)))
            for sx in (-1, 1) for sy in (-1, 1)
        ]  # fmt: skip
        plan = mass.plan.difference(shapely.union_all(np.array(cut)))
        return [(then, replace(mass, plan=each)) for each in pieces(plan)]

    return rule


def sliced(shares: Sequence[float], *, symbols: Sequence[str], heights: Sequence[float] = (),
           zones: Sequence[str] = (), along: bool = True) -> Rule:  # fmt: skip
    """Cut a volume into slices along (or across) its longer side.

    Parameters
    ----------
    shares
        Relative lengths of the slices.
    symbols, heights, zones
        One per slice; heights as shares of the volume's own.
    """

    def rule(mass: Mass, plot: Plot) -> Successors:
        axes = axes_of(mass.plan, plot.front)
        length = axes.length if along else axes.width
        edge = np.concatenate([[0.0], np.cumsum(shares)]) / sum(shares) * length - length / 2
        far = axes.length + axes.width
        found: list[tuple[str, Mass]] = []
        for number, (x0, x1) in enumerate(pairwise(edge)):
            x0 = -far if number == 0 else x0
            x1 = far if number == len(shares) - 1 else x1
            strip = axes.box(x0, -far, x1, far) if along else axes.box(-far, x0, far, x1)
            share = heights[number] if heights else 1.0
            high = mass.high
            if share < 1.0:
                high = mass.low + max(1, round(share * mass.height / plot.storey)) * plot.storey
            zone = zones[number] if zones else mass.zone
            found += [
                (symbols[number], replace(mass, plan=each, high=min(high, mass.high), zone=zone))
                for each in pieces(mass.plan.intersection(strip))
            ]
        return found if len(found) > 1 else ()

    return rule


def bundled(across: int, along: int, *, lowest: float = 0.5, then: str = "") -> Rule:
    """Split a volume into a bundle of tubes of different heights."""

    def rule(mass: Mass, plot: Plot) -> Successors:
        axes = axes_of(mass.plan, plot.front)
        if min(axes.length / along, axes.width / across) < 7.0:
            return ()
        found: list[tuple[str, Mass]] = []
        for number in range(along * across):
            i, j = number % along, number // along
            x, y = axes.length / along, axes.width / across
            x0, y0 = i * x - axes.length / 2, j * y - axes.width / 2
            cell = axes.box(x0, y0, x0 + x, y0 + y)
            share = 1.0 if number == 0 else lowest + (1 - lowest) * plot.draw("tube", number)
            if not plot.noise:
                share = 1.0 if (i + j) % 2 == 0 else (1 + lowest) / 2
            high = mass.low + max(1.0, round(share * mass.height / plot.storey)) * plot.storey
            found += [
                (then, replace(mass, plan=each, high=min(high, mass.high)))
                for each in pieces(mass.plan.intersection(cell))
            ]
        return found if len(found) > 1 else ()

    return rule


def twisted(angle: float, steps: int, *, shrink: float = 1.0, then: str = "") -> Rule:
    """Turn and shrink the plan in steps over the height; each step within the plan itself."""

    def rule(mass: Mass, plot: Plot) -> Successors:
        turn = plot.waver("twist", angle, mass)
        count = min(steps, int(mass.height / plot.storey))
        if count < 2:
            return ()
        middle = mass.plan.centroid
        room = mass.plan.buffer(2 * GRID)
        found: list[tuple[str, Mass]] = []
        levels = [mass.low + round(mass.height * i / count / plot.storey) * plot.storey
                  for i in range(count)] + [mass.high]  # fmt: skip
        for step in range(count):
            share = step / (count - 1)
            size = (1 - share) + share * shrink
            plan = affinity.rotate(mass.plan, turn * share, origin=middle, use_radians=True)
            fit = _fitting(plan, room, middle) if turn else 1.0
            plan = affinity.scale(plan, size * fit, size * fit, origin=middle)
            found += [
                (then, replace(mass, plan=each, low=levels[step], high=levels[step + 1]))
                for each in pieces(plan)
            ]
        return found

    return rule


def _fitting(plan: Any, room: Any, middle: Any) -> float:
    """Return the scale at which a turned plan just fits, by bisection."""
    if room.covers(plan):
        return 1.0
    low, high = 0.0, 1.0
    for _ in range(8):
        half = (low + high) / 2
        fits = room.covers(affinity.scale(plan, half, half, origin=middle))
        low, high = (half, high) if fits else (low, half)
    return low


def stepped(steps: int, depth: float, *, then: str = "", top: str = "") -> Rule:
    """Step a volume back from its front, `depth` metres per step, in terraces."""

    def rule(mass: Mass, plot: Plot) -> Successors:
        axes = axes_of(mass.plan, plot.front)
        back = plot.waver("step", depth, mass)
        count = min(steps, int(mass.height / plot.storey) - 1, int((axes.width - 8.0) / back))
        if count < 1:
            return ()
        far = axes.length + axes.width
        found: list[tuple[str, Mass]] = []
        level = mass.low
        for step in range(count + 1):
            keep = axes.box(-far, -far, far, axes.width / 2 - step * back)
            share = (step + 1) / (count + 1)
            high = mass.low + round(share * mass.height / plot.storey) * plot.storey
            high = mass.high if step == count else high
            found += [
                (top if step == count else then, replace(mass, plan=each, low=level, high=high))
                for each in pieces(mass.plan.intersection(keep) if step else mass.plan)
            ]
            level = high
        return found

    return rule


def crowned(
    inset: float, height: float, *, roof: str = "flat", zone: str = "crown", then: str = ""
) -> Rule:
    """Set a crown on a volume: its top `height` metres on a plan drawn in by `inset`."""

    def rule(mass: Mass, plot: Plot) -> Successors:
        tall = min(plot.waver("crown", height, mass), 0.45 * mass.height)
        level = mass.high - tall
        upper = pieces(mass.plan.buffer(-inset, join_style="mitre") if inset else mass.plan)
        if not upper or tall < 1.0:
            return ()
        rise = 0.0 if roof == "flat" else 0.75 * tall
        below = replace(mass, high=level, roof="flat", rise=0.0)
        tops = [
            (then, replace(mass, plan=each, low=level, zone=zone, roof=roof, rise=rise))
            for each in upper
        ]
        return [("", below), *tops]

    return rule


def banded(
    cuts: Sequence[int],
    *,
    symbols: Sequence[str],
    zones: Sequence[str | None] = (),
    insets: Sequence[float] = (),
) -> Rule:
    """Cut a volume across at floors, into bands from below to above.

    Parameters
    ----------
    cuts
        Storeys from the foot, or from the top where negative; in ascending order of height.
    symbols, zones, insets
        One per band, one more than cuts: None keeps the zone; metres to draw the band's plan in.
    """

    def rule(mass: Mass, plot: Plot) -> Successors:
        storey = plot.storey
        inner = [(mass.low if cut >= 0 else mass.high) + cut * storey for cut in cuts]
        level = [mass.low, *inner, mass.high]
        if np.diff(level).min() < 0.9 * storey:
            return ()
        found: list[tuple[str, Mass]] = []
        for number, symbol in enumerate(symbols):
            inset = insets[number] if insets else 0.0
            zone = zones[number] if zones else None
            plan = mass.plan.buffer(-inset, join_style="mitre") if inset else mass.plan
            last = number == len(symbols) - 1
            found += [
                (
                    symbol,
                    replace(
                        mass, plan=each, low=level[number], high=level[number + 1],
                        zone=mass.zone if zone is None else zone,
                        roof=mass.roof if last else "flat", rise=mass.rise if last else 0.0,
                    ),
                )
                for each in (pieces(plan) if inset else [plan])
            ]  # fmt: skip
        return found

    return rule


def overhung(steps: int, depth: float, *, then: str = "", least: float = 9.0) -> Rule:
    """Widen a volume upwards: the top has the whole plan, each step below is drawn in."""

    def rule(mass: Mass, plot: Plot) -> Successors:
        back = plot.waver("overhang", depth, mass)
        count = min(steps, int(mass.height / plot.storey) - 1)
        while count and mass.plan.buffer(-count * back - least / 2).is_empty:
            count -= 1
        if count < 1:
            return ()
        found: list[tuple[str, Mass]] = []
        level = mass.low
        for step in range(count + 1):
            inset = (count - step) * back
            plan = mass.plan.buffer(-inset, join_style="mitre", mitre_limit=3.0)
            high = mass.low + round((step + 1) / (count + 1) * mass.height / plot.storey) * (
                plot.storey
            )
            high = mass.high if step == count else high
            found += [
                (then, replace(mass, plan=each, low=level, high=high))
                for each in (pieces(plan) if inset else [mass.plan])
            ]
            level = high
        return found

    return rule


def otherwise(rule: Rule, then: str) -> Rule:
    """Follow a rule, or pass the volume on to another symbol where it does not fit."""

    def either(mass: Mass, plot: Plot) -> Successors:
        return rule(mass, plot) or [(then, mass)]

    return either


def courtyard(
    wing: float, *, storeys: int = 1, closed: bool = True, then: str = "", zone: str = "yard"
) -> Rule:
    """Leave a court over its ground floor, with wings around it.

    Parameters
    ----------
    wing
        Metres of depth of the wings.
    storeys
        Of what is built in the court.
    closed
        Whether there are wings on all sides; else the court opens to the back.
    zone
        Look of what is built in the court.
    """

    def rule(mass: Mass, plot: Plot) -> Successors:
        site = site_of(replace(plot, plan=mass.plan))
        x, y = site.half
        deep = plot.waver("court", wing, mass)
        back = deep - y if closed else -2 * y
        if 2 * (x - deep) < COURT or y - deep - max(back, -y) < COURT:
            return ()
        high = mass.low + storeys * plot.storey
        if mass.plan.interiors or high > mass.high - mass.rise - 0.9 * plot.storey:
            return ()
        court, rest = carve(site.plan, shapely.box(deep - x, back, x - deep, y - deep))
        wings = site.masses(rest, mass.low, mass.high, mass.zone, mass.roof, mass.rise)
        low = site.masses(court, mass.low, high, zone)
        return [*((then, each) for each in wings), *(("", each) for each in low)]

    return rule


def chamfered(plan: Any, corner: tuple[float, float], leg: float) -> Any:
    """Cut a corner of a plan off: the triangle whose legs of `leg` metres meet there."""
    x, y = corner
    diamond = [(x + leg, y), (x, y + leg), (x - leg, y), (x, y - leg)]
    return shapely.difference(plan, shapely.Polygon(diamond), grid_size=GRID)
