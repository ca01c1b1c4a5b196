"""What a city is made of: plain, frozen values. Engines and files are views of them."""

from cityx.city.city import City, Failure
from cityx.city.environment import Environment
from cityx.city.frame import Frame
from cityx.city.goals import Goal
from cityx.city.ground import SURFACES, Ground, Surface
from cityx.city.layout import Layout, empty_table, make_table
from cityx.city.mesh import MeshBatch, concatenate, one_mesh
from cityx.city.roads import RoadNetwork
from cityx.city.scene import Instances, Prototype, Scene
from cityx.city.terrain import Terrain, flat_terrain
from cityx.city.tracks import Tracks

__all__ = [
    "SURFACES",
    "City",
    "Environment",
    "Failure",
    "Frame",
    "Goal",
    "Ground",
    "Instances",
    "Layout",
    "MeshBatch",
    "Prototype",
    "RoadNetwork",
    "Scene",
    "Surface",
    "Terrain",
    "Tracks",
    "concatenate",
    "empty_table",
    "flat_terrain",
    "make_table",
    "one_mesh",
]
