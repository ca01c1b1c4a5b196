import subprocess
import sys

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from cityx.ids import choose, draw, hash_ids, id_text, rng_for, stable_id, uniform

IDS = np.arange(1, 20_001, dtype=np.uint64)


def test_stable_id_is_the_same_in_every_process():
    code = "from cityx.ids import stable_id; print(stable_id('osm', 'way', 123))"
    runs = {
        subprocess.run(
            [sys.executable, "-c", code],
            env={"PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        ).stdout.strip()
        for seed in ("1", "2")
    }
    assert runs == {str(stable_id("osm", "way", 123))}


def test_a_draw_depends_on_the_id_and_not_on_the_order():
    shuffled = np.random.default_rng(0).permutation(IDS)
    assert np.array_equal(uniform(7, "x", shuffled), uniform(7, "x", IDS)[shuffled - 1])


def test_uniform_fills_the_interval_evenly():
    drawn = uniform(0, "even", IDS)
    assert drawn.min() >= 0
    assert drawn.max() < 1
    counts = np.histogram(drawn, bins=10, range=(0, 1))[0]
    assert np.all(np.abs(counts - 2000) < 200)  # over four standard deviations


def test_purposes_seeds_and_draw_numbers_are_independent():
    base = hash_ids(0, "a", IDS)
    for other in (hash_ids(1, "a", IDS), hash_ids(0, "b", IDS), hash_ids(0, "a", IDS, 1)):
        assert abs(np.corrcoef(base.astype(float), other.astype(float))[0, 1]) < 0.03
        assert not np.any(base == other)


def test_choose_follows_its_weights():
    drawn = choose(0, "pick", IDS, [1.0, 0.0, 3.0])
    share = np.bincount(drawn, minlength=3) / len(IDS)
    assert share[1] == 0
    assert abs(share[2] - 0.75) < 0.02


def test_a_generator_is_keyed_by_its_object():
    assert rng_for(0, "p", 5).random() == rng_for(0, "p", 5).random()
    assert rng_for(0, "p", 5).random() != rng_for(0, "p", 6).random()


def test_an_id_is_written_with_sixteen_digits():
    assert id_text(255) == "00000000000000ff"


@given(st.integers(-(2**40), 2**40), st.integers(0, 2**64 - 1), st.integers(0, 1000))
@settings(max_examples=50, deadline=None, derandomize=True)
def test_one_draw_is_the_draw_of_the_table(seed, object_id, k):
    assert draw(seed, "x", object_id, k) == float(uniform(seed, "x", np.uint64(object_id), k))
