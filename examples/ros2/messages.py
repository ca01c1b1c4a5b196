"""Messages of ROS 2 as plain data, and what the bridge tells as such messages; needs no ROS.

The fields are those of nav_msgs/Odometry, sensor_msgs/LaserScan, sensor_msgs/Image,
rosgraph_msgs/Clock and geometry_msgs/Twist. Frames follow REP 103 and 105 as the city does: x east,
y north, z up; of the robot x ahead, y left.
"""

from dataclasses import dataclass, field, fields, is_dataclass
from math import cos, inf, pi, radians, sin

import numpy as np

WORLD, BODY, SCANNER, CAMERA = "odom", "base_link", "laser", "camera"
RINGS, REACH = 16, 50.0  # of the LiDAR of CityX: rings from -15 to 15 degrees, and metres
LEVEL = 8  # the ring that is nearest to level, of those that look up
UP = radians(-15.0 + LEVEL * 30.0 / (RINGS - 1))
NEAREST = 0.05  # metres
TOP, TURN = 1.7, 1.8  # m/s and radians per second of the robot of `CityX/Deliver-v0`


@dataclass
class Time:
    """builtin_interfaces/Time."""

    sec: int = 0
    nanosec: int = 0


@dataclass
class Header:
    """std_msgs/Header."""

    stamp: Time = field(default_factory=Time)
    frame_id: str = ""


@dataclass
class Vector3:
    """geometry_msgs/Vector3, and geometry_msgs/Point, which has the same fields."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0


@dataclass
class Quaternion:
    """geometry_msgs/Quaternion."""

    x: float = 0.0
    y: float = 0.0
    z: float = 0.0
    w: float = 1.0


@dataclass
class Pose:
    """geometry_msgs/Pose."""

    position: Vector3 = field(default_factory=Vector3)
    orientation: Quaternion = field(default_factory=Quaternion)


@dataclass
class Twist:
    """geometry_msgs/Twist."""

    linear: Vector3 = field(default_factory=Vector3)
    angular: Vector3 = field(default_factory=Vector3)


@dataclass
class PoseWithCovariance:
    """geometry_msgs/PoseWithCovariance; the covariance stays zero, since it is exact."""

    pose: Pose = field(default_factory=Pose)


@dataclass
class TwistWithCovariance:
    """geometry_msgs/TwistWithCovariance, as the one above."""

    twist: Twist = field(default_factory=Twist)


@dataclass
class Odometry:
    """nav_msgs/Odometry."""

    header: Header = field(default_factory=Header)
    child_frame_id: str = ""
    pose: PoseWithCovariance = field(default_factory=PoseWithCovariance)
    twist: TwistWithCovariance = field(default_factory=TwistWithCovariance)


@dataclass
class LaserScan:
    """sensor_msgs/LaserScan."""

    header: Header = field(default_factory=Header)
    angle_min: float = 0.0
    angle_max: float = 0.0
    angle_increment: float = 0.0
    time_increment: float = 0.0
    scan_time: float = 0.0
    range_min: float = 0.0
    range_max: float = 0.0
    ranges: list[float] = field(default_factory=list)
    intensities: list[float] = field(default_factory=list)


@dataclass
class Image:
    """sensor_msgs/Image."""

    header: Header = field(default_factory=Header)
    height: int = 0
    width: int = 0
    encoding: str = ""
    is_bigendian: int = 0
    step: int = 0
    data: bytes = b""


@dataclass
class Clock:
    """rosgraph_msgs/Clock."""

    clock: Time = field(default_factory=Time)


def time_of(seconds: float) -> Time:
    """Return seconds as ROS has them."""
    whole = round(seconds * 1e9)
    return Time(whole // 1_000_000_000, whole % 1_000_000_000)


def odometry_of(pose: dict[str, float], seconds: float) -> Odometry:
    """Return where the robot truly is; its velocity is told in its own frame."""
    half = pose["heading"] / 2
    place = Vector3(pose["x"], pose["y"], pose["z"])
    there = Pose(place, Quaternion(0.0, 0.0, sin(half), cos(half)))
    moves = Twist(Vector3(pose["speed"], 0.0, 0.0), Vector3(0.0, 0.0, pose["yaw_rate"]))
    return Odometry(Header(time_of(seconds), WORLD), BODY, PoseWithCovariance(there),
                    TwistWithCovariance(moves))  # fmt: skip


def scan_of(lidar: np.ndarray, seconds: float, dt: float) -> LaserScan:
    """Return the level ring of a sweep, (rings, n) shares of `REACH`, as a scan.

    Rays of CityX go clockwise from straight ahead; those of a scan go the other way, from behind.
    Where nothing is met the range is infinite (REP 117).
    """
    ring = lidar[LEVEL].astype(float) * REACH * cos(UP)
    count = len(ring)
    ahead_first = np.roll(ring[::-1], 1)  # against the clock, the first straight ahead
    ranges = np.roll(ahead_first, count // 2)
    met = ranges < REACH * cos(UP) * 0.999
    return LaserScan(
        Header(time_of(seconds), SCANNER), -pi, pi - 2 * pi / count, 2 * pi / count, 0.0, dt,
        NEAREST, REACH, np.where(met, ranges, inf).tolist(),
    )  # fmt: skip


def image_of(rgb: np.ndarray, seconds: float) -> Image:
    """Return a picture, (h, w, 3) uint8."""
    height, width = rgb.shape[:2]
    return Image(Header(time_of(seconds), CAMERA), height, width, "rgb8", 0, 3 * width,
                 rgb.tobytes())  # fmt: skip


def action_of(linear_x: float, angular_z: float) -> list[float]:
    """Return the action that comes nearest to a wanted m/s ahead and radians per second.

    The robot does not go backwards.
    """
    turn = min(max(angular_z / TURN, -1.0), 1.0)
    return [turn, min(max(2.0 * linear_x / TOP - 1.0, -1.0), 1.0)]


def filled(message: object, plain: object) -> object:
    """Write plain data to a message of ROS, field by field, and return it."""
    for each in fields(plain):
        value = getattr(plain, each.name)
        if is_dataclass(value):
            filled(getattr(message, each.name), value)
        else:
            setattr(message, each.name, value)
    return message
