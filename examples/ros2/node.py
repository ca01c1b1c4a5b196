"""A robot on the walks of a city, as a node of ROS 2: it takes /cmd_vel and tells what it senses.

    cityx sim MAP.osm --serve tcp://127.0.0.1:5555
    python node.py --ros-args -p address:=tcp://127.0.0.1:5555

It publishes /clock, /odom, /scan and, with -p camera:=true, /camera/image_raw, ten times in a
second of the simulation. -p rate:=2.0 runs it twice as fast as the clock on the wall. What comes
to /reset begins the next episode; so does the end of one.
"""

import messages as plain
import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Image, LaserScan
from std_srvs.srv import Trigger

from cityx.errors import CityxError
from cityx.sim.bridge.client import RemoteEnv

QUEUE = 10
FORGETS = 0.5  # seconds of the simulation after which a command counts no more


class CityRobot(Node):
    """The node; it steps the simulator, and no other."""

    def __init__(self) -> None:
        super().__init__("cityx_robot")
        for name, usual in (("address", "tcp://127.0.0.1:5555"), ("camera", False), ("rate", 1.0),
                            ("seed", 0), ("people", 20)):  # fmt: skip
            self.declare_parameter(name, usual)
        told = {name: self.get_parameter(name).value
                for name in ("address", "camera", "rate", "seed", "people")}  # fmt: skip
        self._camera = bool(told["camera"])
        sees = ["lidar", "rgb"] if self._camera else ["lidar"]
        self._env = RemoteEnv(told["address"], "deliver", observation=["walk", *sees],
                              people=told["people"])  # fmt: skip
        self._seconds = 0.0  # of the simulation; they go on over the ends of episodes
        self._wanted, self._heard = (0.0, 0.0), -FORGETS
        self._clock = self.create_publisher(Clock, "/clock", QUEUE)
        self._odometry = self.create_publisher(Odometry, "/odom", QUEUE)
        self._scan = self.create_publisher(LaserScan, "/scan", QUEUE)
        self._image = self.create_publisher(Image, "/camera/image_raw", QUEUE)
        self.create_subscription(Twist, "/cmd_vel", self.hear, QUEUE)
        self.create_service(Trigger, "/reset", self.begin_anew)
        self._tell(self._env.reset(seed=told["seed"])[0])
        self.create_timer(self._env.dt / told["rate"], self.step)

    def hear(self, message: Twist) -> None:
        """Take a command."""
        self._wanted = message.linear.x, message.angular.z
        self._heard = self._seconds

    def step(self) -> None:
        """Go on for a tenth of a second and tell what is sensed."""
        fresh = self._seconds - self._heard < FORGETS
        action = plain.action_of(*(self._wanted if fresh else (0.0, 0.0)))
        view, _, ended, late, info = self._env.step(action)
        self._seconds += self._env.dt
        self._tell(view)
        if ended or late:
            events = ", ".join(each["event"] for each in info["events"])
            self.get_logger().info(f"the episode ends: {events}")
            self._tell(self._env.reset()[0])

    def begin_anew(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        """Begin the next episode."""
        del request
        self._tell(self._env.reset()[0])
        response.success, response.message = True, "the next episode has begun"
        return response

    def _tell(self, view: dict) -> None:
        now = self._seconds
        self._clock.publish(plain.filled(Clock(), plain.Clock(plain.time_of(now))))
        there = plain.odometry_of(self._env.pose, now)
        self._odometry.publish(plain.filled(Odometry(), there))
        scan = plain.scan_of(view["lidar"], now, self._env.dt)
        self._scan.publish(plain.filled(LaserScan(), scan))
        if self._camera:
            self._image.publish(plain.filled(Image(), plain.image_of(view["rgb"], now)))

    def close(self) -> None:
        """Let the simulator's environment go."""
        self._env.close()


def main() -> None:
    """Run the node until it is interrupted."""
    rclpy.init()
    try:
        node = CityRobot()
    except CityxError as error:
        raise SystemExit(str(error)) from None
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    finally:
        node.close()
        node.destroy_node()


if __name__ == "__main__":
    main()
