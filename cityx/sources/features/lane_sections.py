"""Lane-level cross-sections from tags: turn arrows, bus and cycle lanes, shoulders."""

from __future__ import annotations

from cityx.city.section import NARROWEST_LANE, PARKING, TURN, Band
from cityx.sources.features import measures
from cityx.sources.features.tagged import Tags

CYCLE_LANE = 1.6  # metres
LEAST_CYCLED = 1.0  # metres, beside the only lane of a street
SHOULDER = 2.5
MAX_LANES = 12
_LANED = frozenset({"lane", "track", "opposite_lane", "opposite_track", "exclusive"})
_FOR_BUSES = frozenset({"designated", "yes"})
_TURN_WORDS = {
    "left": "left", "slight_left": "left", "sharp_left": "left", "merge_to_left": "through",
    "through": "through", "merge_to_right": "through",
    "right": "right", "slight_right": "right", "sharp_right": "right", "reverse": "reverse",
}  # fmt: skip
# Keys of who may use a street, the narrower before the wider; what says no closes a lane to cars.
_GENERAL = ("motorcar", "motor_vehicle", "vehicle", "access")
_BUSES = ("bus", "psv")
_ADMITTED = frozenset({"yes", "designated", "official"})
_CLOSED = "no"
# Who may ride where all traffic is let in or kept out, the narrower before the wider.
_RIDERS = ("bicycle", "vehicle", "access")
_LET_RIDE = _ADMITTED | {"permissive", "destination", "customers"}
_HINTS = ("turn:lanes", "cycleway", "busway", "lanes:bus", "lanes:psv", "bus:lanes", "psv:lanes",
          *(f"{key}:lanes" for key in _GENERAL), "shoulder")  # fmt: skip


def kind_of_lanes(tags: Tags, kind: str, way: str) -> str:
    """Return whose the lanes of a street in one direction are: "drive", "bus", "cycle", "shoulder".

    Where cars may not drive they are those of buses that may, else of bicycles; lanes that nobody
    is let into are as shoulders.

    Parameters
    ----------
    kind
        Class of the street; a busway is of buses.
    way
        "forward" or "backward", of the way as it is drawn.
    """
    if kind == "busway":
        return "bus"
    key = next((key for key in _GENERAL if _said(tags, key, way)), "")
    if not key or _said(tags, key, way) != _CLOSED:
        return "drive"
    wider = (_said(tags, other, way) for other in _GENERAL[1:])
    if any(_said(tags, who, way) in _ADMITTED for who in _BUSES) or (
        key == "motorcar" and _CLOSED not in wider
    ):
        return "bus"
    rides = next((_said(tags, who, way) for who in _RIDERS if _said(tags, who, way)), "yes")
    return "cycle" if rides in _LET_RIDE else "shoulder"


def _said(tags: Tags, key: str, way: str) -> str:
    """Return what a key says of a direction of a street."""
    return tags.get(f"{key}:{way}") or tags.get(key) or ""


def contraflow(tags: Tags, *, backward: bool) -> int:
    """Return the number of lanes in which buses go against a one-way street.

    Parameters
    ----------
    backward
        Traffic runs against the way as it is drawn.
    """
    against = "forward" if backward else "backward"
    keys = [f"lanes:{who}:{against}" for who in _BUSES]
    exempt = any(tags.get(f"oneway:{who}") == "no" for who in _BUSES)
    exempt |= any(f"{who}:lanes:{against}" in tags for who in _BUSES)
    if exempt:
        keys.append(f"lanes:{against}")
    told = max(int(measures.count(tags.get(key), 0, MAX_LANES) or 0) for key in keys)
    opposite = any(
        tags.get(key) == "opposite_lane"
        for key in ("busway", "busway:left", "busway:right", "busway:both")
    )
    two = exempt and int(measures.count(tags.get("lanes"), 1, MAX_LANES) or 1) > 1
    return max(told, int(opposite or two))


def bands_of_tags(
    tags: Tags, kind: str, lanes: int, forward: int, lane_width: float,
    parking: tuple[bool, bool], *, oneway: bool, backward: bool, left_hand: bool,
    against: int = 0,
) -> tuple[Band, ...]:  # fmt: skip
    """Return the bands between the kerbs from left to right, or none where tags add nothing.

    Parameters
    ----------
    kind, lanes, forward, lane_width, parking, oneway
        What is known of the road; `parking` is left and right of the way as it is drawn.
    backward
        Traffic runs against the way as it is drawn; the bands are those of the turned way.
    left_hand
        Whether traffic keeps to the left.
    against
        Lanes of a one-way street, of all of its lanes, in which buses come the other way.
    """
    ahead = "backward" if backward else "forward"
    behind = "forward" if backward else "backward"
    own, other = (kind_of_lanes(tags, kind, way) for way in (ahead, behind))
    shoulders = _shoulders(tags, kind, left_hand=left_hand)
    hinted = any(shoulders) or any(key.startswith(_HINTS) for key in tags)
    if not (hinted or against or own != "drive" or (other != "drive" and not oneway)):
        return ()
    onward = _lanes(tags, ahead, forward, lane_width, 1, oneway=oneway and not against, whose=own)
    count = against if oneway else lanes - forward
    if not oneway and lanes == 1:
        onward, count = _single(own, other, lane_width), 0
    alone = "bus" if against > 0 else other
    opposite = _lanes(tags, behind, count, lane_width, -1, oneway=False, whose=alone)[::-1]
    middle = [*onward, *opposite] if left_hand else [*opposite, *onward]
    cycles = _cycle_lanes(tags, oneway=oneway, left_hand=left_hand)
    if "drive" not in (own, other) and "bus" not in (own, other):
        cycles = (0, 0)  # all of the street is theirs, or nobody's
    sides: list[list[Band]] = []
    for place in (0, 1):
        drawn = 1 - place if backward else place
        side = [Band("parking", PARKING)] if parking[drawn] else []
        if cycles[drawn]:
            sign = -cycles[drawn] if backward else cycles[drawn]
            track = _value(tags, "cycleway", drawn) in ("track", "opposite_track")
            lane = Band("cycle", CYCLE_LANE, sign)
            side = [lane, *side] if track else [*side, lane]
        if shoulders[drawn]:
            side = [Band("shoulder", shoulders[drawn]), *side]
        sides.append(side)
    bands = (*sides[0], *middle, *reversed(sides[1]))
    plain = all(band.kind in ("drive", "parking") and not band.turns for band in bands)
    plain &= oneway or own == other
    return () if plain else bands


def _single(own: str, other: str, width: float) -> list[Band]:
    """Return the only lane of a street, or a half for each direction where they are of others."""
    moving = [(kind, sign) for kind, sign in ((own, 1), (other, -1)) if kind != "shoulder"]
    if own == other or len(moving) < 2:
        kind, sign = moving[0] if own != other and moving else (own, 0)
        return [Band(kind, width, sign)]
    ridden = min(max(width - NARROWEST_LANE, LEAST_CYCLED), CYCLE_LANE)
    return [Band(kind, ridden if kind == "cycle" else width - ridden, sign)
            for kind, sign in moving[::-1]]  # fmt: skip


def _lanes(
    tags: Tags, way: str, count: int, width: float, direction: int, *, oneway: bool, whose: str
) -> list[Band]:
    """Lanes of one direction from left to right as their drivers see them.

    All are of one kind unless cars may drive there; then some may be of others.
    """
    turns = [_bits(word) for word in _per_lane(tags, "turn", way, count, oneway=oneway)]
    reserved = _bus_lanes(tags, way, count, oneway=oneway)
    left = _left_to(tags, way, count, oneway=oneway)
    kinds = ["bus" if bus else kind for bus, kind in zip(reserved, left, strict=True)]
    if whose != "drive":
        kinds = [whose if kind == "drive" else kind for kind in left]
    return [
        Band(kind, width) if kind == "shoulder" else Band(kind, width, direction, turn)
        for kind, turn in zip(kinds, turns, strict=True)
    ]


def _of_direction(tags: Tags, key: str, way: str, *, oneway: bool) -> str:
    """Return what a key says of a direction; what it says of the way is of a one-way street."""
    return tags.get(f"{key}:{way}") or (tags.get(key) if oneway else None) or ""


def _per_lane(tags: Tags, key: str, way: str, count: int, *, oneway: bool) -> list[str]:
    """Return what a key says of each lane of a direction, "" where it says nothing."""
    words = _of_direction(tags, f"{key}:lanes", way, oneway=oneway).split("|")
    return words if len(words) == count else [""] * count


def _left_to(tags: Tags, way: str, count: int, *, oneway: bool) -> list[str]:
    """Return the kind of each lane of a direction: one that is closed to cars is that of others.

    Buses may drive where cars alone may not, or where they are named; bicycles likewise. A lane
    that nobody is let into is as a shoulder.
    """
    said = {key: _per_lane(tags, key, way, count, oneway=oneway)
            for key in (*_GENERAL, *_BUSES, "bicycle")}  # fmt: skip
    found = []
    for lane in range(count):
        key = next((key for key in _GENERAL if said[key][lane]), "")
        if not key or said[key][lane] != "no":
            found.append("drive")
        elif key == "motorcar" or any(said[who][lane] in _ADMITTED for who in _BUSES):
            found.append("bus")
        else:
            cycled = said["bicycle"][lane] in _ADMITTED
            found.append("cycle" if cycled else "shoulder")
    return found


def _bits(word: str) -> int:
    found = 0
    for name in word.replace(",", ";").split(";"):
        if name.strip() in _TURN_WORDS:
            found |= TURN[_TURN_WORDS[name.strip()]]
    return found


def _bus_lanes(tags: Tags, way: str, count: int, *, oneway: bool) -> list[bool]:
    for key in _BUSES:
        words = _per_lane(tags, key, way, count, oneway=oneway)
        if any(word in _FOR_BUSES for word in words):
            found = [word == "designated" for word in words]
            return found if any(found) and not all(found) else [False] * count
    number = 0
    for who in _BUSES:
        text = _of_direction(tags, f"lanes:{who}", way, oneway=oneway)
        number = max(number, int(measures.count(text, 0, MAX_LANES) or 0))
    if tags.get("busway") == "lane" or tags.get("busway:both") == "lane":
        number = max(number, 1)
    if (tags.get("busway:right") or tags.get("busway:left")) == "lane" and way == "forward":
        number = max(number, 1)
    number = min(number, count - 1)  # one is left to cars
    return [place >= count - number for place in range(count)]


def _value(tags: Tags, key: str, place: int) -> str:
    side = ("left", "right")[place]
    return tags.get(f"{key}:{side}") or tags.get(f"{key}:both") or tags.get(key) or ""


def _cycle_lanes(tags: Tags, *, oneway: bool, left_hand: bool) -> tuple[int, int]:
    """Direction of the cycle lane left and right of the way as it is drawn, 0 for none."""
    found = []
    for place in (0, 1):
        value = _value(tags, "cycleway", place)
        own = f"cycleway:{('left', 'right')[place]}" in tags or "cycleway:both" in tags
        along = 1 if (place == 0) == left_hand else -1
        if value not in _LANED:
            found.append(0)
        elif oneway and not own:  # one lane beside a one-way street, on the side of its traffic
            opposite = value.startswith("opposite")
            found.append(along if (along > 0) != opposite else 0)
        elif oneway and not value.startswith("opposite") and not _against(tags, place, along):
            found.append(1)
        else:
            found.append(along)
    return found[0], found[1]


def _against(tags: Tags, place: int, along: int) -> bool:
    """Return whether a lane on the far side of a one-way street is for those who come towards."""
    told = tags.get(f"cycleway:{('left', 'right')[place]}:oneway", "")
    return told in ("-1", "no") or (along < 0 and not told and tags.get("oneway:bicycle") == "no")


def _shoulders(tags: Tags, kind: str, *, left_hand: bool) -> tuple[float, float]:
    value = tags.get("shoulder")
    outer = 0 if left_hand else 1
    if value is None and not any(key.startswith("shoulder:") for key in tags):
        usual = [0.0, 0.0]
        usual[outer] = SHOULDER if kind == "motorway" else 0.0
        return usual[0], usual[1]
    sizes = []
    for place, side in enumerate(("left", "right")):
        word = tags.get(f"shoulder:{side}") or tags.get("shoulder:both") or value or "no"
        has = word in (side, "both") or (word == "yes" and place == outer)
        if tags.get(f"shoulder:{side}") == "yes" or tags.get("shoulder:both") == "yes":
            has = True
        width = measures.measure(
            tags.get(f"shoulder:{side}:width") or tags.get("shoulder:width"), 0.3, 6.0
        )
        sizes.append((width or SHOULDER) if has else 0.0)
    return sizes[0], sizes[1]
