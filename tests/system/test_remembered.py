import gc
import weakref

import numpy as np

from cityx.system.remembered import Remembered, forget_all


class _Held:
    def __init__(self, part):
        self.part = part


def test_what_is_forgotten_keeps_no_part_alive():
    remembered = Remembered()

    def of_a_part():
        part = np.zeros(3)
        remembered.get(lambda: _Held(part), [part])
        return weakref.ref(part)

    seen = of_a_part()
    gc.collect()
    assert seen() is not None
    forget_all()
    assert seen() is None


def test_what_is_forgotten_is_made_again():
    remembered = Remembered()
    part = np.zeros(3)
    made = [remembered.get(object, [part]) for _ in range(2)]
    forget_all()
    assert made[0] is made[1]
    assert remembered.get(object, [part]) is not made[0]
