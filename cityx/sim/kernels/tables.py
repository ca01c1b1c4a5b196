"""What kernels take: the map, the state and the rules, as tuples of arrays, and their rows."""

from __future__ import annotations

from typing import Any, NamedTuple

# Rows of `State.real`, (E, rows, N) float64.
REAL = (
    "x", "y", "z", "heading", "speed", "steer", "length", "width", "height", "along", "aside",
    "turned", "gone", "goal", "lift", "waited", "yaw_rate", "steer_action", "pedal_action", "limit",
)  # fmt: skip
(X, Y, Z, HEADING, SPEED, STEER, LENGTH, WIDTH, HEIGHT, ALONG, ASIDE, TURNED, GONE, GOAL, LIFT,
 WAITED, YAW_RATE, STEER_ACTION, PEDAL_ACTION, LIMIT) = range(len(REAL))  # fmt: skip
# Rows of `State.whole`, (E, rows, N) int64.
WHOLE = ("kind", "at", "size", "point", "piece", "before", "cleared", "draws", "steps", "alive",
         "leaves")  # fmt: skip
(KIND, AT, SIZE, POINT, PIECE, BEFORE, CLEARED, DRAWS, STEPS, ALIVE,
 LEAVES) = range(len(WHOLE))  # fmt: skip

# Bits of `Outcome.event`.
EVENTS = ("goal", "off_road", "crash_vehicle", "crash_object", "red_light", "wrong_way",
          "off_route", "late", "crash_human")  # fmt: skip
(GOAL_REACHED, OFF_ROAD, CRASH_VEHICLE, CRASH_OBJECT, RED_LIGHT, WRONG_WAY, OFF_ROUTE, LATE,
 CRASH_HUMAN) = (1 << bit for bit in range(len(EVENTS)))  # fmt: skip
# What the same bits mean of agents on walks, and in the air.
WALK_EVENTS = ("goal", "off_walk", "crash_mover", "crash_object", "red_light", "kerb", "fall",
               "late")  # fmt: skip
FLY_EVENTS = ("goal", "out_of_bounds", "crash_mover", "crash_object", "", "", "", "late")
KERB, FALL = WRONG_WAY, OFF_ROUTE
# Rows of `Outcome.term`, what a reward is the sum of.
TERMS = ("driving", "speed", "success", "off_road", "crash_vehicle", "crash_object")
DRIVING, SPEEDING, SUCCESS, LEAVING, CRASHING, HITTING = range(len(TERMS))
WALK_TERMS = ("progress", "speed", "success", "off_walk", "crash_mover", "crash_object")
FLY_TERMS = ("progress", "speed", "success", "out_of_bounds", "crash_mover", "crash_object")
# Rows of `Rules.number`.
NUMBERS = ("dt", "horizon", "goal_m", "red_light_ends", "top_reward", "w_driving", "w_speed",
           "w_success", "w_off_road", "w_crash_vehicle", "w_crash_object", "control", "vehicle",
           "whole_reset", "people", "explore", "outside")  # fmt: skip
(DT, HORIZON, GOAL_M, RED_ENDS, TOP_REWARD, W_DRIVING, W_SPEED, W_SUCCESS, W_OFF_ROAD, W_CRASH,
 W_HIT, CONTROL, VEHICLE, WHOLE_RESET, PEOPLE, EXPLORE, OUTSIDE) = range(len(NUMBERS))  # fmt: skip
PEDALS, TARGET, HELD, JERK = range(4)  # controls; who is held is moved by contacts


class Map(NamedTuple):
    """Arrays of a `World`, and what follows from them; n pieces, v vehicles."""

    point_start: Any
    point: Any
    next_start: Any
    next: Any
    length: Any  # (n,) metres
    speed: Any  # (n,) m/s
    across: Any  # (n,) bool
    usable: Any  # (n, v) uint8, 1 where agents may be led, 2 where background traffic goes too
    reach: Any  # (n, v) metres that can be driven from the start of a piece on, up to a limit
    start: Any  # (v, n) ascending metres of lanes to start on, for draws
    beside: Any  # (n, 2) lanes to the left and the right that one may change to, -1 for none
    conflict_start: Any
    conflict: Any
    yields: Any
    signal: Any
    cycle: Any
    signal_start: Any
    signal_time: Any
    signal_state: Any
    flags: Any  # `cityx.sim.blocks.Blocks`, as is `clear`
    clear: Any
    frame: Any
    segment: Any
    cell_start: Any
    cell_segment: Any
    grid: Any
    vehicles: Any  # (v, 9), `cityx.sim.dynamics`
    lane: Any  # (k, 6) float32, pieces of roads: ends, height and type
    lane_grid: Any  # (5,) frame of its cells
    lane_start: Any
    lane_row: Any


class Batch(NamedTuple):
    """The state of E worlds of N movers, the first A of them agents."""

    real: Any  # (E, rows, N) float64
    whole: Any  # (E, rows, N) int64
    path: Any  # (E, N, P) int32, pieces from where a mover set out, or is, on
    clock: Any  # (E,) float64, seconds of the signals
    key: Any  # (E,) uint64, of the random stream of each world
    seed: Any  # (E,) uint64
    episode: Any  # (E,) int64


class Here(NamedTuple):
    """The state of one world, views into that of the batch."""

    real: Any  # (rows, N)
    whole: Any  # (rows, N)
    path: Any  # (N, P)
    clock: Any  # (1,), as are those below
    key: Any
    seed: Any
    episode: Any


class Outcome(NamedTuple):
    """What a step came to, for E worlds of A agents."""

    reward: Any  # (E, A) float64
    term: Any  # (rows, E, A) float64
    cost: Any  # (E, A) float64
    event: Any  # (E, A) int64, bits
    touched: Any  # (E, A) int64, row of the segment, or of the mover as -2 - row; -1 for none
    ended: Any  # (E, A) bool, terminated
    late: Any  # (E, A) bool, truncated
    completion: Any  # (E, A) float64, share of the route
