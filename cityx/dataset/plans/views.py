"""Legal views: an eye in free space, above ground, before which there is something to see."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cityx.city.camera import Camera, axes
from cityx.city.moments import moments_of
from cityx.city.tracks import Tracks
from cityx.dataset.plans.plan_site import Site
from cityx.dataset.plans.takes import Refusal, Take
from cityx.dataset.rigs import Mount, mounted
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.ids import id_text

if TYPE_CHECKING:
    from cityx.dataset.stage import Stage
    from cityx.geometry.raycast import Hits

CLEAR = 0.5  # metres round an eye that must be free
STUMBLE = 0.35  # metres by which feet may be off the ground, as on stairs
AROUND = 256  # directions in which that is looked for: 0.1 m apart at 0.5 m
PICTURE = (24, 16)  # rays across and down a picture that tell what it shows
INSIDE = 0.4  # share of the directions that meet something from behind inside a closed mesh
NEAR, TOO_NEAR = 2.5, 0.25  # metres, and the share of a picture that may be of things nearer
WALL, WALLED = 5.0, 0.55  # metres, and the share of a picture within them that is a stare
VOID, LEVEL_VOID = 0.2, 0.1  # shares of pictures from above, and of level ones, beyond the map
KNOWN_VOID = 0.4  # the same where a height file tells what the land beyond looks like
LEVEL = np.radians(-12.0)  # pitch from which a view is level
BELOW = -0.03  # slope of rays that should meet land
SKY = 0.75  # share of a picture that may be sky, with what lies beyond the map
ODD = 0.2  # share of the frames of a sequence whose picture may be dull
SEEN, MOSTLY = 0.3, 0.75  # share of a target that is seen, and of the frames in which it is
REACH = 12.0  # metres within which what moves is looked at
PARALLEL = 1e-12  # slope below which a ray counts as along the sides of a box
CHUNK = 400_000  # rays cast at once: some 100 MB


@dataclass(frozen=True)
class _Movers:
    """What moves near eyes, p pairs of an eye and a mover."""

    eye: IntArray
    mover: IntArray
    position: FloatArray
    heading: FloatArray
    half: FloatArray


def judged(
    site: Site, takes: Sequence[Take], rig: Sequence[Mount], *, composed: bool = True
) -> list[Refusal | None]:
    """Return for each take why it is refused, None for legal takes.

    All that the eyes of the rig see is found by ray casts against the scene; what moves counts as
    a box where it is at the moment of each pose.

    Parameters
    ----------
    site
        Where they are.
    takes
        The takes.
    rig
        Its eyes must be free; what the picture shows is asked of the pose that carries it.
    composed
        Whether pictures that show nothing are refused as well.
    """
    if not takes:
        return []
    frame, poses, moment = _poses(site, takes)
    ways = [np.zeros((0, 3)) if take.way is None else take.way for take in takes]
    eyes = np.array([c.position for pose in poses for c in mounted(pose, rig)])
    whole = np.concatenate([eyes, *ways])
    take_of = np.repeat(np.arange(len(takes)), [len(way) for way in ways])
    take_of = np.concatenate([np.repeat(frame, len(rig)), take_of])
    clear = np.array([take.clearance or CLEAR for take in takes])[take_of]
    movers = _near(site.city.tracks, eyes, np.repeat(moment, len(rig)))
    blocked = _blocked(site, whole, clear, movers, composed=composed)
    found: list[Refusal | None] = [None] * len(takes)
    for eye in sorted(blocked, reverse=True):  # the first of a take is told
        reason, detail = blocked[eye]
        place = _at(tuple(whole[eye].tolist()))
        found[int(take_of[eye])] = Refusal(reason, f"{detail} at {place}")
    _stand(site, takes, poses, frame, found)
    if composed:
        _compositions(site, takes, poses, frame, moment, found)
    return found


def _stand(
    site: Site, takes: Sequence[Take], poses: Sequence[Camera], frame: IntArray,
    found: list[Refusal | None],
) -> None:  # fmt: skip
    """Refuse takes whose eyes are not as high as they should be: on a bench, beside a bridge."""
    foot = np.array([take.foot for take in takes])[frame]
    rows = np.flatnonzero(foot > 0)
    if not len(rows):
        return
    eyes = np.array([poses[row].position for row in rows.tolist()])
    hits = site.stage.cast(eyes, np.broadcast_to([0.0, 0.0, -1.0], eyes.shape))
    objects = site.objects_at(hits)
    for at in np.flatnonzero(np.abs(hits.distance - foot[rows]) > STUMBLE)[::-1].tolist():
        take = int(frame[rows[at]])
        if found[take] is None:
            what = site.named(int(objects[at])) if objects[at] else "the ground"
            found[take] = Refusal("not on the ground", f"{hits.distance[at]:.2f} m above {what} "
                                  f"at {_at(poses[rows[at]].position)}")  # fmt: skip


def _poses(site: Site, takes: Sequence[Take]) -> tuple[IntArray, list[Camera], FloatArray]:
    """Return the take of each pose, the poses of all takes as cameras, and their moments."""
    size = site.wishes.size
    frame = np.repeat(np.arange(len(takes)), [take.count for take in takes])
    poses = [take.camera(row, size) for take in takes for row in range(take.count)]
    return frame, poses, np.concatenate([take.moment for take in takes])


def _at(position: tuple[float, ...]) -> str:
    return "(" + ", ".join(f"{value:.1f}" for value in position) + ")"


def _all_round() -> FloatArray:
    """(AROUND, 3) unit vectors evenly over the sphere: a spiral of the golden angle."""
    k = np.arange(AROUND) + 0.5
    z = 1 - 2 * k / AROUND
    angle = np.pi * (1 + 5**0.5) * k
    r = np.sqrt(1 - z * z)
    return np.column_stack([r * np.cos(angle), r * np.sin(angle), z])


def _cast(stage: Stage, origins: FloatArray, directions: FloatArray) -> list[Hits]:
    """Cast d rays from each of n origins, part by part."""
    count = max(CHUNK // directions.shape[-2], 1)
    found = []
    for begin in range(0, len(origins), count):
        part = origins[begin : begin + count]
        way = directions if directions.ndim == 2 else directions[begin : begin + count]
        way = np.broadcast_to(way, (len(part), *way.shape[-2:]))
        origin = np.broadcast_to(part[:, None], way.shape)
        found.append(stage.cast(origin.reshape(-1, 3), way.reshape(-1, 3)))
    return found


def _blocked(
    site: Site, eyes: FloatArray, clear: FloatArray, movers: _Movers, *, composed: bool
) -> dict[int, tuple[str, str]]:
    """Return why eyes may not be where they are, by number: reason and detail."""
    found: dict[int, tuple[str, str]] = {}
    way = _all_round()
    begin = 0
    for hits in _cast(site.stage, eyes, way):
        distance = np.asarray(hits.distance, float).reshape(-1, AROUND)
        back = np.asarray(hits.back).reshape(-1, AROUND) & np.isfinite(distance)
        objects = site.objects_at(hits).reshape(-1, AROUND)
        ground = np.isin(objects, site.ground_ids)
        for row in range(len(distance)):
            what = _where(distance[row], back[row], objects[row], ground[row], way, site,
                          float(clear[begin + row]), composed)  # fmt: skip
            if what is not None:
                found[begin + row] = what
        begin += len(distance)
    gap = _gaps(eyes, movers)
    for pair in np.flatnonzero(gap < clear[movers.eye]).tolist():
        assert site.city.tracks is not None
        name = id_text(site.city.tracks.object_id[movers.mover[pair]])
        found.setdefault(
            int(movers.eye[pair]),
            ("in the way of traffic", f"{max(gap[pair], 0.0):.1f} m from moving {name}"),
        )
    return found


def _where(
    distance: FloatArray, back: NDArray[np.bool_], objects: NDArray[np.uint64],
    ground: NDArray[np.bool_], way: FloatArray, site: Site, clear: float,
    composed: bool,
) -> tuple[str, str] | None:  # fmt: skip
    """Return why one eye may not be where it is, by what lies round it."""
    if (back & ground & (way[:, 2] > 0)).any():
        return "underground", "the eye is under the ground"
    ids, count = np.unique(objects[back], return_counts=True)
    if back.sum() >= INSIDE * AROUND and len(ids):
        thing = int(ids[np.argmax(count)])
        return "inside something", f"the eye is inside {site.named(thing)}"
    if composed and not np.isfinite(distance[way[:, 2] < 0]).any():
        return "beyond the map", "nothing lies below the eye"
    least = int(np.argmin(distance))
    if distance[least] < clear:
        return (
            "too near to something",
            f"{distance[least]:.2f} m from {site.named(int(objects[least]))}",
        )
    return None


def _near(tracks: Tracks | None, eyes: FloatArray, moment: FloatArray) -> _Movers:
    """Return what moves within reach of eyes, each at its moment."""
    none = np.zeros(0, np.int64)
    if tracks is None or not tracks.count:
        return _Movers(none, none, np.zeros((0, 3)), np.zeros(0), np.zeros((0, 3)))
    times, number = np.unique(moment, return_inverse=True)
    there = moments_of(tracks, times)
    order = np.argsort(there.number, kind="stable")
    start = np.searchsorted(there.number[order], np.arange(len(times) + 1))
    eye = np.repeat(np.arange(len(eyes)), np.diff(start)[number])
    first = np.repeat(start[number], np.diff(start)[number])
    step = np.arange(len(eye)) - np.searchsorted(eye, eye)
    row = order[first + step]
    half = tracks.size[there.mover[row]].astype(float) / 2
    off = np.linalg.norm((there.position[row] - eyes[eye])[:, :2], axis=1)
    near = off < REACH + np.hypot(*half[:, :2].T)
    return _Movers(eye[near], there.mover[row[near]], there.position[row[near]],
                   there.heading[row[near]], half[near])  # fmt: skip


def _along(heading: FloatArray, vectors: FloatArray) -> FloatArray:
    """(..., 3) vectors in the frames of movers: ahead, to the left and up."""
    sine, cosine = np.sin(heading), np.cos(heading)
    x, y, z = np.moveaxis(vectors, -1, 0)
    return np.stack([cosine * x + sine * y, cosine * y - sine * x, z], axis=-1)


def _to_middles(movers: _Movers, eyes: FloatArray) -> FloatArray:
    """(p, 3) eyes as seen from the middles of movers' boxes."""
    middle = movers.position + np.array([0.0, 0.0, 1.0]) * movers.half
    return _along(movers.heading, eyes[movers.eye] - middle)


def _gaps(eyes: FloatArray, movers: _Movers) -> FloatArray:
    """(p,) metres from eyes to the boxes of movers; 0 inside."""
    beyond = np.maximum(np.abs(_to_middles(movers, eyes)) - movers.half, 0.0)
    return np.asarray(np.linalg.norm(beyond, axis=1))


def _picture_rays(camera: Camera) -> FloatArray:
    """(k, 3) unit vectors evenly over a picture."""
    across, down = PICTURE
    half = np.tan(camera.hfov / 2)
    x = ((np.arange(across) + 0.5) / across * 2 - 1) * half
    y = ((np.arange(down) + 0.5) / down * 2 - 1) * half * camera.height / camera.width
    right, below, ahead = axes(camera)
    way = ahead + x[None, :, None] * right + y[:, None, None] * below
    way = way.reshape(-1, 3)
    return np.asarray(way / np.linalg.norm(way, axis=1, keepdims=True))


def _compositions(
    site: Site,
    takes: Sequence[Take],
    poses: Sequence[Camera],
    frame: IntArray,
    moment: FloatArray,
    found: list[Refusal | None],
) -> None:
    """Refuse takes that look at nothing: too many frames before a wall, of sky, off the map."""
    rows = [pose for pose in range(len(poses)) if found[int(frame[pose])] is None]
    if not rows:
        return
    eyes = np.array([poses[row].position for row in rows])
    way = np.array([_picture_rays(poses[row]) for row in rows])  # (n, k, 3)
    distance, standing = _seen(site, eyes, way, moment[rows])
    nothing = ~np.isfinite(distance)
    spot = eyes[:, None, :2] + np.where(nothing, 0.0, distance)[..., None] * way[..., :2]
    west, south, east, north = site.city.layout.extent
    away = (spot < (west, south)).any(axis=2) | (spot > (east, north)).any(axis=2)
    off = np.where(nothing, way[..., 2] < BELOW, away & ~standing)
    near, wall = standing & (distance < NEAR), standing & (distance < WALL)
    pitch = np.array([poses[row].pitch for row in rows])
    void = np.where(pitch > LEVEL, LEVEL_VOID, VOID)
    if site.city.survey is not None:
        void = np.full(len(rows), KNOWN_VOID)
    shares = (
        (
            "too near to something",
            near,
            np.array(TOO_NEAR),
            f"of the picture nearer than {NEAR:g} m",
        ),
        ("before a wall", wall, np.array(WALLED), f"of the picture nearer than {WALL:g} m"),
        ("off the map", off, void, "of the picture beyond the border of the map"),
        (
            "nothing but sky",
            nothing | off,
            np.array(SKY),
            "of the picture sky and land beyond the map",
        ),
    )
    own = frame[rows]
    for take in sorted(set(own.tolist())):
        mine = np.flatnonzero(own == take)
        for reason, marked, most, words in shares:
            share = marked[mine].mean(axis=1)
            if takes[take].target is not None and marked is not near:
                continue  # it shows what it goes round, and that must be seen
            dull = share > np.broadcast_to(most, own.shape)[mine]
            if found[take] is None and dull.mean() > (ODD if len(mine) > 1 else 0):
                worst = int(np.argmax(share))
                place = _at(poses[rows[mine[worst]]].position)
                found[take] = Refusal(reason, f"{share[worst]:.0%} {words} at {place}")
        if found[take] is None and takes[take].target is not None:
            found[take] = _unseen(site, takes[take])


def _seen(
    site: Site, eyes: FloatArray, way: FloatArray, moment: FloatArray
) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Return (n, k) metres along rays to what they meet, and whether that stands on the ground."""
    hits = _cast(site.stage, eyes, way)
    distance = np.concatenate([part.distance for part in hits]).reshape(way.shape[:2])
    met = np.concatenate([site.objects_at(part) for part in hits]).reshape(way.shape[:2])
    standing = (met != 0) & ~np.isin(met, site.ground_ids)
    movers = _near(site.city.tracks, eyes, moment)
    start = _to_middles(movers, eyes)
    for pair, eye in enumerate(movers.eye.tolist()):
        turned = _along(movers.heading[pair], way[eye])
        reach = _to_box(start[pair], turned, movers.half[pair])
        standing[eye] |= reach < distance[eye]
        distance[eye] = np.minimum(distance[eye], reach)
    return distance, standing


def _to_box(start: FloatArray, way: FloatArray, half: FloatArray) -> FloatArray:
    """(k,) lengths of rays from a point to a box about 0; infinite where they miss it."""
    level = np.where(np.abs(way) < PARALLEL, PARALLEL, way)
    one, other = (-half - start) / level, (half - start) / level
    enter = np.minimum(one, other).max(axis=1)
    leave = np.maximum(one, other).min(axis=1)
    return np.where((enter <= leave) & (leave > 0), np.maximum(enter, 0.0), np.inf)


def _unseen(site: Site, take: Take) -> Refusal | None:
    """Refuse a take from most of whose poses little of its target is seen."""
    points = take.target
    assert points is not None
    way = points[None] - take.position[:, None]
    share = np.concatenate([
        (np.asarray(hits.distance) > 1.0)  # a ray to a point of the target has length 1
        | ((site.objects_at(hits) == np.uint64(take.target_id)) & (take.target_id != 0))
        for hits in _cast(site.stage, take.position, way)
    ]).reshape(way.shape[:2]).mean(axis=1)  # fmt: skip
    good = (share >= SEEN).mean()
    if good >= MOSTLY:
        return None
    return Refusal(
        "the target is hidden",
        f"only from {good:.0%} of the poses is {SEEN:.0%} of the target seen",
    )
