"""Towns to learn in and to be judged in are made by seed, once."""

import json
from pathlib import Path

import pytest

from cityx.errors import UsageError
from cityx.sim import places
from cityx.sim.places import towns


@pytest.fixture
def orders(monkeypatch, tmp_path):
    """What the maker of places was asked for, which marks each town as made."""
    asked = []

    def made(order):
        asked.append(order)
        folder = Path(order["build"])
        folder.mkdir(parents=True)
        (folder / "report.json").write_text(json.dumps({}))
        return {}

    monkeypatch.setattr(places, "in_process", made)
    monkeypatch.setattr(places, "kept_folder", lambda name: tmp_path / name)
    return asked


def test_more_towns_begin_with_the_same_and_are_made_once(orders, caplog):
    three = towns(3)
    assert "3 towns are made in" in caplog.text
    assert "which take some 33 MB" in caplog.text
    caplog.clear()
    assert towns(3) == three
    assert not caplog.text
    assert [order["seed"] for order in orders] == [0, 1, 2]
    assert [order["size"] for order in orders] == [[300.0, 300.0]] * 3
    five = towns(5)
    assert five[:3] == three
    assert len(set(five)) == 5
    assert [order["seed"] for order in orders] == [0, 1, 2, 3, 4]
    assert [Path(order["build"]) for order in orders] == list(five)


def test_no_town_of_one_part_is_of_the_other(orders):
    train, test = towns(4), towns(4, split="test")
    assert not set(train) & set(test)
    assert [order["seed"] for order in orders[4:]] == [1_000_000 + number for number in range(4)]
    assert towns(4, size=(200.0, 200.0)) != train


def test_parts_and_counts_that_are_none_are_refused(orders):
    with pytest.raises(UsageError, match=r'split is "tests"; known are train, test\..* "test"'):
        towns(2, split="tests")
    for count in (0, -1, 2.5, True, 1_000_001):
        with pytest.raises(UsageError, match="it takes a whole number from 1 to 1,000,000"):
            towns(count)
    assert orders == []
