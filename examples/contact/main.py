"""Drive the robot of robot.xml at kerbs of a city, and over its crosswalks where they are lowered.

    python examples/contact/main.py CITY

CITY is the folder of a built city or a map file.
"""

import sys
import time
from pathlib import Path

import numpy as np

from cityx.sim.contact.ground import height_at, patch_of
from cityx.sim.contact.window import ContactWindow
from cityx.sim.places import scenery_of, walks_of
from cityx.sim.scenery import Scenery
from cityx.sim.travellers import TRAVELLER
from cityx.sim.world import World

ROBOT = Path(__file__).with_name("robot.xml")
AHEAD = [8.0] * 4  # radians per second of each wheel: 1 m/s
COUNT = 5


def drive(
    place: tuple[World, Scenery], at: np.ndarray, heading: float, seconds: float
) -> tuple[float, float, set[str], float]:
    """Drive straight on; returns metres gone, metres risen, what was touched, and steps/CPU s."""
    window = ContactWindow(place, ROBOT, at=at, heading=heading)
    before, touched = window.position, set()
    begun = time.process_time()
    for _ in range(round(10 * seconds)):
        window.step(AHEAD)
        touched |= set(window.touched())
    rate = 10 * seconds / (time.process_time() - begun)
    gone = window.position - before
    return float(np.hypot(*gone[:2])), float(gone[2]), touched - {"ground"}, rate


def main(city: str) -> None:
    """Tell of `COUNT` kerbs and crosswalks of a city."""
    world, walks = walks_of(city)
    place = world, scenery_of(city, world)
    rates = []
    for row in np.flatnonzero(walks.crossing_fits[:, TRAVELLER["robot"]])[:COUNT].tolist():
        begin, end = walks.crossing_ends[row]
        middle, ahead = (begin + end) / 2, end - begin
        gone, up, touched, rate = drive(place, middle, float(np.arctan2(ahead[1], ahead[0])), 4.0)
        rates.append(rate)
        print(f"crosswalk {row}: {gone:.2f} m, {up:+.2f} m up, touched {sorted(touched)}")
    middle = walks.crossing_ends[0].mean(axis=0) if len(walks.crossing_ends) else world.point[0, :2]
    ground = height_at(place[1], *middle)
    kerbs = patch_of(*place, np.array([*middle, ground]), 60.0).kerb
    for x, y, _, _, heading, _, drop in kerbs[(kerbs[:, 6] > 0.1) & (kerbs[:, 3] > 0.6)][:COUNT]:
        at = np.array([x, y]) - 0.8 * np.array([np.cos(heading), np.sin(heading)])
        gone, up, touched, rate = drive(place, at, float(heading), 3.0)
        rates.append(rate)
        print(f"kerb of {drop:.2f} m: {gone:.2f} m, {up:+.2f} m up, touched {sorted(touched)}")
    print(f"{np.mean(rates):.0f} steps of 0.1 s per second of processor time")


if __name__ == "__main__":
    main(sys.argv[1])
