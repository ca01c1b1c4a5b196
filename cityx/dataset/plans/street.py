"""The plan "street": what people see who stand on pavements and at kerbs."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cityx.city.ground import LABEL, ROADWAY, SURFACES
from cityx.dataset.plans.plan_site import Site
from cityx.dataset.plans.street_stretches import stations, street_lines
from cityx.dataset.plans.takes import Refusal, Source, Take, still
from cityx.errors import InputError
from cityx.geometry.arrays import FloatArray, IntArray
from cityx.geometry.polylines import locate
from cityx.ground.standing import stand_on
from cityx.ground.walking.crosswalks import FOOTWAYS
from cityx.ids import uniform

FOV = 70.0  # degrees
LOWEST, HIGHEST = 1.4, 1.9  # metres of eyes above the pavement
KERB_SHARE = 0.25  # of the eyes that stand at the kerb, as if about to cross
AT_KERB, DEEPEST = 0.3, 2.4  # metres from the edge of the carriageway outwards
EDGE = 0.5  # metres from the edge of a carriageway inwards, where there is no pavement
ALONG, OBLIQUE = 0.6, 0.2  # shares of the views along the street and aslant; the others cross it
_ALONG, _OBLIQUE, _ACROSS = (
    (-6.0, 12.0),
    (20.0, 55.0),
    (65.0, 105.0),
)  # degrees to the street's side
_LEVEL, _FACADE = (-4.0, 5.0), (0.0, 10.0)  # degrees of pitch, along the street and across
WALKED = [LABEL[name] for name in (*FOOTWAYS, "kerb")]
DRIVEN = [LABEL[name] for name in ROADWAY]


def street(site: Site) -> Source:
    """Return the source of views at eye level, evenly along all streets on the ground.

    Raises
    ------
    InputError
        If the city has no streets.
    """
    city = site.city
    network = city.network
    if network is None or not network.edge_count:
        raise InputError(f"there are no streets in {city.name}, so nobody can stand on one.")
    lines, rows = street_lines(network, city.layout.extent)
    if not len(rows):
        raise InputError(f"all streets of {city.name} lie off the ground or beyond its border.")
    places = stations(lines, rows)

    def candidates(numbers: IntArray) -> list[Take | Refusal]:
        line, along = places.at(site.draws("street", numbers, 1)[:, 0])
        spot, way = locate(lines, line, along)
        drawn = _draws(site, numbers, 8)
        left = drawn[:, 0] < 0.5
        normal = np.where(left[:, None], 1, -1) * np.column_stack([-way[:, 1], way[:, 0]])
        kerb = drawn[:, 1] < KERB_SHARE
        deep = np.where(kerb, AT_KERB * drawn[:, 2], AT_KERB + (DEEPEST - AT_KERB) * drawn[:, 2])
        half = network.half_width[line]
        eye = spot + normal * (half + deep)[:, None]
        ground = city.scene.meshes.get("ground")
        footing = stand_on(ground, eye)
        # Along a street without pavements one walks on its edge.
        bare = ~np.isin(footing.label, WALKED)
        eye = np.where(bare[:, None], spot + normal * (half - EDGE)[:, None], eye)
        footing = stand_on(ground, eye)
        walked = np.isin(footing.label, np.r_[WALKED, DRIVEN])
        heading, pitch = _looks(way, left, drawn)
        height = LOWEST + (HIGHEST - LOWEST) * drawn[:, 6]
        moment = site.moments(numbers)
        found: list[Take | Refusal] = []
        for row in range(len(numbers)):
            if not walked[row]:
                label = footing.label[row]
                under = SURFACES[label].name if label >= 0 else "no ground"
                found.append(
                    Refusal("nothing to stand on", f"{under} at {eye[row].round(1).tolist()}")
                )
                continue
            place = np.append(eye[row], footing.z[row] + height[row])
            found.append(
                still(place, heading[row], pitch[row], moment[row], site.wishes.fov(FOV),
                      foot=float(height[row]))
            )  # fmt: skip
        return found

    return candidates


def _draws(site: Site, numbers: IntArray, count: int) -> FloatArray:
    return uniform(site.wishes.seed, "dataset/street/view", numbers[:, None], np.arange(count))


def _looks(
    way: FloatArray, left: NDArray[np.bool_], drawn: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return headings and pitches, radians, of eyes at one side of streets."""
    forth = drawn[:, 3] < 0.5
    along = np.arctan2(way[:, 0], way[:, 1]) + np.where(forth, 0.0, np.pi)
    # The street lies to the right of who looks along it from its left side.
    towards = np.where(left == forth, 1.0, -1.0)
    kind, turn = drawn[:, 4], drawn[:, 5]

    def between(span: tuple[float, float], share: FloatArray) -> FloatArray:
        return np.asarray(np.radians(span[0] + (span[1] - span[0]) * share))

    ahead, aslant = kind < ALONG, kind < ALONG + OBLIQUE
    angle = np.where(ahead, between(_ALONG, turn),
                     np.where(aslant, between(_OBLIQUE, turn), between(_ACROSS, turn)))  # fmt: skip
    pitch = np.where(aslant, between(_LEVEL, drawn[:, 7]), between(_FACADE, drawn[:, 7]))
    return along + towards * angle, pitch
