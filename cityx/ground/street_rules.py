"""What stands on walks by rule, how often, and how much room it needs.

Rates are pieces per 100 m of kerb. They follow inventories of European and American cities in
order of magnitude (a bench per 100-250 m and a bin per 50-150 m of main street, a hydrant per
90 m in North America, none above ground in most of Europe); profiles of places hold factors.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cityx.assets.furniture.potted_plants import POT_ROWS
from cityx.ids import choose
from cityx.places.profile import Furniture

CLEAR = 1.5  # metres of free walk past whatever stands by rule
TIGHT = 1.2  # metres past a pole on a narrow walk; below it nothing stands
# Metres of walk from which more of it is left free, and what narrower ones than the last bear no
# boxes: their sides are as high as a wheelchair's driver.
AMPLE, AMPLE_CLEAR, BOXED = 3.0, 2.0, 3.0
BOXES = frozenset({"street_cabinet", "telephone", "kiosk", "advertising_column", "post_box",
                   "ticket_machine"})  # fmt: skip
SLOT = 6.0  # metres of kerb per draw
# Metres of walk from which things stand in a zone of their own, and from the kerb to the line of
# their fronts; how much more often than on a narrower one.
WIDE_WALK, FRONT_LINE = 3.5, 0.45
MORE = {"bench": 2.8, "planter": 2.4, "waste_basket": 2.2, "bicycle_parking": 1.6, "bollard": 0.6}
# Weights of rows of pots, 1 for those that are not named: what is tall greens a street.
POTS = {"pot_row_maple": 3.0, "pot_row_olive": 3.0, "pot_row_bamboo": 1.5, "pot_row_vines": 0.5}
FULL = 0.92  # of the slots of a walk that hold something at most
STREETS = {
    "primary": "main", "secondary": "main", "tertiary": "main", "trunk": "main",
    "residential": "local", "unclassified": "local", "living_street": "local",
}  # fmt: skip


@dataclass(frozen=True)
class Rule:
    """A thing along kerbs.

    Attributes
    ----------
    piece
        Name of the prototype.
    main_town, local_town, main_out, local_out
        Pieces per 100 m of kerb of main and of local streets, in town and outside.
    from_kerb
        Metres from the kerb to its middle.
    depth, length
        Half of its size across and along the walk, metres.
    """

    piece: str
    main_town: float
    local_town: float
    main_out: float
    local_out: float
    from_kerb: float
    depth: float
    length: float

    @property
    def room(self) -> float:
        """Metres of walk it needs, from the kerb."""
        return self.from_kerb + self.depth + CLEAR


SCOOTERS = ("motor_scooter", "motor_scooter_red", "motor_scooter_dark")
LEANING = ("bicycle", *SCOOTERS)  # along the wall, not square to it
# Metres from a wall to the middle of what stands at it.
BICYCLE_GAP = 0.31  # metres from a wall to the middle of a bicycle along it
WALL_GAP = {"bicycle_parking": 1.05, "bicycle": BICYCLE_GAP, "bench": 0.4, "planter": 0.42,
            "planter_round": 0.45, "vending_machine": 0.48, "wheelie_bins": 0.5,
            "motor_scooter": 0.45, "motor_scooter_red": 0.45, "cartons": 0.35,
            "street_cabinet": 0.3, "garden_shed": 1.0, "bin_store": 0.65,
            "pot_row": 0.24}  # fmt: skip
USUAL_GAP = 0.8  # the same for everything else
KERB_RULES: tuple[Rule, ...] = (
    Rule("bench", 0.9, 0.45, 0.25, 0.05, 0.60, 0.30, 0.95),
    Rule("waste_basket", 1.1, 0.7, 0.35, 0.1, 0.50, 0.22, 0.25),
    Rule("bicycle_parking", 0.7, 0.7, 0.1, 0.0, 1.10, 0.90, 1.40),
    Rule("planter", 1.2, 0.6, 0.1, 0.0, 0.55, 0.30, 0.65),
    Rule("advertising_column", 0.18, 0.0, 0.0, 0.0, 1.05, 0.80, 0.80),
    Rule("kiosk", 0.10, 0.0, 0.0, 0.0, 1.50, 1.15, 1.70),
    Rule("post_box", 0.15, 0.12, 0.06, 0.05, 0.55, 0.25, 0.30),
    Rule("telephone", 0.05, 0.02, 0.0, 0.0, 0.70, 0.48, 0.50),
    Rule("fire_hydrant", 0.04, 0.04, 0.04, 0.04, 0.55, 0.22, 0.35),
    Rule("bollard", 0.7, 0.7, 0.0, 0.0, 0.45, 0.25, 0.25),
    Rule("bicycle", 1.0, 1.4, 0.0, 0.0, 0.45, 0.30, 0.95),
    Rule("grating", 0.5, 0.0, 0.0, 0.0, 1.10, 0.0, 0.80),
    Rule("street_cabinet", 0.7, 0.7, 0.15, 0.1, 0.50, 0.21, 0.64),
    Rule("ticket_machine", 0.5, 0.6, 0.0, 0.0, 0.45, 0.15, 0.17),
    *(Rule(piece, 0.3, 0.3, 0.0, 0.0, 0.50, 0.35, 0.98) for piece in SCOOTERS),
)
# Metres of town within which there is one of a kind at most, and what stands in place of others.
APART = {"telephone": 120.0, "kiosk": 90.0, "advertising_column": 70.0, "post_box": 60.0}
INSTEAD = ("waste_basket", "bench", "planter")
TALL = frozenset({"advertising_column", "kiosk", "telephone"})  # hide what comes at junctions
TRUNK_GAP, TALL_GAP = 0.9, 2.6  # metres from trunks, beside their size, of things and of tall ones
SIGHT = 10.0  # metres from junctions that tall things keep
# What stands in rows along wide walks rather than alone, and metres between one and the next.
ROWS = {"bollard": 1.5, "planter": 1.75}
# Bicycles that lean on the poles of narrow walks stand in the racks of wide ones.
RACKED = {"bicycle": "bicycle_parking"}
PIECE_GAP = 1.6  # metres between things by rule and whatever else stands, beside their size
DOOR_DEPTH, DOOR_SIDE = 2.0, 0.85  # metres before a door, and to each side of its middle, kept free


def local_names(names: NDArray[Any], furniture: Furniture) -> NDArray[Any]:
    """Return what stands for (n,) usual pieces at a place."""
    return np.array([furniture.pieces.get(str(name), str(name)) for name in names], object)


def varied(names: NDArray[Any], ids: NDArray[np.uint64]) -> NDArray[Any]:
    """Return (n,) names of pieces, one of its makes for each row of pots."""
    weights = [POTS.get(name, 1.0) for name in POT_ROWS]
    makes = np.array(POT_ROWS, object)[choose(0, "pots", ids, weights)]
    return np.where(names == "pot_row", makes, names)


def drawn_shares(
    furniture: Furniture, column: NDArray[Any], wide: NDArray[Any], density: float
) -> NDArray[Any]:
    """(n, rules) running sums of the shares of slots that hold each thing.

    Parameters
    ----------
    furniture
        Of the profile of the place.
    column
        (n,) which rate of `rates` holds for a slot.
    wide
        (n,) bool, slots on walks of `WIDE_WALK`.
    density
        Factor of all rates.
    """
    table = np.array([rates(rule, furniture) for rule in KERB_RULES]) * SLOT / 100 * density
    more = np.array([MORE.get(rule.piece, 1.0) for rule in KERB_RULES])
    share = table.T[column] * np.where(wide[:, None], more, 1.0)
    edges = np.cumsum(share, axis=1)
    return np.asarray(edges * np.minimum(1.0, FULL / np.maximum(edges[:, -1:], FULL)))


def rates(rule: Rule, furniture: Furniture) -> tuple[float, float, float, float]:
    """Return the rates of a rule at a place: main and local in town, main and local outside."""
    factor = furniture.rates.get(rule.piece, 1.0)
    found = (rule.main_town, rule.local_town, rule.main_out, rule.local_out)
    a, b, c, d = (factor * rate for rate in found)
    return a, b, c, d
