"""Planning: legal shots of a kind, one after the other, as many as are asked for."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from cityx.city.environment import Environment
from cityx.dataset.plans.aerial import aerial
from cityx.dataset.plans.custom import read_plan
from cityx.dataset.plans.drive import drive
from cityx.dataset.plans.orbit import orbit
from cityx.dataset.plans.plan_site import Site, Wishes
from cityx.dataset.plans.street import street
from cityx.dataset.plans.takes import Refusal, Source, Take
from cityx.dataset.plans.views import judged
from cityx.dataset.plans.walk import walk
from cityx.dataset.rigs import Rig, mounted, rig_named
from cityx.dataset.shots import Shot
from cityx.errors import CityxError, InputError, UsageError, nearest
from cityx.geometry.arrays import IntArray
from cityx.ids import hash_bits

if TYPE_CHECKING:
    from cityx.city.city import City
    from cityx.dataset.stage import Stage

MOST_STILLS, MOST_SEQUENCES, LONGEST = 10**6, 10**4, 10**4  # that names can count
BLOCK = 64, 4  # candidates that are looked at together, of stills and of sequences
HOPE = 400, 120  # candidates in a row, of stills and of sequences, after which a plan is given up


@dataclass(frozen=True)
class Kind:
    """A kind of plan.

    Attributes
    ----------
    source
        Makes the source of its candidates; raises where the city has none.
    length
        Frames of a sequence when none are asked for; 1 are single views.
    sequences
        Whether it can make sequences.
    meaning
        What it shows, in a few words.
    """

    source: Callable[[Site], Source]
    length: int
    sequences: bool
    meaning: str


KINDS: Mapping[str, Kind] = MappingProxyType({
    "street": Kind(street, 1, False, "at eye level on pavements and at kerbs, all over the city"),
    "walk": Kind(walk, 40, True, "sequences of pedestrians on their way"),
    "drive": Kind(drive, 40, True, "sequences of cars along the lanes"),
    "aerial": Kind(aerial, 1, True, "from drones, aslant and straight down; flights as sequences"),
    "orbit": Kind(orbit, 36, True, "once round a building, always looking at it"),
})  # fmt: skip


@dataclass(frozen=True)
class Plan:
    """Shots, and what was tried for them.

    Attributes
    ----------
    shots
        In the order of their names.
    tried
        Candidates that were looked at.
    refused
        Reason to how many candidates were refused for it.
    """

    shots: tuple[Shot, ...]
    tried: int
    refused: Mapping[str, int]


def plan(
    city: City,
    name: str,
    count: int | None,
    size: tuple[int, int],
    *,
    seed: int = 0,
    rig: str = "mono",
    length: int | None = None,
    rate: float = 10.0,
    hfov: float | None = None,
    weathers: Sequence[str] = (),
    times: Sequence[str] = (),
    target: str = "tallest",
    radius: float | None = None,
    height: float | None = None,
    stage: Stage | None = None,
    within: tuple[float, float, float, float] | None = None,
    origin: tuple[float, float] = (0.0, 0.0),
) -> Plan:
    """Plan shots of a city.

    Candidates are numbered; each depends on its number and the seed alone, and those that may not
    be are passed over. So a shot is the same however many are asked for, and by whichever process.

    Parameters
    ----------
    city
        A built city.
    name
        One of `KINDS`, or a JSON file as of `cityx.dataset.plans.custom`.
    count
        Poses; every camera of the rig takes a picture from each. None takes all of a file.
    size
        Of the pictures, (width, height) pixels.
    seed
        Of all that is drawn.
    rig
        As of `cityx.dataset.rigs.rig_named`.
    length
        Frames of a sequence; that of the kind when None.
    rate
        Frames per second of sequences.
    hfov
        Horizontal field of view, radians; that of the kind when None.
    weathers, times
        As of `cityx.light.weather.lit_anew`; each sequence has one of each, and all
        pairs come up equally often. Without any the light is the city's own.
    target, radius, height
        Of orbits, see `cityx.dataset.plans.takes.Wishes`.
    stage
        The scene of the city without what moves, if it is there already.
    within
        (xmin, ymin, xmax, ymax) metres that the western and southern border belong to. Poses of a
        file that lie beyond are left out; what is drawn begins within.
    origin
        Of the frame of the city, metres of that in which the file gives places.

    Returns
    -------
    plan
        The shots, and what was refused for them.

    Raises
    ------
    UsageError
        With every fault of what is asked for.
    InputError
        If the city has no place for such shots, or fewer legal ones than are asked for; the message
        tells what was tried and why it was refused.
    """
    custom = is_file(name)
    faults = [*_unknown(name, custom), *_out_of_range(name, count, length, rate, custom)]
    with _gathered(faults):
        mounts = rig_named(rig)
    with _gathered(faults):
        lights = _lights(city, weathers, times)
    if faults:
        raise UsageError(" ".join(faults))
    usual = 1 if custom else KINDS[name].length
    wishes = Wishes(seed, length or usual, rate, hfov, target, radius, height, size)
    site = Site(city, wishes, stage and (stage.still or stage))
    if custom:
        return _custom(site, Path(name), count, mounts, lights, within, origin)
    return _drawn(site, name, count or 0, mounts, lights, within)


def is_file(name: str) -> bool:
    """Return whether the name of a plan is that of a file."""
    return name not in KINDS and (name.endswith(".json") or Path(name).is_file())


@contextmanager
def _gathered(faults: list[str]) -> Iterator[None]:
    """Keep what a check finds, so that all faults are told at once."""
    try:
        yield
    except CityxError as error:
        faults.append(str(error))


def _unknown(name: str, custom: bool) -> list[str]:
    if custom or name in KINDS:
        return []
    return [f'there is no plan "{name}": it is neither a .json file nor one of {", ".join(KINDS)}.'
            + nearest(name, KINDS)]  # fmt: skip


def _out_of_range(
    name: str, count: int | None, length: int | None, rate: float, custom: bool
) -> list[str]:
    faults = []
    kind = KINDS.get(name)
    if count is None and not custom:
        faults.append("how many views are wanted is not said.")
    if count is not None and count < 1:
        faults.append(f"{count} views are no dataset; one at least is needed.")
    if not 0.01 <= rate <= 1000:
        faults.append(f"{rate:g} frames per second is out of range, allowed is 0.01 to 1000.")
    if length is not None and not 1 <= length <= LONGEST:
        faults.append(f"sequences of {length} frames cannot be, allowed is 1 to {LONGEST}.")
    if kind is not None and not kind.sequences and (length or 1) > 1:
        others = ", ".join(name for name, other in KINDS.items() if other.sequences)
        faults.append(f"{name} plans are single views; sequences come from {others}.")
    frames = max(length or (kind.length if kind else 1), 1)
    most = MOST_STILLS if frames == 1 else MOST_SEQUENCES * frames
    if count is not None and count > most:
        faults.append(f"{count} views are more than the {most} that names can count.")
    return faults


def _lights(city: City, weathers: Sequence[str], times: Sequence[str]) -> list[Environment | None]:
    """Return the light of every pair of a weather and a time; none is the city's own."""
    from cityx.light.weather import lit_anew

    if not weathers and not times:
        return [None]
    faults: list[str] = []
    found: list[Environment | None] = []
    for weather, time in product(weathers or ("",), times or ("",)):
        with _gathered(faults):
            found.append(lit_anew(city.environment, city.frame.latitude, city.frame.longitude,
                                  weather=weather, time=time))  # fmt: skip
    if faults:
        raise UsageError(" ".join(dict.fromkeys(faults)))
    return found


def _light(lights: Sequence[Environment | None], seed: int, sequence: int) -> Environment | None:
    """Return the light of a sequence: among as many as there are lights, each comes once."""
    turn, place = divmod(sequence, len(lights))
    order = sorted(range(len(lights)), key=lambda k: hash_bits(seed, "dataset/light", turn, k))
    return lights[order[place]]


def _drawn(
    site: Site, name: str, count: int, rig: Rig, lights: Sequence[Environment | None],
    within: tuple[float, float, float, float] | None,
) -> Plan:  # fmt: skip
    """Take candidates in their order until there are as many poses as asked for."""
    wishes = site.wishes
    source = KINDS[name].source(site)
    hope = HOPE[wishes.length > 1]
    block = BLOCK[wishes.length > 1]
    refused: Counter[str] = Counter()
    examples: dict[str, str] = {}
    takes: list[Take] = []
    tried = since = found = 0
    while found < count and since < hope:
        candidates = [_begun(item, within) for item in source(np.arange(tried, tried + block))]
        rows = [row for row, item in enumerate(candidates) if isinstance(item, Take)]
        verdicts: list[Take | Refusal] = list(candidates)
        legal = judged(site, [candidates[row] for row in rows], rig)  # type: ignore[misc]
        for row, refusal in zip(rows, legal, strict=True):
            verdicts[row] = refusal or candidates[row]
        for verdict in verdicts:
            if found >= count:
                break
            tried += 1
            if isinstance(verdict, Take):
                takes.append(verdict)
                found += verdict.count
                since = 0
                continue
            since += 1
            refused[verdict.reason] += 1
            examples.setdefault(verdict.reason, verdict.detail)
    if found < count:
        raise InputError(_hopeless(site, name, count, found, tried, refused, examples))
    shots = _shots(name, takes, count, rig, lights, wishes)
    return Plan(shots, tried, MappingProxyType(dict(refused.most_common())))


def _custom(
    site: Site, path: Path, count: int | None, rig: Rig, lights: Sequence[Environment | None],
    within: tuple[float, float, float, float] | None, origin: tuple[float, float],
) -> Plan:  # fmt: skip
    """Return the shots of a file; every view of it that may not be is named."""
    shift = np.array([*origin, 0.0])
    written = [replace(item, take=replace(item.take, position=item.take.position - shift))
               for item in read_plan(path, site.city)]  # fmt: skip
    frames = [frames_within(item.take, within) for item in written]
    parts = [item.take.at(rows) for item, rows in zip(written, frames, strict=True)]
    held = [row for row, part in enumerate(parts) if part.count]
    legal = judged(site, [parts[row] for row in held], rig, composed=False)
    faults = [f"{written[row].name}: {refusal.reason}, {refusal.detail}."
              for row, refusal in zip(held, legal, strict=True) if refusal]  # fmt: skip
    if faults:
        raise InputError(f"{path} has views that may not be: " + " ".join(faults))
    found: list[Shot] = []
    left = sum(item.take.count for item in written) if count is None else count
    for number, (item, rows) in enumerate(zip(written, frames, strict=True)):
        light = item.light or _light(lights, site.wishes.seed, number)
        sequence = f"custom_{number:04d}_{item.name}"
        most = min(item.take.count, left)
        found += shots_of(sequence, item.take, rows[rows < most].tolist(), rig, light, site.wishes,
                          single=item.single)  # fmt: skip
        left -= most
    return Plan(tuple(found), len(written), MappingProxyType({}))


def _begun(item: Take | Refusal, box: tuple[float, float, float, float] | None) -> Take | Refusal:
    """Refuse a take that begins outside a rectangle."""
    if isinstance(item, Refusal) or 0 in frames_within(item.at(np.arange(1)), box):
        return item
    x, y, _ = item.position[0].tolist()
    return Refusal("beyond the tile", f"it begins at {x:.1f}, {y:.1f}")


def frames_within(take: Take, box: tuple[float, float, float, float] | None) -> IntArray:
    """Return the numbers of the poses of a take in a rectangle, of all without one."""
    if box is None:
        return np.arange(take.count)
    xy = np.round(take.position[:, :2], 3)
    return np.flatnonzero(((xy >= box[:2]) & (xy < box[2:])).all(axis=1))


def _hopeless(
    site: Site, name: str, count: int, found: int, tried: int, refused: Counter[str],
    examples: dict[str, str],
) -> str:  # fmt: skip
    """Describe what was tried and why it was refused."""
    legal = f"no legal {name} view" if not found else f"only {found} of {count} legal {name} views"
    why = "; ".join(
        f"{times} {reason} ({examples[reason]})" for reason, times in refused.most_common()
    )
    return f"{legal} of {site.city.name} found among {tried} candidates, refused were: {why}."


def _shots(
    name: str, takes: Sequence[Take], count: int, rig: Rig,
    lights: Sequence[Environment | None], wishes: Wishes,
) -> tuple[Shot, ...]:  # fmt: skip
    found: list[Shot] = []
    left = count
    for number, take in enumerate(takes):
        light = _light(lights, wishes.seed, number)
        single = wishes.length == 1
        sequence = f"{name}_{number:06d}" if single else f"{name}_{number:04d}"
        frames = range(min(take.count, left))
        found += shots_of(sequence, take, frames, rig, light, wishes, single=single)
        left -= min(take.count, left)
    return tuple(found)


def shots_of(
    sequence: str, take: Take, frames: Iterable[int], rig: Rig, light: Environment | None,
    wishes: Wishes, *, single: bool,
) -> list[Shot]:  # fmt: skip
    """Return the shots of some poses of a take, by frame and sensor."""
    found = []
    for frame in frames:
        base = sequence if single else f"{sequence}_{frame:04d}"
        for camera in mounted(take.camera(frame, wishes.size), rig):
            sensor = camera.name
            name = base if len(rig) == 1 else f"{base}_{sensor}"
            found.append(Shot(name, replace(camera, name=name), sequence, frame, sensor,
                              round(float(take.moment[frame]), 6), light))  # fmt: skip
    return found
