"""The city: the state that actions map to states."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from cityx.city.environment import Environment
from cityx.city.frame import Frame
from cityx.city.goals import Goal
from cityx.city.ground import Ground
from cityx.city.heights import WayHeights
from cityx.city.lanes import LaneGraph
from cityx.city.layout import Layout
from cityx.city.roads import RoadNetwork
from cityx.city.scene import Scene
from cityx.city.signals import Signals
from cityx.city.terrain import Survey, Terrain, flat_terrain
from cityx.city.tracks import Tracks


@dataclass(frozen=True)
class Failure:
    """One thing an action could not build.

    Attributes
    ----------
    object_id
        The object, 0 when there is none.
    action
        Id of the action.
    error
        What went wrong and what was done instead.
    """

    object_id: int
    action: str
    error: str


@dataclass(frozen=True, repr=False)
class City:
    """Everything known about one city; actions return a new one and never change the old.

    Attributes
    ----------
    name
        Name of the place, for titles.
    frame
        Where on Earth the scene frame lies.
    seed
        The seed all random streams are keyed by.
    lod
        Level of detail asked for, 0 to 3.
    style
        Style word asked for, or "".
    layout, terrain, network, heights, lanes, ground, scene, environment
        The parts; None until the action that makes them has run.
    tracks
        Where vehicles and people are over time, None when nothing moves.
    signals
        What traffic lights show over time, None until traffic needs them.
    moment
        Seconds into the tracks that a picture shows.
    survey
        What the height file says, None without one; the terrain is cut and filled for streets.
    attribution
        Texts that must be shown with the data, e.g. "© OpenStreetMap contributors, ODbL 1.0".
    stages_done
        Stages of the protocol that have run.
    made
        Actions that made its parts, in the order in which they ran last, each with its arguments:
        how a part is made again after something that it depends on has changed.
    failures, notes
        What could not be built; what a reader of the report should know.
    goals
        What was asked of it beyond what every city must have; the report measures them.
    """

    name: str
    frame: Frame
    layout: Layout
    seed: int = 0
    lod: int = 2
    style: str = ""
    terrain: Terrain = field(default_factory=flat_terrain)
    survey: Survey | None = None
    network: RoadNetwork | None = None
    heights: WayHeights | None = None
    lanes: LaneGraph | None = None
    ground: Ground | None = None
    scene: Scene = field(default_factory=Scene)
    tracks: Tracks | None = None
    signals: Signals | None = None
    moment: float = 0.0
    environment: Environment = field(default_factory=Environment)
    attribution: tuple[str, ...] = ()
    stages_done: frozenset[str] = frozenset()
    made: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    failures: tuple[Failure, ...] = ()
    notes: tuple[str, ...] = ()
    goals: tuple[Goal, ...] = ()

    def __repr__(self) -> str:
        """Return a dozen lines: where it lies and what it holds, by numbers."""
        west, south, east, north = self.layout.extent
        frame, network, scene, tracks = self.frame, self.network, self.scene, self.tracks
        meshes = sum(batch.count for batch in scene.meshes.values())
        placed = sum(rows.count for rows in scene.instances.values())
        heights = self.layout.buildings["height"]
        highest = f", up to {heights.max():.0f} m high" if len(heights) else ""
        lanes = f", {self.lanes.count} lanes" if self.lanes is not None else ""
        edges = f", {network.edge_count} edges" if network is not None else ""
        moving = f"{tracks.count} over {tracks.duration:.0f} s" if tracks is not None else "nothing"
        rows = {
            "site": f"{east - west:.0f} x {north - south:.0f} m at "
            f"{frame.latitude:.5f}, {frame.longitude:.5f}",
            "buildings": f"{len(heights)}{highest}",
            "roads": f"{len(self.layout.roads)} ways{edges}{lanes}",
            "areas": f"{len(self.layout.areas)}, {len(self.layout.points)} points",
            "ground": "none" if self.ground is None else f"{len(self.ground.face_label)} faces",
            "scene": f"{meshes} meshes, {placed} instances of {len(scene.prototypes)} prototypes",
            "moving": moving,
            "light": f"{self.environment.weather}, {self.environment.hour:.1f} h",
            "failures": f"{len(self.failures)}, {len(self.notes)} notes, {len(self.goals)} goals",
        }
        lines = [f'City "{self.name}", seed {self.seed}, level of detail {self.lod}']
        return "\n".join([*lines, *(f"  {name:<10}  {text}" for name, text in rows.items())])
