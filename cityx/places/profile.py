"""What a city looks and works like at its place: one profile, read from TOML.

Keys are those of the dataclasses below, one table each. A key that a profile leaves out is that of
the profile it inherits. Tables marked as merged are inherited word by word; weights are replaced as
a whole.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Literal

from cityx.places.painting import Amount, Painting
from cityx.system.tables import Between

Share = Annotated[float, Between(0.0, 1.0)]
Latitude = Annotated[float, Between(-90.0, 90.0)]
Longitude = Annotated[float, Between(-180.0, 180.0)]
Weights = Mapping[str, Amount]  # how often there is each, relative; "" is nothing
# Weight, material, and colours (sRGB, as seen).
Surfaces = tuple[tuple[Amount, str, tuple[int, ...]], ...]
TOP = "world"  # what every profile inherits in the end


MERGED = {"merged": True}
CLOSED = {"merged": True, "closed": True}  # its words are those of "world"


@dataclass(frozen=True)
class Streets:
    """How streets are laid out, where no tag says so: lane width, walks, and what stands there.

    Attributes
    ----------
    lane_widths, walk_widths
        Metres by class of road (highway=*), 0 for no walk; merged.
    least_walk
        Metres of the walks of all classes that have one.
    kerb_parking
        Whether cars park along residential streets of dense towns.
    single_width
        Metres between the kerbs of one-way streets of one lane, where nobody parks along kerbs.
    kerb_occupancy
        Share of the bays along kerbs that are taken.
    deliveries
        Whether small vans stand in one-way streets without a lane for parking.
    far_signals
        Whether signals stand behind junctions, too, where traffic keeps to the right.
    minor_sign
        Piece that stands before a street of a higher class.
    zebra_signs, name_signs
        Whether signs tell of zebras, and names stand at junctions.
    guard_pipes
        Whether pipes part walks from main streets.
    utility_poles
        Whether poles carry wires along narrow streets.
    cyclists
        Share of bicycles in the traffic of main and of minor streets; () for what is usual.
    """

    lane_widths: Weights = field(default_factory=dict, metadata=CLOSED)
    walk_widths: Weights = field(default_factory=dict, metadata=CLOSED)
    least_walk: Amount = 0.0
    kerb_parking: bool = True
    single_width: Amount = 5.0
    kerb_occupancy: Share = 0.7
    deliveries: bool = False
    far_signals: bool = False
    minor_sign: str = "sign_give_way"
    zebra_signs: bool = True
    name_signs: bool = True
    guard_pipes: bool = False
    utility_poles: bool = False
    cyclists: tuple[Share, ...] = ()


@dataclass(frozen=True)
class Buildings:
    """What houses are like unless the brief names a style.

    Attributes
    ----------
    family
        Style family, one of `cityx.assets.styles.palette_tables.STYLES`.
    generators
        Use group -> weights of generators, where they are not those of the family; merged.
    pitched
        Surfaces of sloping roofs; () for those of the family.
    flat_roofs, flat_roofs_town
        Weight of flat roofs beside that of all other shapes, everywhere and within towns.
    """

    family: str = "european"
    generators: Mapping[str, Weights] = field(default_factory=dict, metadata=MERGED)
    pitched: Surfaces = ()
    flat_roofs: Amount = 0.0
    flat_roofs_town: Amount = 0.0


@dataclass(frozen=True)
class Shops:
    """Shopfronts and their signs.

    Attributes
    ----------
    tongue
        Language of the words over shops without a name, "" for words that the world knows.
    fronts
        Weights of the fronts of newer houses, in the order of `cityx.building.shops.shops.FRONTS`.
    stacked_signs
        Whether signs stand above each other up the corners of trading streets.
    """

    tongue: str = ""
    fronts: tuple[Amount, ...] = (0.06, 0.52, 0.20, 0.16, 0.06)
    stacked_signs: bool = False


@dataclass(frozen=True)
class Trees:
    """Which trees grow, by climate: "tropic", "warm", "japan", "temperate" or "north".

    Attributes
    ----------
    climate
        (degrees of latitude, name) from the equator to the poles: the first whose degrees are not
        reached holds.
    usual
        The climate of cities that have this profile though they lie elsewhere.
    street, park, broad, needle, orchard
        Climate -> weights of species along streets, in parks, in woods of either kind, in orchards;
        merged.
    conifers
        Climate -> share of the patches of woods that are conifers; merged.
    yards
        Climate -> factor of how many plants yards have; merged.
    clipped
        Whether street trees are clipped, with high stems right behind the kerb.
    """

    climate: tuple[tuple[Amount, str], ...] = ()
    usual: str = "temperate"
    street: Mapping[str, Weights] = field(default_factory=dict, metadata=CLOSED)
    park: Mapping[str, Weights] = field(default_factory=dict, metadata=CLOSED)
    broad: Mapping[str, Weights] = field(default_factory=dict, metadata=CLOSED)
    needle: Mapping[str, Weights] = field(default_factory=dict, metadata=CLOSED)
    orchard: Mapping[str, Weights] = field(default_factory=dict, metadata=CLOSED)
    conifers: Mapping[str, Share] = field(default_factory=dict, metadata=CLOSED)
    yards: Weights = field(default_factory=dict, metadata=CLOSED)
    clipped: bool = False


@dataclass(frozen=True)
class Land:
    """What lies between carriageways and houses.

    Attributes
    ----------
    paving
        Surface of the ground -> its material, where it is not the usual one.
    guided
        Whether a line of ribs leads along the walks of main streets, and forecourts differ.
    own_frontage
        Whether what lies before houses is private.
    wall_gap
        Metres from walls that stay free of plots.
    plots, courts
        Weights of what plots along streets and courts behind houses are made of.
    soft_edges, paved_edges
        Weights of what closes off plots with soil and paved ones.
    """

    paving: Mapping[str, str] = field(default_factory=dict)
    guided: bool = False
    own_frontage: bool = False
    wall_gap: Amount = 2.0
    plots: Weights = field(default_factory=dict)
    courts: Weights = field(default_factory=dict)
    soft_edges: Weights = field(default_factory=dict)
    paved_edges: Weights = field(default_factory=dict)


@dataclass(frozen=True)
class Furniture:
    """What stands on walks and in yards.

    Attributes
    ----------
    pieces
        Usual piece -> what stands for it; merged.
    rates
        Piece -> factor of how often there is one along kerbs; merged.
    corner_bollards
        Share of the corners that bollards guard.
    past_junctions
        Weights of what stands past side streets on wide walks.
    plot_rows
        Weights of what stands in rows along the edges of plots.
    forecourts, forecourt_edges, forecourt_middles
        Weights of groups before houses: at walls, along the outer edge, and amid deep ones.
    yards, yard_walls, walk_walls
        Weights of what stands free in yards, at their walls, and at walls beside walks.
    narrow_walks
        Whether things stand at the walls of narrow walks, whose kerbs bear poles alone: pots,
        machines, banners.
    lot_fittings
        Whether bays of yards end in stops, with a board beside them.
    """

    pieces: Mapping[str, str] = field(default_factory=dict, metadata=MERGED)
    rates: Weights = field(default_factory=dict, metadata=MERGED)
    corner_bollards: Share = 0.3
    past_junctions: Weights = field(default_factory=dict)
    plot_rows: Weights = field(default_factory=dict)
    forecourts: Weights = field(default_factory=dict)
    forecourt_edges: Weights = field(default_factory=dict)
    forecourt_middles: Weights = field(default_factory=dict)
    yards: Weights = field(default_factory=dict)
    yard_walls: Weights = field(default_factory=dict)
    walk_walls: Weights = field(default_factory=dict)
    narrow_walks: bool = False
    lot_fittings: bool = False


@dataclass(frozen=True)
class Vehicles:
    """Which cars there are.

    Attributes
    ----------
    cars, vans
        Weights of bodies.
    plates
        Number plates, a key of `cityx.assets.vehicles.number_plates.PLATES`.
    """

    cars: Weights = field(default_factory=dict)
    vans: Weights = field(default_factory=dict)
    plates: str = ""


@dataclass(frozen=True, eq=False)
class Rules:
    """Everything that a place decides.

    Attributes
    ----------
    drive
        The side one drives on.
    streets, painting, buildings, shops, trees, land, furniture, vehicles
        See their classes.
    """

    drive: Literal["left", "right"] = "right"
    streets: Streets = Streets()
    painting: Painting = field(default_factory=Painting)
    buildings: Buildings = Buildings()
    shops: Shops = Shops()
    trees: Trees = Trees()
    land: Land = Land()
    furniture: Furniture = Furniture()
    vehicles: Vehicles = Vehicles()


@dataclass(frozen=True, eq=False)
class Profile(Rules):
    """What a place decides, with nothing left open.

    Attributes
    ----------
    lineage
        Names of the profile and of those it inherits, from the last to "world".
    """

    lineage: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """Name of the profile, "own" for one of the user's."""
        return self.lineage[0]


@dataclass(frozen=True, eq=False, kw_only=True)
class Part(Rules):
    """What a profile says of a part of its country.

    Attributes
    ----------
    box
        South, west, north, east, degrees.
    """

    box: tuple[Latitude, Longitude, Latitude, Longitude]


@dataclass(frozen=True, eq=False)
class Written(Rules):
    """What a file of a profile may say; see docs/places.md.

    Attributes
    ----------
    inherits
        Name of the profile that holds where this one says nothing.
    within
        Parts of the country that differ.
    """

    inherits: str = TOP
    within: tuple[Part, ...] = ()
