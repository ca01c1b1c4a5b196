"""Seeded defects: how many of them the checks and the goals of a brief find, and name."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from cityx.checks.predicates import measure_all
from cityx.checks.report import run_checks
from cityx.city import City
from cityx.ids import hash_bits
from cityx_bench import planting, planting_streets
from cityx_bench.planting import HIGHER, LOWER, OUTDOORS, RISE, Plant, Planted

PLACES = 10  # of each kind
GOAL = "asked"  # stands for what was asked of the planted thing
# What may turn with a building that is moved: what stands and opens at its old and new place.
_MOVED = (
    "building_o", "building_in_street", "floating_", "building_buried", "building_height_off",
    "door_off_ground", "street_doors_missing", "windows_on_blind_walls", "trees_in_walls",
    "trees_before_doors", "crowns_in_facades", "identical_neighbours", "furniture_on_walkway",
    "plan_area_error", "outside_site", "kerb_radius", "cover(", "dist(", "around(", "n(",
    "share(",
)  # fmt: skip
_LESS = ("n(building", "share(", "stat(building", "cover(", "identical_neighbours", "around(",
         "dist(")  # fmt: skip
_SHELL = ("door_off_ground", "building_height_off", "street_doors_missing")
_HEIGHT = ("stat(building", "n(building", "share(building", "around(building")
_TREE = ("trees_in_walls", "crowns_in_facades", "trees_before_doors", "dist(", "around(",
         "spacing(")  # fmt: skip


@dataclass(frozen=True)
class Kind:
    """A kind of defect.

    Attributes
    ----------
    plant
        Puts one into a city.
    speaks
        Checks, or `GOAL`, that speak of it: one of them must turn.
    follows
        Beginnings of names of checks and goals that may turn with it, as they are true of it.
    """

    plant: Plant
    speaks: tuple[str, ...]
    follows: tuple[str, ...] = ()


KINDS: Mapping[str, Kind] = {
    "shell 30 % too high": Kind(planting.scaled(HIGHER), ("building_height_off",), _HEIGHT),
    "shell 30 % too low": Kind(planting.scaled(LOWER), ("building_height_off",), _HEIGHT),
    "tower below its bound": Kind(planting.low_tower, (GOAL,), _HEIGHT),
    "wrong material": Kind(planting.other_material, (GOAL,), ("share(", "identical_")),
    "wrong colour": Kind(planting.other_color, (GOAL,), ("share(", "identical_")),
    "wrong style share": Kind(planting.other_style, (GOAL,), ("share(", "identical_")),
    "building without mesh": Kind(
        planting.no_shell, ("buildings_vanished",), ("buildings_missing", "street_doors", *_LESS)
    ),
    "missing park": Kind(
        planting_streets.no_park, (GOAL,), ("n(", "around(", "dist(", "cover(", "share(")
    ),
    "wrong count": Kind(planting.fewer, (GOAL,), _LESS),
    "two buildings in one place": Kind(planting.overlapping, ("building_overlap",), _MOVED),
    "shell beside its footprint": Kind(
        planting.displaced, ("building_displaced",), ("floating_", "building_buried")
    ),
    "floating building": Kind(planting.lifted_building(RISE), ("floating_building",), _SHELL),
    "buried building": Kind(planting.lifted_building(-RISE), ("building_buried",),
                            (*_SHELL, "windows_on_blind")),
    "building in the road": Kind(planting.in_street, ("building_in_street",), _MOVED),
    "open solid": Kind(planting.open_solid, ("closed_solids",),
                       ("plan_area_error", "building_displaced")),
    "not a number": Kind(planting.not_a_number, ("not_finite",),
                         ("plan_area_error", "building_displaced", "floating_")),
    "window on a blind wall": Kind(planting.blind_window, ("windows_on_blind_walls",),
                                   ("identical_",)),
    "door away from the walk": Kind(planting.astray_door, ("street_doors_missing",),
                                    ("door_off_ground", "trees_before_doors")),
    "floating tree": Kind(planting.lifted(("trees",), RISE), ("things_off_ground",)),
    "buried tree": Kind(planting.lifted(("trees",), -RISE), ("things_off_ground",)),
    "floating furniture": Kind(planting.lifted(OUTDOORS, RISE), ("things_off_ground",)),
    "buried furniture": Kind(planting.lifted(OUTDOORS, -RISE), ("things_off_ground",)),
    "floating car": Kind(planting.lifted(("vehicles",), RISE), ("things_off_ground",)),
    "tree in the road": Kind(planting.on_carriageway(("trees",)),
                             ("trees_misplaced", "trees_in_lanes"),
                             ("things_off_ground", *_TREE)),
    "furniture in a lane": Kind(planting.on_carriageway(OUTDOORS), ("furniture_in_lanes",),
                                ("things_off_ground", "furniture_on_walkway")),
    "tree beyond the site": Kind(planting.beyond_site, ("outside_site",), _TREE),
    "wrong weather": Kind(planting.other_weather, (GOAL,), ("env.",)),
    "wrong time": Kind(planting.other_time, (GOAL,), ("env.", "sun_", "n(light", "share(light")),
    "river without its bridge": Kind(
        planting_streets.no_bridge, (GOAL,), ("n(", "crosses(", "road.")
    ),
    "bridge without its deck": Kind(planting_streets.no_deck, ("streets_without_surface",)),
    "junction paved as a walk": Kind(
        planting_streets.covered_junction, ("junctions_covered",),
        ("sidewalk_on_carriageway", "junction_s", "kerb_radius", "street_doors_missing",
         "furniture_on_walkway", "furniture_in_lanes"),
    ),
    "junction no lane leads over": Kind(
        planting_streets.closed_junction, ("junctions_closed",), ("lane_graph_pieces", "lanes_")
    ),
}  # fmt: skip
# Changes that are no defects: nothing may turn.
HARMLESS: Mapping[str, Plant] = {
    "repainted": planting_streets.repainted,
    "tree turned": planting_streets.turned_tree,
    "car less": planting_streets.one_less(("vehicles",)),
    "thing less": planting_streets.one_less(OUTDOORS),
    "minutes later": planting.five_minutes,
}

Alarms = Mapping[str, tuple[str, ...]]
"""Checks that fail and goals that are missed -> what they name."""


def alarms(city: City, goals: Iterable[str] = ()) -> dict[str, tuple[str, ...]]:
    """Run all checks and measure goals; return what fails."""
    asked = tuple(goals)
    found = {check.name: check.ids for check in run_checks(city) if not check.ok}
    missed = zip(asked, measure_all(asked, city), strict=True)
    return found | {goal: () for goal, finding in missed if finding.met is False}


@dataclass(frozen=True)
class Base:
    """A good city, with what fails in it already and the goals that it keeps.

    Attributes
    ----------
    name
        What the table calls it.
    city
        The city.
    goals
        Those of its brief that are met.
    known
        Alarms of the untouched city; they count against the checks once, as a negative.
    """

    name: str
    city: City
    goals: tuple[str, ...]
    known: Alarms


def base_of(name: str, city: City) -> Base:
    """Measure a good city."""
    asked = tuple(goal.predicate for goal in city.goals)
    findings = measure_all(asked, city)
    kept = tuple(goal for goal, found in zip(asked, findings, strict=True) if found.met)
    return Base(name, city, kept, alarms(city, kept))


@dataclass(frozen=True)
class Case:
    """One defect, or one harmless change, and what was said of it.

    Attributes
    ----------
    kind, base
        What was planted, "" for nothing or no defect, and in which city.
    found
        Whether a check or goal that speaks of it turned and named it.
    false
        Checks and goals that turned without a reason.
    turned
        All that turned.
    """

    kind: str
    base: str
    found: bool
    false: tuple[str, ...] = ()
    turned: Alarms = field(default_factory=dict)


def judge(name: str, base: Base, planted: Planted) -> Case | None:
    """Measure a city with a defect; None where what was asked did not hold before."""
    kind = KINDS[name]
    before = measure_all(planted.asked, base.city)
    if not all(finding.met for finding in before):
        return None
    after = alarms(planted.city, (*base.goals, *planted.asked))
    turned = {key: ids for key, ids in after.items() if ids != base.known.get(key)}
    speaks = (*kind.speaks, *planted.asked) if GOAL in kind.speaks else kind.speaks
    said = {key: ids for key, ids in turned.items() if key in speaks}
    found = any(not ids or not planted.names or set(ids) & set(planted.names)
                for ids in said.values())  # fmt: skip
    false = tuple(key for key in turned if key not in speaks and not key.startswith(kind.follows))
    return Case(name, base.name, found, false, turned)


def plant_all(bases: Sequence[Base], places: int = PLACES) -> list[Case]:
    """Plant every kind of defect at some places; cities without a place for it are passed over."""
    return [case for name in KINDS for case in plant_kind(name, bases, places)]


def plant_kind(name: str, bases: Sequence[Base], places: int = PLACES) -> list[Case]:
    """Plant one kind of defect at some places."""
    cases: list[Case] = []
    for key in range(2 * places):
        case = _planted(name, bases, key)
        if case is not None:
            cases.append(case)
        if len(cases) == places:
            break
    return cases


def _planted(name: str, bases: Sequence[Base], key: int) -> Case | None:
    """Plant one defect in the first city, in an order drawn by hash, that has a place for it."""
    order = sorted(bases, key=lambda base: hash_bits(0, f"defect/{name}/{base.name}", key))
    for base in order:
        planted = KINDS[name].plant(base.city, hash_bits(0, f"defect/{name}", key))
        case = judge(name, base, planted) if planted is not None else None
        if case is not None:
            return case
    return None


def untouched(bases: Sequence[Base]) -> list[Case]:
    """Return what is said of cities without a defect."""
    return [Case("", base.name, False, tuple(base.known), base.known) for base in bases]


def harmless(bases: Sequence[Base], places: int) -> list[Case]:
    """Return what is said of changes that are no defects, at some places of each kind."""
    cases = []
    for name, plant in HARMLESS.items():
        for key in range(places):
            order = sorted(bases, key=lambda base: hash_bits(0, f"{name}/{base.name}", key))
            pairs = ((base, plant(base.city, key)) for base in order)
            base, planted = next((b, p) for b, p in pairs if p is not None)
            after = alarms(planted.city, base.goals)
            turned = {check: ids for check, ids in after.items() if ids != base.known.get(check)}
            cases.append(Case("", f"{base.name}: {name}", False, tuple(turned), turned))
    return cases


@dataclass(frozen=True)
class Row:
    """Precision and recall of one kind.

    Attributes
    ----------
    kind
        Name of the kind.
    planted, found, false
        Defects, those of them found, and alarms of its checks where there was none of it.
    """

    kind: str
    planted: int
    found: int
    false: int

    @property
    def recall(self) -> float:
        """Share of the defects that was found."""
        return self.found / self.planted if self.planted else float("nan")

    @property
    def precision(self) -> float:
        """Share of the alarms that was right."""
        said = self.found + self.false
        return self.found / said if said else float("nan")


def rows_of(cases: Sequence[Case]) -> list[Row]:
    """Tabulate cases by kind, all kinds together in the last row."""
    rows = []
    for name, kind in KINDS.items():
        own = [case for case in cases if case.kind == name]
        false = sum(any(_is_of(key, kind) for key in case.false) for case in cases)
        rows.append(Row(name, len(own), sum(case.found for case in own), false))
    planted = [case for case in cases if case.kind]
    wrong = sum(bool(case.false) for case in cases)
    return [*rows, Row("all", len(planted), sum(case.found for case in planted), wrong)]


def _is_of(alarm: str, kind: Kind) -> bool:
    """Return whether an alarm concerns a kind of defect; goals concern what they say."""
    return alarm in kind.speaks


def table(rows: Sequence[Row]) -> str:
    """Write rows as a table."""
    lines = [f"{'kind':30}{'planted':>8}{'found':>7}{'false':>7}{'precision':>11}{'recall':>8}"]
    lines += [
        f"{row.kind:30}{row.planted:8d}{row.found:7d}{row.false:7d}"
        f"{row.precision:11.3f}{row.recall:8.3f}"
        for row in rows
    ]
    return "\n".join(lines)
