"""A page goes on with the next server of its folder; nobody else learns what opens a city."""

import stat
import subprocess
import sys
from contextlib import contextmanager

import pytest
import requests

from cityx.viewer.resuming import PAGE, SERVER, Resuming, _path, keep_secret, kept_secret


@pytest.fixture
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("CITYX_CACHE", str(tmp_path / "cache"))
    return tmp_path


def test_a_challenge_is_good_for_one_right_answer():
    page, server, other = Resuming("one"), Resuming("one"), Resuming("two")
    told = server.answer("a nonce of the page")
    assert told["proof"] == page.proof(SERVER, "a nonce of the page")
    assert told["proof"] != other.answer("a nonce of the page")["proof"]
    right = page.proof(PAGE, told["challenge"])
    assert not server.accepts(told["challenge"], other.proof(PAGE, told["challenge"]))
    assert not server.accepts(told["challenge"], right)  # it was used up by the wrong answer
    again = server.answer("another nonce of it")["challenge"]
    assert again != told["challenge"]
    assert not server.accepts(again, page.proof(SERVER, again))  # what a server proves is no answer
    last = server.answer("a third nonce of it")["challenge"]
    assert server.accepts(last, page.proof(PAGE, last))


def test_the_secret_of_a_folder_is_for_its_user_alone_and_for_that_folder(cache):
    one, two = cache / "one", cache / "two"
    secret, port = kept_secret(one)
    assert (len(secret), port) == (64, 0)
    keep_secret(one, secret, 4321)
    assert kept_secret(one) == (secret, 4321)
    assert kept_secret(two)[0] != secret
    assert stat.S_IMODE(_path(one).stat().st_mode) == 0o600
    _path(one).chmod(0o644)  # others could have read it
    assert kept_secret(one)[0] != secret
    _path(one).write_text("{")
    _path(one).chmod(0o600)
    assert kept_secret(one)[1] == 0


@contextmanager
def viewed(folder):
    command = [sys.executable, "-m", "cityx.cli", "view", str(folder), "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        yield process.stdout.readline().split()[-1].partition("#token=")[::2]
        process.terminate()


def test_cityx_view_comes_back_at_its_address_and_resumes_by_proof_alone(cache, built_town, page):
    del page, cache
    folder = built_town(lod=1)
    with viewed(folder) as (address, first):
        told = requests.get(
            f"{address}scene.json", headers={"Authorization": f"Bearer {first}"}, timeout=60
        ).json()
    knows = Resuming(told["secret"])
    with viewed(folder) as (again, second):
        assert again == address
        assert second != first
        proof = requests.get(f"{address}prove", params={"nonce": "n" * 32}, timeout=30).json()
        assert proof["proof"] == knows.proof(SERVER, "n" * 32)
        answer = {"challenge": proof["challenge"], "proof": knows.proof(PAGE, proof["challenge"])}
        given = requests.post(f"{address}resume", json=answer, timeout=30)
        assert given.json() == {"token": second}
        replayed = requests.post(f"{address}resume", json=answer, timeout=30)
        assert replayed.status_code == 401
        assert requests.get(f"{address}prove?nonce=x", timeout=30).status_code == 400
        foreign = {"Host": "evil.example"}
        assert requests.get(f"{address}prove", headers=foreign, timeout=30).status_code == 421
        with viewed(folder) as (third, _):  # the port is taken: another one serves
            assert third != address
