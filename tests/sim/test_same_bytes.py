"""What is observed is the same to the byte on every machine: a hash of it is kept here.

The world is made by hand, so that only a change of the kernels, which raises the version of the
engine, or another machine can give another hash.
"""

from hashlib import blake2b

import numpy as np

from cityx.sim.engine import VERSION, Engine
from cityx.sim.options import options_of

KEPT = {
    5: "b135195f002d4767f99a0a8a0c10094a"
}  # by version of the engine; found on Linux, x86-64, NumPy 1.26 and numba 0.68
STEPS, WORLDS = 300, 3


def observed(world):
    options = options_of({"traffic": 6, "goal_m": 150.0, "observation": "metadrive"})
    engine = Engine(world, options, WORLDS)
    engine.seed(11)
    engine.begin()
    hasher = blake2b(engine.view.tobytes(), digest_size=16)
    drawn = np.random.default_rng(5).integers(-1000, 1001, (STEPS, WORLDS, 1, 2)) / 1000.0
    for action in drawn:
        engine.step(action * [0.1, 0.5] + [0.0, 0.3])
        for array in (engine.view, engine.out.reward, engine.state.real):
            hasher.update(array.tobytes())
    engine.close()
    return hasher.hexdigest()


def test_a_drive_is_that_of_every_other_machine(two_lanes):
    assert observed(two_lanes) == KEPT[VERSION]
