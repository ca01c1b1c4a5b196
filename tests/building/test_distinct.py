import numpy as np
import pytest

from cityx.building.catalogue import NAMES
from cityx.building.design import design
from cityx.building.facade.facade import facade
from cityx.building.samples import sample_city, sheet_of
from cityx.building.shell import shell
from cityx.checks.descriptors import classified, descriptors
from cityx.checks.facade_checks import blind_windows, check_facades
from cityx.road.ground.ground_surface import ground
from cityx.road.network.network import network

TRAIN, TEST = range(100, 110), range(200, 204)


def described(seeds):
    samples = sheet_of(NAMES, seeds, spacing=200.0)
    ids, table = descriptors(facade(shell(design(sample_city(samples)))))
    label = {sample.id: NAMES.index(sample.generator) for sample in samples}
    return table, np.array([label[int(number)] for number in ids])


@pytest.mark.slow
def test_generators_are_told_apart_by_what_they_look_like():
    table, label = described(TRAIN)
    unseen, truth = described(TEST)
    assert np.mean(classified(table, label, unseen) == truth) >= 0.9


def test_samples_of_every_generator_keep_the_checks_of_facades():
    city = ground(network(sample_city(sheet_of(NAMES, (1, 2)))))
    city = facade(shell(design(city)))
    failed = {check.name: check.value for check in check_facades(city) if not check.ok}
    assert not failed


def test_a_window_turned_into_its_neighbour_is_found():
    city = sample_city(sheet_of(["perimeter_block"], (1,)))
    city = facade(shell(design(city)))
    windows = city.scene.instances["windows"]
    assert len(blind_windows(city, windows)) == 0
    low = np.flatnonzero(windows.position[:, 2] < 6.0)[:5]
    windows.rotation[low, 2] += np.pi
    assert len(blind_windows(city, windows)) == 5


def test_a_door_over_the_ground_is_found():
    city = ground(network(sample_city(sheet_of(["perimeter_block"], (1,)))))
    city = facade(shell(design(city)))
    city.scene.instances["doors"].position[:, 2] += 0.5
    found = {check.name: check for check in check_facades(city)}["door_off_ground"]
    assert found.value == pytest.approx(0.5, abs=0.1)
    assert found.ids
    assert not found.ok
