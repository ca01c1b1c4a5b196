"""Whether the words of a place's profile are those of things that exist."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

from cityx.city.frame import NOWHERE
from cityx.errors import UsageError, nearest
from cityx.places.profile import Profile
from cityx.places.profiles import place_text, profile_of

# Words of `cityx.places.painting.Painting`.
PAINTED = {
    "give_way": ("teeth", "dashes", "double dashes", "stop"),
    "signal_crossing": ("bars", "lines", "studs"),
    "turn_guides": ("", "both", "outer"),
    "parking": ("stalls", "outline", "line"),
}
MINOR_SIGNS = ("sign_give_way", "sign_stop")


@dataclass
class _Check:
    faults: list[str] = field(default_factory=list)

    def words(self, key: str, said: Iterable[str], known: Iterable[str]) -> None:
        """Note every word that is not known."""
        known = list(known)
        self.faults += [
            f'{key} knows no "{word}".{nearest(word, known)}' for word in said if word not in known
        ]

    def weights(self, key: str, said: Mapping[str, float], known: Iterable[str]) -> None:
        """Note unknown words, and weights of which nothing can be drawn."""
        self.words(key, said, known)
        if not sum(said.values()) > 0:
            self.faults.append(f"{key} needs a weight above 0.")


def check_place(asked: str) -> None:
    """Check a profile that the user asks for: a name, or a TOML file.

    Raises
    ------
    InputError, UsageError
        With everything that is wrong with it.
    """
    check_words(profile_of(replace(NOWHERE, place=place_text(asked))))


def check_words(profile: Profile) -> None:
    """Check the words of a profile.

    Raises
    ------
    UsageError
        With every word that names nothing, and every table that nothing can be drawn from.
    """
    check = _Check()
    for part in (_buildings, _streets, _trees, _land, _furniture):
        part(check, profile)
    if check.faults:
        told = "\n".join(check.faults)
        raise UsageError(f'The profile "{profile.name}" cannot be used:\n{told}')


def _buildings(check: _Check, profile: Profile) -> None:
    from cityx.assets.styles.materials import MATERIALS
    from cityx.assets.styles.palette_tables import GROUPS, STYLES
    from cityx.building.catalogue import generators
    from cityx.building.shops.shop_names import shop_words
    from cityx.building.shops.shops import FRONTS

    own, shops = profile.buildings, profile.shops
    check.words("buildings.family", [own.family], STYLES)
    check.words("buildings.generators", own.generators, GROUPS)
    for group, weights in own.generators.items():
        check.weights(f"buildings.generators.{group}", weights, generators())
    check.words("buildings.pitched", [row[1] for row in own.pitched], MATERIALS)
    if own.pitched and not all(row[0] > 0 and row[2] for row in own.pitched):
        check.faults.append("buildings.pitched: every row needs a weight above 0 and a colour.")
    check.words("shops.tongue", [shops.tongue], ["", *shop_words().words])
    if len(shops.fronts) != len(FRONTS) or not sum(shops.fronts) > 0:
        check.faults.append(f"shops.fronts needs {len(FRONTS)} weights.")


def _streets(check: _Check, profile: Profile) -> None:
    from cityx.assets.vehicles.car_bodies import BODIES
    from cityx.assets.vehicles.number_plates import PLATES
    from cityx.city.ground import LABEL
    from cityx.road.markings.symbols import GLYPHS

    streets, painting, vehicles = profile.streets, profile.painting, profile.vehicles
    check.words("streets.minor_sign", [streets.minor_sign], MINOR_SIGNS)
    least = {"streets.lane_widths": min(streets.lane_widths.values())}
    least["painting.dashes"] = min(painting.dashes)
    check.faults += [f"{key} must be above 0." for key, value in least.items() if value <= 0]
    if len(streets.cyclists) not in (0, 2) or sum(streets.cyclists) > 1:
        check.faults.append("streets.cyclists needs two shares, or none.")
    for key, known in PAINTED.items():
        check.words(f"painting.{key}", [getattr(painting, key)], known)
    check.words("painting.stop_word", painting.stop_word, GLYPHS)
    surfaces = [painting.ribs.painted, painting.ribs.plain, painting.ribs.mouth]
    ribs = [name for name in LABEL if name.startswith("tactile")]
    check.words("painting.ribs", surfaces, ["", *ribs])
    for kind, bodies in (("car", vehicles.cars), ("van", vehicles.vans)):
        built = [name for name, body in BODIES.items() if body.kind == kind and not body.service]
        check.weights(f"vehicles.{kind}s", bodies, built)
    check.words("vehicles.plates", [vehicles.plates], PLATES)


def _trees(check: _Check, profile: Profile) -> None:
    from cityx.nature.trees.stands import INDEX

    trees = profile.trees
    for where in ("street", "park", "broad", "needle", "orchard"):
        for climate, weights in getattr(trees, where).items():
            check.weights(f"trees.{where}.{climate}", weights, INDEX)
    check.words("trees.climate", [name for _, name in trees.climate], trees.street)
    check.words("trees.usual", [trees.usual], trees.street)
    if not trees.climate or trees.climate[-1][0] <= 90:
        check.faults.append("trees.climate must end beyond 90 degrees.")


def _land(check: _Check, profile: Profile) -> None:
    from cityx.assets.styles.materials import MATERIALS
    from cityx.city.ground import LABEL
    from cityx.nature.land.barriers import KINDS
    from cityx.road.ground.paved_blocks import CHIPPED_WORD
    from cityx.road.ground.yards import LABELS

    land = profile.land
    check.words("land.paving", land.paving, LABEL)
    check.words("land.paving", land.paving.values(), [CHIPPED_WORD, *MATERIALS])
    check.weights("land.plots", land.plots, LABELS)
    check.weights("land.courts", land.courts, LABELS)
    check.weights("land.soft_edges", land.soft_edges, ["", *KINDS])
    check.weights("land.paved_edges", land.paved_edges, ["", *KINDS])


def _furniture(check: _Check, profile: Profile) -> None:
    from cityx.assets.furniture.street_furniture import MAKERS
    from cityx.ground.street_rules import KERB_RULES
    from cityx.nature.furniture.forecourts import GROUPS, OPEN_GROUPS
    from cityx.nature.furniture.plot_edges import SPACING

    own = profile.furniture
    check.words("furniture.pieces", own.pieces.values(), MAKERS)
    check.words("furniture.rates", own.rates, [rule.piece for rule in KERB_RULES])
    known: dict[str, Iterable[str]] = {
        "past_junctions": MAKERS, "plot_rows": SPACING, "forecourts": GROUPS,
        "forecourt_edges": OPEN_GROUPS, "forecourt_middles": OPEN_GROUPS, "yards": MAKERS,
        "yard_walls": MAKERS, "walk_walls": MAKERS,
    }  # fmt: skip
    for key, words in known.items():
        weights = getattr(own, key)
        check.weights(f"furniture.{key}", weights, ["", *words])
        if next(iter(weights), None) != "":
            check.faults.append(f'furniture.{key} must begin with "", how often there is nothing.')
