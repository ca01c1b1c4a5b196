"""Another process steps an environment to the same bytes; bad messages get sentences."""

import os
import signal
import subprocess
import sys
import time

import msgpack
import numpy as np
import pytest

import cityx
from cityx.errors import EngineError, UsageError
from cityx.sim.bridge.addresses import checked_address
from cityx.sim.bridge.client import RemoteEnv
from cityx.sim.bridge.messages import VERSION, packed, unpacked
from cityx.sim.bridge.server import MOST, Desk


@pytest.fixture
def desk(placed):
    found = Desk(placed, {"traffic": 2, "goal_m": 60.0})
    yield found
    found.close()


def asked(desk, message=None, **fields):
    """Return what a desk answers, all the way through bytes."""
    return unpacked(desk.answer(packed({"message": message, **fields})))


def refusal(desk, message=None, **fields):
    told = asked(desk, message, **fields)
    assert told["ok"] is False
    return told["sentence"]


@pytest.fixture
def server(town, tmp_path):
    """Return the address of a server in a process of its own."""
    address = f"ipc://{tmp_path}/sim"
    process = subprocess.Popen(
        [sys.executable, "-m", "cityx.cli", "sim", str(town), "--serve", address],
        stdout=subprocess.PIPE, text=True, env={**os.environ, "PYTHONUNBUFFERED": "1"},
    )  # fmt: skip
    yield process.stdout.readline().strip()
    process.send_signal(signal.SIGINT)
    assert process.communicate(timeout=60)[0] == "ended\n"
    assert process.returncode == 0


def test_another_process_steps_to_the_same_bytes(server, town):
    options = {"traffic": 3, "goal_m": 60.0, "observation": ["state", "imu"]}
    here = cityx.make("CityX/Drive-v0", town, **options)
    there = RemoteEnv(server, "drive", **options)
    assert there.observation_space == here.observation_space
    assert there.action_space == here.action_space
    for seed in (3, None):
        own, far = here.reset(seed=seed), there.reset(seed=seed)
        for _ in range(40):
            assert own[-1] == far[-1]
            for name, array in own[0].items():
                assert array.dtype == far[0][name].dtype
                assert array.tobytes() == far[0][name].tobytes()
            row = here.engine.state.row
            assert there.pose["x"] == row("x")[0, 0]
            assert there.pose["heading"] == row("heading")[0, 0]
            if len(own) == 5:
                assert own[1:4] == far[1:4]
                if own[2] or own[3]:
                    break
            own, far = (env.step(np.array([0.05, 0.6], np.float32)) for env in (here, there))
    there.close()
    there.close()
    with pytest.raises(UsageError, match="closed"):
        there.reset()


def test_a_picture_comes_over_the_bridge(desk):
    env = asked(desk, "make", task="drive", render_mode="rgb_array")["env"]
    asked(desk, "reset", env=env, seed=1)
    picture = asked(desk, "render", env=env)["picture"]
    assert picture.dtype == np.uint8
    assert picture.ndim == 3
    assert picture.std() > 0


def test_who_begins_no_episode_steps_none(desk):
    env = asked(desk, "make", task="drive", options={"horizon": 2})["env"]
    sentence = f"No episode of environment {env} is under way; reset it first."
    assert refusal(desk, "step", env=env, action=[0.0, 0.0]) == sentence
    asked(desk, "reset", env=env, seed=1)
    for _ in range(2):
        told = asked(desk, "step", env=env, action=[0.0, 0.0])
    assert told["truncated"] is True
    assert refusal(desk, "step", env=env, action=[0.0, 0.0]) == sentence
    asked(desk, "close", env=env)
    assert refusal(desk, "reset", env=env) == (
        f"There is no environment {env}; known are none; make one first."
    )


def test_actions_of_no_use_are_refused_and_move_nothing(desk):
    env = asked(desk, "make", task="drive")["env"]
    first = asked(desk, "reset", env=env, seed=1)["observation"]
    nan = float("nan")
    assert "not finite" in refusal(desk, "step", env=env, action=[nan, 0.0])
    assert "shape (3,); it takes (2,)" in refusal(desk, "step", env=env, action=[0, 0, 0])
    assert "numbers" in refusal(desk, "step", env=env, action=["left", "on"])
    again = asked(desk, "reset", env=env, seed=1)["observation"]
    assert first.tobytes() == again.tobytes()


def test_every_fault_of_a_message_is_told(desk):
    assert refusal(desk, "stop", env=1) == (
        "There is no message 'stop'; known are make, reset, step, render, close."
        ' Did you mean "step"?'
    )
    assert refusal(desk, "step", env=True, acton=[0, 0]) == (
        'The message "step" has no field "acton". Did you mean "action"? env is True; it takes a '
        "whole number. action is nothing; it takes a list of numbers or an array."
    )
    assert "town_size: the place is that of the server" in refusal(
        desk, "make", task="drive", options={"town_size": [9, 9]}
    )
    assert 'There is no option "trafic". Did you mean "traffic"?' in refusal(
        desk, "make", task="drive", options={"trafic": 3}
    )
    assert 'There is no environment "fligh"' in refusal(desk, "make", task="fligh")


def test_bytes_that_are_no_message_are_told(desk):
    def said(raw):
        return unpacked(desk.answer(raw))["sentence"]

    assert said(b"\xc1").startswith("The message is no MessagePack of one map")
    assert said(b"").startswith("The message is no MessagePack of one map")
    assert said(msgpack.packb([1])) == (
        "The message is a list of numbers; it takes a map of MessagePack."
    )
    assert said(msgpack.packb({"version": 9, "message": "make"})) == (
        f"The message is of version 9; this is version {VERSION} of the bridge."
    )
    bad = {"array": "O", "shape": [1], "data": b"12345678"}
    assert "it takes numbers" in said(msgpack.packb({"version": VERSION, "action": bad}))
    short = {"array": "<f8", "shape": [2], "data": b"12345678"}
    assert "no MessagePack" in said(msgpack.packb({"version": VERSION, "action": short}))


def test_so_many_environments_and_no_more(desk):
    for _ in range(MOST):
        assert asked(desk, "make", task="drive")["ok"]
    assert refusal(desk, "make", task="drive") == (
        f"There are {MOST} environments already; close one first."
    )


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:5555", "tcp://localhost:0", "tcp://[::1]:9",
                                     "tcp://127.0.0.1:*", "ipc:///tmp/x"])  # fmt: skip
def test_addresses_of_this_machine_are_taken(address):
    assert checked_address(address) in (address, address.replace(":0", ":*"))


@pytest.mark.parametrize("address", ["tcp://0.0.0.0:5555", "tcp://*:5555", "tcp://192.168.1.4:80",
                                     "tcp://example.org:80"])  # fmt: skip
def test_addresses_that_others_reach_are_taken_only_if_that_is_said(address):
    with pytest.raises(UsageError, match=r"can be reached by other machines.*--any-interface"):
        checked_address(address)
    assert checked_address(address, anywhere=True) == address


@pytest.mark.parametrize("address", ["127.0.0.1:80", "http://127.0.0.1:80", "tcp://127.0.0.1",
                                     "tcp://127.0.0.1:99999", "ipc://"])  # fmt: skip
def test_what_is_no_address_is_refused(address):
    with pytest.raises(UsageError, match=r"is no address; it takes tcp://127\.0\.0\.1:PORT"):
        checked_address(address)


def test_where_nobody_answers_it_is_said(tmp_path):
    with pytest.raises(EngineError, match=r"Nobody answers at ipc://.* within 0.1 s; is "):
        RemoteEnv(f"ipc://{tmp_path}/nobody", timeout=0.1)


def test_a_port_at_which_nobody_listens_is_known_at_once():
    begin = time.monotonic()
    with pytest.raises(EngineError, match=r"Nobody answers at tcp://127\.0\.0\.1:9 within 5 s"):
        RemoteEnv("tcp://127.0.0.1:9")
    assert time.monotonic() - begin < 60.0  # its answers are waited for ten times as long
