"""A network that SUMO refuses: the answer names the street, and the city is as it was."""

import sys
from hashlib import sha256
from importlib.util import find_spec

import pytest
from copies import copy_of
from made_streets import CROSS, city_of

from cityx.cli.main import main
from cityx.errors import EngineError
from cityx.motion.vehicles import halts_of
from cityx.traffic import network
from cityx.traffic.laying import streets_of
from cityx.traffic.network import make_network
from cityx.traffic.plain import write_plain
from cityx.traffic.session import street_names

pytestmark = [
    pytest.mark.sumo,
    pytest.mark.skipif(
        find_spec("libsumo") is None, reason='SUMO is not installed: pip install "cityx[traffic]"'
    ),
]


@pytest.fixture(autouse=True)
def _refused(monkeypatch):
    """Let the first street begin at a junction that there is not."""

    def spoilt(streets, frame, folder, name="city"):
        files = write_plain(streets, frame, folder, name)
        edges = files[1].read_text()
        first = edges.index('from="')
        end = edges.index('"', first + 6)
        files[1].write_text(f'{edges[:first]}from="nowhere{edges[end:]}')
        return files

    monkeypatch.setattr(network, "write_plain", spoilt)


def test_the_street_is_named_that_netconvert_refuses(tmp_path):
    city = city_of(CROSS)
    streets = streets_of(city, halts_of(city))
    with pytest.raises(EngineError, match=r"street 0[\s\S]*nowhere|nowhere[\s\S]*street 0"):
        make_network(streets, city.frame, tmp_path, said=street_names(city))


def test_the_city_is_as_it_was_where_its_network_is_refused(
    scene_folder, tmp_path, monkeypatch, capsys
):
    copy_of(scene_folder("grid_s"), tmp_path / "grid")
    before = hashes(tmp_path / "grid")
    monkeypatch.setattr(sys, "argv", ["cityx", "edit", str(tmp_path / "grid"), "Add light traffic"])
    with pytest.raises(SystemExit) as stop:
        main()
    said = capsys.readouterr().err
    assert stop.value.code == 3
    assert "netconvert" in said
    assert "residential y1" in said
    assert "Traceback" not in said
    assert hashes(tmp_path / "grid") == before


def hashes(folder):
    """Return the digest of every file of a city but its journal, which tells what was tried."""
    return {
        str(path.relative_to(folder)): sha256(path.read_bytes()).hexdigest()
        for path in folder.rglob("*")
        if path.is_file() and "journal" not in path.name and path.suffix != ".log"
    }
