"""The node of the ROS 2 example, with stand-ins of rclpy whose messages have ROS's fields alone."""

import runpy
import sys
import threading
from math import cos, inf, pi, sin
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest

from cityx.sim.bridge.server import Desk, serve

EXAMPLE = Path(__file__).parents[2] / "examples/ros2"
# As `ros2 interface show` prints them; a message takes no field but its own.
FIELDS = {
    "builtin_interfaces/Time": {"sec": int, "nanosec": int},
    "std_msgs/Header": {"stamp": "builtin_interfaces/Time", "frame_id": str},
    "geometry_msgs/Vector3": {"x": float, "y": float, "z": float},
    "geometry_msgs/Point": {"x": float, "y": float, "z": float},
    "geometry_msgs/Quaternion": {"x": float, "y": float, "z": float, "w": float},
    "geometry_msgs/Pose": {"position": "geometry_msgs/Point",
                           "orientation": "geometry_msgs/Quaternion"},
    "geometry_msgs/Twist": {"linear": "geometry_msgs/Vector3", "angular": "geometry_msgs/Vector3"},
    "geometry_msgs/PoseWithCovariance": {"pose": "geometry_msgs/Pose", "covariance": list},
    "geometry_msgs/TwistWithCovariance": {"twist": "geometry_msgs/Twist", "covariance": list},
    "nav_msgs/Odometry": {"header": "std_msgs/Header", "child_frame_id": str,
                          "pose": "geometry_msgs/PoseWithCovariance",
                          "twist": "geometry_msgs/TwistWithCovariance"},
    "sensor_msgs/LaserScan": {"header": "std_msgs/Header", "angle_min": float, "angle_max": float,
                              "angle_increment": float, "time_increment": float,
                              "scan_time": float, "range_min": float, "range_max": float,
                              "ranges": list, "intensities": list},
    "sensor_msgs/Image": {"header": "std_msgs/Header", "height": int, "width": int,
                          "encoding": str, "is_bigendian": int, "step": int, "data": bytes},
    "rosgraph_msgs/Clock": {"clock": "builtin_interfaces/Time"},
}  # fmt: skip


def message_class(name):
    """Return a class that takes the fields of a message alone, each of its kind."""
    kinds = FIELDS[name]

    class Message:
        def __init__(self):
            for each, kind in kinds.items():
                own = message_class(kind)() if isinstance(kind, str) else kind()
                object.__setattr__(self, each, own)

        def __setattr__(self, each, value):
            assert type(value) is kinds[each], (name, each, value)
            object.__setattr__(self, each, value)

    return Message


class Publisher(list):
    publish = list.append


class Node:
    """What of rclpy's node the example uses."""

    given = {}  # noqa: RUF012

    def __init__(self, _name):
        self.parameters, self.topics, self.said = {}, {}, []

    def declare_parameter(self, name, usual):
        self.parameters[name] = self.given.get(name, usual)

    def get_parameter(self, name):
        return SimpleNamespace(value=self.parameters[name])

    def create_publisher(self, _kind, topic, _queue):
        self.topics[topic] = Publisher()
        return self.topics[topic]

    def create_subscription(self, _kind, topic, hear, _queue):
        self.topics[topic] = hear

    def create_service(self, _kind, name, answer):
        self.topics[name] = answer

    def create_timer(self, seconds, _step):
        self.every = seconds

    def get_logger(self):
        return SimpleNamespace(info=self.said.append)


def module(name, **held):
    found = ModuleType(name)
    found.__dict__.update(held)
    return found


@pytest.fixture
def city_robot(town, tmp_path, monkeypatch):
    """Return the node of the example, beside a server of the small town."""
    stands = {
        "rclpy": module("rclpy"), "rclpy.node": module("rclpy.node", Node=Node),
        "std_srvs.srv": module("std_srvs.srv", Trigger=SimpleNamespace(Request=0, Response=0)),
    }  # fmt: skip
    for name in ("geometry_msgs/Twist", "nav_msgs/Odometry", "rosgraph_msgs/Clock",
                 "sensor_msgs/Image", "sensor_msgs/LaserScan"):  # fmt: skip
        package, own = name.split("/")
        held = stands.setdefault(f"{package}.msg", module(f"{package}.msg"))
        setattr(held, own, message_class(name))
    for name, held in stands.items():
        monkeypatch.setitem(sys.modules, name, held)
    monkeypatch.syspath_prepend(EXAMPLE)
    monkeypatch.delitem(sys.modules, "messages", raising=False)
    ends, address = threading.Event(), f"ipc://{tmp_path}/sim"
    thread = threading.Thread(
        target=serve, args=(Desk(town, {"traffic": 2}), address),
        kwargs={"say": list, "ends": ends.is_set},
    )  # fmt: skip
    thread.start()
    monkeypatch.setattr(Node, "given", {"address": address, "people": 2, "camera": True})
    node = runpy.run_path(str(EXAMPLE / "node.py"))["CityRobot"]()
    yield node
    node.close()
    ends.set()
    thread.join()


def commanded(node, linear, angular):
    twist = message_class("geometry_msgs/Twist")()
    twist.linear.x, twist.angular.z = linear, angular
    node.topics["/cmd_vel"](twist)


def test_the_node_tells_what_the_robot_does(city_robot):
    node = city_robot
    assert node.every == pytest.approx(0.1)
    for step in range(12):
        if step < 3:
            commanded(node, 0.5, 0.9)
        node.step()
    clock = [each.clock.sec + each.clock.nanosec / 1e9 for each in node.topics["/clock"]]
    assert clock == pytest.approx([0.1 * k for k in range(13)])
    odometry = node.topics["/odom"]
    places = np.array([[each.pose.pose.position.x, each.pose.pose.position.y]
                       for each in odometry])  # fmt: skip
    turn = [2 * np.arctan2(each.pose.pose.orientation.z, each.pose.pose.orientation.w)
            for each in odometry]  # fmt: skip
    moves = odometry[3].twist.twist
    assert moves.linear.x == pytest.approx(0.5)
    assert moves.angular.z == pytest.approx(0.9)
    assert turn[3] - turn[0] == pytest.approx(0.27)
    way = places[3] - places[2]
    middle = (turn[2] + turn[3]) / 2
    assert way == pytest.approx([0.05 * cos(middle), 0.05 * sin(middle)], abs=2e-3)
    # A command is heard for half a second; then the robot stands.
    assert odometry[-1].twist.twist.linear.x == 0.0
    assert odometry[0].header.frame_id == "odom"
    assert odometry[0].child_frame_id == "base_link"
    scan = node.topics["/scan"][-1]
    assert len(scan.ranges) == 180
    assert scan.angle_min + 179 * scan.angle_increment == pytest.approx(scan.angle_max)
    assert all(scan.range_min < each <= scan.range_max or each == inf for each in scan.ranges)
    image = node.topics["/camera/image_raw"][-1]
    assert (image.height, image.width, image.encoding) == (84, 84, "rgb8")
    assert len(image.data) == image.height * image.step
    assert np.frombuffer(image.data, np.uint8).std() > 0


def test_a_reset_begins_the_next_episode(city_robot):
    node = city_robot
    before = node.topics["/odom"][-1].pose.pose.position
    told = node.topics["/reset"](None, SimpleNamespace(success=False, message=""))
    after = node.topics["/odom"][-1].pose.pose.position
    assert told.success
    assert (before.x, before.y) != (after.x, after.y)


def test_rays_of_a_scan_begin_behind_and_go_against_the_clock():
    plain = runpy.run_path(str(EXAMPLE / "messages.py"))
    lidar = np.ones((16, 180), np.float32)
    lidar[8, 45] = 0.2  # 45 x 2 degrees clockwise from ahead: to the right
    scan = plain["scan_of"](lidar, 1.25, 0.1)
    met = [k for k, each in enumerate(scan.ranges) if each < inf]
    assert len(met) == 1
    assert scan.angle_min + met[0] * scan.angle_increment == pytest.approx(-pi / 2)
    assert scan.ranges[met[0]] == pytest.approx(10.0, abs=0.01)
    assert (scan.header.stamp.sec, scan.header.stamp.nanosec) == (1, 250_000_000)


def test_commands_beyond_what_the_robot_can_do_are_bounded():
    plain = runpy.run_path(str(EXAMPLE / "messages.py"))
    assert plain["action_of"](9.0, -9.0) == [-1.0, 1.0]
    assert plain["action_of"](-1.0, 0.0) == [0.0, -1.0]
    assert plain["action_of"](0.85, 0.9) == pytest.approx([0.5, 0.0])
