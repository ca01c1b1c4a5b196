"""The report that every city ships with, as data."""

from __future__ import annotations

import resource
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import shapely

from cityx.assets.styles.package_generators import outside_buildings, package_generators
from cityx.assets.vehicles.moving import mover_counts
from cityx.checks.body_checks import check_bodies
from cityx.checks.building_checks import check_buildings
from cityx.checks.check import Check, named
from cityx.checks.facade_checks import check_facades
from cityx.checks.fidelity import fidelity
from cityx.checks.furniture_checks import check_furniture, check_standing, check_trees
from cityx.checks.height_checks import check_heights
from cityx.checks.junction_checks import check_junctions
from cityx.checks.movement_checks import check_movement
from cityx.checks.predicates.building_predicates import is_built
from cityx.checks.predicates.words import TIMES, WEATHERS
from cityx.checks.shell_checks import check_meshes, check_shells, triangle_counts
from cityx.checks.street_checks import check_lanes, check_streets
from cityx.checks.terrain_checks import check_bounds, check_ground, check_terrain, fit_notes
from cityx.checks.town_checks import check_towns
from cityx.checks.walkway_checks import check_walkways
from cityx.city import City, Goal
from cityx.city.content import content_hash
from cityx.city.frame import NOWHERE
from cityx.city.layout import is_mesh
from cityx.errors import UsageError
from cityx.ids import id_text
from cityx.options import HowToRead
from cityx.places.countries import country_at
from cityx.places.profiles import profile_of
from cityx.sources.input_kinds import is_map
from cityx.system.extensions import extensions, refusals, refuse, remembered, tried
from cityx.system.stopwatch import Stopwatch
from cityx.version import __version__

GROUP = "cityx.checks"
FAILED_SHARE = 0.01  # of all buildings; more, and something is wrong with the input or with us


def run_checks(city: City) -> list[Check]:
    """Measure a city against every limit."""
    return [
        *check_buildings(city),
        *check_shells(city),
        *check_facades(city),
        *check_ground(city),
        *check_furniture(city),
        *check_standing(city),
        *check_bodies(city),
        *check_lanes(city),
        *check_walkways(city),
        *check_heights(city),
        *check_streets(city),
        *check_terrain(city),
        *check_towns(city.layout),
        *check_trees(city),
        *check_junctions(city),
        *check_meshes(city),
        *check_bounds(city),
        *check_movement(city),
        _failed(city),
        _vanished(city),
        *_outside(city),
    ]


@remembered
def outside_checks() -> Mapping[str, Callable[[City], object]]:
    """Return the checks that installed packages add, by name."""

    def admit(value: object) -> tuple[str, Callable[[City], object]]:
        name = getattr(value, "__name__", "")
        if not callable(value) or not name.isidentifier():
            raise UsageError("it is no function of a city that returns cityx.checks.check.Check.")
        return name, value

    return extensions(GROUP, admit, frozenset[str]().__contains__)


def _outside(city: City) -> list[Check]:
    """Run the checks of other packages; one that fails is left out and says why."""
    found: list[Check] = []
    for name, measure in outside_checks().items():
        made, why = tried(partial(measure, city))
        if why:
            refuse(f"Check {name} could not be run: {why}.")
        elif isinstance(made, Check):
            found.append(replace(made, name=name))
        else:
            refuse(f"Check {name} returned {type(made).__name__}, not Check. It was left out.")
    return found


def _failed(city: City) -> Check:
    wanted = len(city.layout.buildings)
    missing = wanted - built_count(city)
    return Check(
        "buildings_missing",
        missing / max(wanted, 1),
        FAILED_SHARE,
        "share of the layout's buildings that have no shape in the scene",
    )


def _vanished(city: City) -> Check:
    ids = city.layout.buildings["id"].to_numpy()[~is_built(city)]
    lost = ids[~np.isin(ids, [failure.object_id for failure in city.failures])]
    return Check(
        "buildings_vanished",
        float(len(lost)),
        0,
        "the layout's buildings that have no shape in the scene and no reason in the report",
        ids=named(lost),
    )


def make_report(
    city: City,
    *,
    inputs: Iterable[Mapping[str, Any]] = (),
    brief: Mapping[str, Any] | None = None,
    watch: Stopwatch | None = None,
    peak_rss_mb: float | None = None,
    content: str = "",
    files: Iterable[Path] = (),
    how: HowToRead | None = None,
) -> dict[str, Any]:
    """Make the report of a city; see the schema in the documentation.

    Parameters
    ----------
    inputs
        What was read: name, kind, size in bytes, SHA-256.
    brief
        The options the user gave.
    watch
        Seconds of the steps so far, to which those of the report are added.
    peak_rss_mb
        Largest memory of any process of the build; measured for this process when left out.
    content
        Hash of the city, where it is known.
    files
        What was read, for goals that compare the city with it and for the fidelity to maps.
    how
        What the user says of these files.
    """
    files, watch = list(files), watch or Stopwatch()
    with watch.step("checks"):
        own = run_checks(city)
    taken: dict[str, Check] = {}
    for check in own:  # a check of a package does not take the place of one of CityX
        if check.name in taken:
            refuse(f"Check {check.name}: the name is taken by CityX. It was left out.")
        taken.setdefault(check.name, check)
    checks = list(taken.values())
    with watch.step("goals"):
        goals = _goals(city, brief or {}, {path.name.lower(): path for path in files}, how)
    with watch.step("fidelity"):
        kept = [{"map": path.name, **fidelity(city, path)} for path in files if is_map(path)]
    with watch.step("counts"):
        held = {
            "counts": counts(city),
            "generators": generators_of(city),
            "made": {action: dict(args) for action, args in city.made.items()},
            "triangles": triangle_counts(city),
        }
    return {
        "cityx": __version__,
        "name": city.name,
        "seed": city.seed,
        "lod": city.lod,
        "hash": content or content_hash(city).total,
        "area_km2": round(city.layout.area_km2, 4),
        "frame": {
            "latitude": city.frame.latitude,
            "longitude": city.frame.longitude,
            "projection": city.frame.projection,
        },
        "place": _place(city),
        "extent": list(city.layout.extent),
        "inputs": [dict(item) for item in inputs],
        "attribution": list(city.attribution),
        "brief": dict(brief or {}),
        "goals": goals,
        "fidelity": kept,
        **held,
        **watch.told(),
        "peak_rss_mb": round(peak_rss_mb if peak_rss_mb is not None else peak_memory_mb(), 1),
        "checks": check_table(checks),
        "failures": [
            {"id": id_text(failure.object_id), "action": failure.action, "error": failure.error}
            for failure in city.failures
        ],
        "notes": [*city.notes, *fit_notes(city), *refusals()],
    }


def check_table(checks: Iterable[Check]) -> dict[str, Any]:
    """Return checks as a report holds them, by name; the first of a name counts."""
    table: dict[str, Any] = {}
    for check in checks:
        item = {
            "value": _number(check.value),
            "limit": check.limit,
            "ok": check.ok,
            "meaning": check.meaning,
            "bound": "at least" if check.at_least else "at most",
            **({"ids": list(check.ids)} if check.ids else {}),
        }
        table.setdefault(check.name, item)
    return table


def _number(value: float) -> float | str:
    return round(float(value), 9) if np.isfinite(value) else str(value)


def _goals(
    city: City, brief: Mapping[str, Any], files: Mapping[str, Path], how: HowToRead | None
) -> list[dict[str, Any]]:
    implied = [
        ("buildings stand", built_count(city) > 0 or not len(city.layout.buildings),
         f"{built_count(city)} of {len(city.layout.buildings)} buildings of the layout are built"),
        ("the ground is closed", city.ground is not None,
         f"{0 if city.ground is None else len(city.ground.face_label)} faces"),
    ]  # fmt: skip
    rows = [{"goal": goal, "met": met, "evidence": evidence} for goal, met, evidence in implied]
    asked = [*_brief_goals(brief), *city.goals]
    if not asked:  # most builds: what measures is not even loaded
        return rows
    from cityx.checks.predicates import measure_all

    findings = measure_all((goal.predicate for goal in asked), city, inputs=files, how=how)
    rows += [
        {"goal": goal.text, "met": finding.met, "evidence": finding.evidence,
         "predicate": goal.predicate, "hard": goal.hard}
        for goal, finding in zip(asked, findings, strict=True)
    ]  # fmt: skip
    return rows


def _brief_goals(brief: Mapping[str, Any]) -> list[Goal]:
    """Return what the options of a build ask for that can be measured."""
    word = str(brief.get("weather") or "").lower()
    if word in WEATHERS:
        return [Goal(f"weather is {word}", f"env.weather == {word}")]
    return [Goal(f"it is {word}", f"env.time == {word}")] if word in TIMES else []


def report_passed(report: Mapping[str, Any]) -> bool:
    """Return whether all checks hold, no hard goal is missed and no file shows another city.

    Goals that were not measured are not missed. Pictures show the city as it was when they were
    taken, and files of which it is not known what they show are named alone.
    """
    stale = report.get("stale_views", {})
    return (
        all(check["ok"] for check in report["checks"].values())
        and not any(goal["met"] is False and goal.get("hard", True) for goal in report["goals"])
        and all(made is None or name.startswith("renders/") for name, made in stale.items())
    )


def peak_memory_mb() -> float:
    """Return the largest resident memory of this process and its children so far, in MB."""
    usage = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    return max(resource.getrusage(who).ru_maxrss for who in usage) / 1024


def _place(city: City) -> dict[str, Any]:
    """Return the country of a city and the profile that decides what it looks like."""
    frame, profile = city.frame, profile_of(city.frame)
    return {
        "country": country_at(frame.latitude, frame.longitude) if frame != NOWHERE else "",
        "profile": list(profile.lineage),
        "drive": profile.drive,
    }


def counts(city: City) -> dict[str, float]:
    """Count what the city holds."""
    roads = city.layout.roads
    length = shapely.length(roads.geometry.to_numpy()).sum() / 1000 if len(roads) else 0.0
    rows = city.scene.instances
    network = city.network
    moving = mover_counts(city.tracks, city.moment)
    junctions = 0 if network is None else int(np.count_nonzero(network.node_degree >= 3))
    return {
        "buildings": built_count(city),
        "buildings_failed": _failed_buildings(city),
        "road_km": round(float(length), 3),
        "junctions": junctions,
        "trees": rows["trees"].count if "trees" in rows else 0,
        "windows": rows["windows"].count if "windows" in rows else 0,
        "instances": sum(table.count for table in rows.values()),
        "prototypes": len(city.scene.prototypes),
        "vehicles": (rows["vehicles"].count if "vehicles" in rows else 0) + moving["vehicles"],
        "pedestrians": moving["pedestrians"],
    }


def generators_of(city: City) -> dict[str, dict[str, int | str]]:
    """Count the buildings of each generator; of one from a package, say which action made them."""
    names = city.layout.buildings["generator"].to_numpy(str)
    known, count = np.unique(names[names != ""], return_counts=True)
    found: dict[str, dict[str, int | str]] = {}
    owner = city.layout.parts["building"].to_numpy(np.uint64)[is_mesh(city.layout)]
    meshes = set(names[np.isin(city.layout.buildings["id"].to_numpy(np.uint64), owner)].tolist())
    for name, number in zip(known.tolist(), count.tolist(), strict=True):
        found[name] = {"buildings": number}
        whole = name in meshes or name in package_generators()
        made = outside_buildings().get(name) if whole else None
        if made is not None:
            found[name] |= {"action": made.action, "package": made.package}
    return found


def _failed_buildings(city: City) -> int:
    failed = {failure.object_id for failure in city.failures}
    return int(np.isin(city.layout.buildings["id"].to_numpy(), list(failed)).sum()) if failed else 0


def built_count(city: City) -> int:
    """Count buildings with a shape: shells of their own, and assets of the library."""
    batch, rows = city.scene.meshes.get("buildings"), city.scene.instances.get("building_assets")
    return (0 if batch is None else batch.count) + (0 if rows is None else rows.count)
