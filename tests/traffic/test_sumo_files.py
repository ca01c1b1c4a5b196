"""What people get who run SUMO themselves."""

from importlib.util import find_spec

import pytest
from made_streets import CROSS, MIDDLE, city_of

from cityx.city.tracks import poses_at
from cityx.errors import MissingExtra
from cityx.motion.traffic import traffic
from cityx.motion.vehicles import halts_of
from cityx.options import BuildOptions
from cityx.projects import build as building
from cityx.traffic import engine
from cityx.traffic.engine import run_program
from cityx.traffic.files import CONFIG, FILES, write_sumo

pytestmark = [pytest.mark.sumo]
needs_sumo = pytest.mark.skipif(
    find_spec("libsumo") is None, reason='SUMO is not installed: pip install "cityx[traffic]"'
)


@needs_sumo
def test_sumo_runs_the_files_with_the_vehicles_of_the_tracks(tmp_path):
    city = traffic(city_of(CROSS, signals=[MIDDLE]), density="medium", duration=20.0)
    write_sumo(city, halts_of(city), tmp_path / "a")
    write_sumo(city, halts_of(city), tmp_path / "b")
    for name in FILES:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()
    args = ["-c", CONFIG, "--tripinfo-output", "trips.xml", "--tripinfo-output.write-unfinished",
            "--no-step-log"]  # fmt: skip
    said = run_program("sumo", args, tmp_path / "a", timeout_s=60.0)
    assert not [line for line in said if line.startswith("Error")]
    there = len(poses_at(city.tracks, 0.0).row)
    assert (tmp_path / "a" / "trips.xml").read_text().count("<tripinfo ") >= there


@needs_sumo
def test_a_city_without_tracks_gives_a_network_without_vehicles(tmp_path):
    city = city_of(CROSS)
    write_sumo(city, halts_of(city), tmp_path)
    assert "<vehicle" not in (tmp_path / "city.rou.xml").read_text()
    run_program("sumo", ["-c", CONFIG, "--no-step-log"], tmp_path, timeout_s=60.0)


def test_a_build_that_needs_sumo_names_the_extra_before_it_begins(monkeypatch, tmp_path):
    monkeypatch.setattr(engine, "find_spec", lambda _: None)
    with pytest.raises(MissingExtra, match=r"cityx\[traffic\]"):
        building.build([], tmp_path / "out", BuildOptions(formats=("sumo",), text="a town"))
    assert not (tmp_path / "out").exists()
