"""Least and greatest heights and numbers of storeys of all buildings, or of those of a kind."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from cityx.checks.predicates.measuring import rows_of
from cityx.city import City, Layout
from cityx.city.asked_goals import asked
from cityx.city.bounds import CLEAR, is_stated, kept_clear, with_bounds
from cityx.errors import ActionFailed, UsageError
from cityx.geometry.arrays import BoolArray, FloatArray, IntArray
from cityx.ids import uniform
from cityx.protocol import Choice, Port, Range, action
from cityx.town.elements import ELEMENTS
from cityx.town.quarter_kinds import HOUSES
from cityx.town.quarter_kinds import KINDS as QUARTERS
from cityx.town.rebuilding import with_heights

TALLEST = 800.0  # metres
MOST = 200  # storeys
STOREYS = (2.2, 9.0)  # metres that a storey may be high
ROOF = 0.2  # of a bound, that a roof below it takes at most
SHY = 0.35  # share of lowered buildings that stay a storey below what a bound admits
# Kind -> choices of buildings in the language of predicates.
KINDS: Mapping[str, tuple[str, ...]] = MappingProxyType({
    "building": ("building",),
    "house": ("building, type=house", "building, use=house"),
    "tower": ("building, type=tower",),
    "apartment": ("building, use=flats",),
    "office": ("building, use=office",),
    "shop": ("building, use=retail",),
    "factory": ("building, use=industrial",),
    **{name: (QUARTERS[name].chosen,) for name in (*HOUSES, "warehouse")},
    **{name: (one.measure,) for name, one in ELEMENTS.items() if one.building},
})  # fmt: skip


@action(
    "layout/building_limits-v1",
    limits=[
        "Buildings beyond the limits get other storeys and roofs.",
        "What a map states of a building stands.",
    ],
    requires=("layout",),
    after=("layout/height_gradient-v1",),
    takes=(Port("layout", "scene_layout"),),
    gives=(Port("layout", "scene_layout"),),
    labels=("height", "storeys", "floors", "levels", "at least", "at most", "taller", "lower"),
)
def building_limits(
    city: City,
    *,
    kind: Annotated[str, Choice(*KINDS)] = "building",
    least_floors: Annotated[int, Range(1, MOST)] = 1,
    most_floors: Annotated[int, Range(1, MOST)] = MOST,
    lowest: Annotated[float, Range(0.0, TALLEST)] = 0.0,
    highest: Annotated[float, Range(2.5, TALLEST)] = TALLEST,
) -> City:
    """Keep the height and the storeys of every building, or of those of a kind, within limits.

    Parameters
    ----------
    city
        City with buildings.
    kind
        Which buildings.
    least_floors, most_floors
        Storeys above ground.
    lowest, highest
        Metres, roof included. Whatever designs these buildings afterwards keeps them.
    """
    check_floors(least_floors, most_floors)
    if lowest > highest:
        raise UsageError(f"lowest = {lowest:g} m is more than highest = {highest:g} m.")
    if not len(city.layout.buildings):
        raise ActionFailed("There is no building whose height could be limited.")
    chosen = np.zeros(len(city.layout.buildings), bool)
    for choice in KINDS[kind]:
        chosen[rows_of(choice, city)] = True
    stated = chosen & is_stated(city.layout.buildings)
    rows = np.flatnonzero(chosen & ~stated)
    floors, height = (least_floors, most_floors), (lowest, highest)
    city = replace(city, layout=within_limits(city, rows, floors, height))
    city = _with_goals(city, kind, floors, height)
    return _with_note(city, np.flatnonzero(stated), floors, height)


def check_floors(least: int, most: int) -> None:
    """Check that storeys asked for are in order.

    Raises
    ------
    UsageError
        If they are not.
    """
    if least > most:
        raise UsageError(f"least_floors = {least} is more than most_floors = {most}.")


def _with_goals(
    city: City, kind: str, floors: tuple[int, int], height: tuple[float, float]
) -> City:
    whole = ("floors", " floors", floors, (1, MOST)), ("height", " m", height, (0.0, TALLEST))
    for choice in KINDS[kind]:
        for name, unit, (least, most), (none, any_number) in whole:
            if kind != "building":  # where there is none of a kind, none is beyond
                below, above = f"in [0, {least - 1e-3:g}]", f"in [{most + 1e-3:g}, 10000]"
                for end, bound, beyond in ((least, none, below), (most, any_number, above)):
                    if end != bound:
                        words = f"no {kind} {'below' if beyond is below else 'above'} {end:g}{unit}"
                        city = asked(city, words, f"n({choice}, {name} {beyond})", most=0.0)
                continue
            if least > none:
                of = f"stat(building, {name}, min)"
                city = asked(city, f"no building below {least:g}{unit}", of, least=least)
            if most < any_number:
                of = f"stat(building, {name}, max)"
                city = asked(city, f"no building above {most:g}{unit}", of, most=most)
    return city


def _with_note(
    city: City, rows: IntArray, floors: tuple[int, int], height: tuple[float, float]
) -> City:
    """Say which limits the buildings of a map contradict by what it states of them."""
    table = city.layout.buildings.iloc[rows]
    notes = list(city.notes)
    for name, unit, (least, most) in (("levels", "floors", floors), ("height", "m", height)):
        value = table[name].to_numpy(float)
        beyond = value[(value < least) | (value > most)]
        if len(beyond):
            bounds = f"{least:g} to {most:g}" if least else f"at most {most:g}"
            notes.append(
                f"building_limits: {bounds} {unit} are asked, but the map states "
                f"{beyond.min():g} to {beyond.max():g} {unit} for {len(beyond)} buildings; "
                "what it states stands."
            )
    return replace(city, notes=tuple(notes))


def within_limits(
    city: City,
    rows: IntArray,
    floors: tuple[int, int] = (1, MOST),
    height: tuple[float, float] = (0.0, TALLEST),
) -> Layout:
    """Bring buildings within bounds of their storeys and metres, and state these bounds.

    Parameters
    ----------
    rows
        (k,) of the table of buildings.
    floors, height
        Least and greatest.
    """
    layout = city.layout
    table = layout.buildings
    if floors != (1, MOST):
        most = float(floors[1]) if floors[1] < MOST else np.inf
        least = float(floors[0]) if floors[0] > 1 else 0.0
        table = with_bounds(table, rows, "levels", least, most)
    metres = height != (0.0, TALLEST)
    if metres:
        most = height[1] if height[1] < TALLEST else np.inf
        table = with_bounds(table, rows, "height", height[0], most)
    layout = replace(layout, buildings=table)
    levels, old = table["levels"].to_numpy(float)[rows], table["height"].to_numpy(float)[rows]
    if metres:
        shy = uniform(city.seed, "layout/limits", table["id"].to_numpy(np.uint64)[rows]) < SHY
        wanted, new, roof = _sized(levels, old, _roofs(layout)[rows], shy, floors, height)
    else:
        wanted = np.clip(levels, *floors)
        new = old * wanted / np.maximum(levels, 1)
        roof = _roofs(layout)[rows] * wanted / np.maximum(levels, 1)
    changed = (np.abs(new - old) > 1e-9) | (wanted != levels)
    if not changed.any():
        return layout
    layout = with_heights(layout, rows[changed], new[changed], exact=not metres)
    layout = _with_levels(layout, rows[changed], wanted[changed], roof[changed], floors[1])
    _check(layout, rows[changed])
    return layout


def _sized(
    levels: FloatArray, old: FloatArray, roof: FloatArray, shy: BoolArray,
    floors: tuple[int, int], height: tuple[float, float],
) -> tuple[FloatArray, FloatArray, FloatArray]:  # fmt: skip
    """Return storeys, metres and metres of the roof within limits.

    Storeys change before the height of a storey does.

    Parameters
    ----------
    levels, old, roof
        (k,) storeys, metres and metres of the roof before.
    shy
        (k,) which stay a storey below the limit where they must become lower.
    """
    lowest, highest = height
    storey = (old - roof) / np.maximum(levels, 1)
    wanted = np.clip(levels, *floors)
    roof = np.minimum(roof, ROOF * highest)
    fit = np.floor((highest - CLEAR - roof) / storey + 1e-9)
    lowered = np.maximum(fit - (shy & (fit >= 3) & ((fit - 1) * storey + roof >= lowest)), 1)
    wanted = np.where(wanted > fit, np.maximum(lowered, floors[0]), wanted)
    short = wanted * storey + roof < lowest
    wanted = np.where(short, np.minimum(np.ceil((lowest - roof) / storey), floors[1]), wanted)
    new = wanted * storey + roof
    # What storeys of the usual height cannot keep, higher or lower ones do.
    new = np.clip(new, *kept_clear(lowest, highest))
    return wanted, new, np.clip(new - wanted * storey, 0.0, roof)


def _roofs(layout: Layout) -> FloatArray:
    """(n,) metres of the highest roof of each building."""
    roof = np.zeros(len(layout.buildings))
    of = np.searchsorted(layout.buildings["id"].to_numpy(), layout.parts["building"].to_numpy())
    top = layout.parts["top"].to_numpy(float) >= layout.buildings["height"].to_numpy()[of] - 0.01
    np.maximum.at(roof, of[top], layout.parts["roof_height"].to_numpy(float)[top])
    return np.minimum(roof, 0.6 * layout.buildings["height"].to_numpy(float))


def _with_levels(
    layout: Layout, rows: IntArray, wanted: FloatArray, roof: FloatArray, most: int
) -> Layout:
    """Set storeys and roofs of buildings; of several parts none has more storeys than a limit."""
    buildings, parts = layout.buildings.copy(), layout.parts.copy()
    levels = buildings["levels"].to_numpy().copy()
    levels[rows] = wanted
    buildings["levels"] = levels.astype(np.int16)
    own = np.isin(parts["building"].to_numpy(), buildings["id"].to_numpy()[rows])
    single = parts["building"].map(parts["building"].value_counts()).to_numpy() == 1
    of = np.searchsorted(buildings["id"].to_numpy(), parts["building"].to_numpy())
    new = np.where(single, levels[of], np.minimum(parts["levels"].to_numpy(), most))
    parts["levels"] = np.where(own, new, parts["levels"]).astype(np.int16)
    rise = np.zeros(len(buildings))
    rise[rows] = roof
    parts["roof_height"] = np.where(own & single, rise[of], parts["roof_height"])
    return replace(layout, buildings=buildings, parts=parts)


def _check(layout: Layout, rows: NDArray[np.int64]) -> None:
    """Refuse storeys that nobody could build."""
    table = layout.buildings.iloc[rows]
    storey = table["height"].to_numpy() / table["levels"].to_numpy()
    wrong = (storey < STOREYS[0]) | (storey > STOREYS[1])
    if wrong.any():
        worst = int(np.argmax(np.abs(np.log(storey / 3.2))))
        raise ActionFailed(
            f"{wrong.sum()} buildings would get storeys of {storey[worst]:.1f} m; between "
            f"{STOREYS[0]:g} and {STOREYS[1]:g} m are possible. Ask for a height and a number of "
            "floors that suit each other."
        )
