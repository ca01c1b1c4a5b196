"""Curve objects drawn in Blender are paths of characters, and drawings of a build."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import shapely
from crossing_town import crossing_town

from cityx.agents.requests import with_requests
from cityx.city.store import write_city
from cityx.errors import InputError, UsageError
from cityx.motion.character import add_characters
from cityx.projects.edit import planned, roles_at
from cityx.protocol import registry
from cityx.sources.blend_curves import read_blend_curves
from cityx.sources.drawn import read_drawing

pytestmark = pytest.mark.blender


@pytest.fixture(scope="module")
def blend(tmp_path_factory):
    path = tmp_path_factory.mktemp("drawn") / "tour.blend"
    script = Path(__file__).with_name("drawn_curves.py")
    done = subprocess.run([sys.executable, script, path], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return path


@pytest.fixture(scope="module")
def curves(blend):
    return read_blend_curves(blend)


def test_splines_are_lines_in_metres_where_their_objects_are(curves):
    loop = np.array(curves.line("Loop"))
    assert loop.tolist() == [[-20, -20], [20, -20], [20, 20], [-20, 20], [-20, -20]]
    assert np.allclose(curves.line("Line"), [(5.0, 7.0), (35.0, 7.0)])


def test_what_is_no_path_is_told_in_a_sentence(blend, curves, tmp_path):
    with pytest.raises(InputError, match='has no object "loop"') as missing:
        curves.line("loop")
    assert str(missing.value).endswith('Did you mean "Loop"?')
    with pytest.raises(InputError, match=r'"Box" of .* is a mesh, no curve\. Its curves are "L'):
        curves.line("Box")
    with pytest.raises(InputError, match=r'The curve "Two" of .* draws 2 lines'):
        curves.line("Two")
    text = tmp_path / "text.blend"
    text.write_text("no scene at all")
    with pytest.raises(InputError, match=r"text.blend is no .blend file; save it from Blender.$"):
        read_blend_curves(text)
    broken = tmp_path / "broken.blend"
    broken.write_bytes(blend.read_bytes()[:2000])
    with pytest.raises(InputError, match=r"broken.blend: Blender cannot read it \("):
        read_blend_curves(broken)
    with pytest.raises(InputError, match="No such file"):
        read_blend_curves(tmp_path / "none.blend")


def test_a_character_runs_along_a_curve_object_named_on_the_command_line(blend):
    wish = f'dynamic/character-v1 "path={blend}:Loop" walk_run=run'
    (item,) = with_requests([], [], [wish], registry())
    assert item.args["path"] == "Loop"
    assert item.args["points"] == read_blend_curves(blend).line("Loop")
    with pytest.raises(UsageError, match=r'--do .*has no object "Lop"'):
        with_requests([], [], [wish.replace(":Loop", ":Lop")], registry())


def test_a_sentence_names_a_curve_of_a_file_that_is_given_with_it(blend, tmp_path):
    from cityx.projects.desk import Desk

    write_city(crossing_town(), tmp_path / "city")
    with Desk(tmp_path) as desk, roles_at(desk) as roles:
        _, items, *_ = planned(desk, "Add a running man along Line.", [blend], roles=roles)
        (item,) = items
        assert (item.action, item.args["path"]) == ("dynamic/character-v1", "Line")
        assert np.allclose(item.args["points"], [(5.0, 7.0), (35.0, 7.0)])


def test_who_follows_a_curve_object_stays_on_it(curves):
    line = curves.line("Line")
    city, (own,) = add_characters(crossing_town(), path="Line", points=line)
    tracks = city.tracks.take(city.tracks.object_id == own)
    far = shapely.distance(shapely.points(tracks.position[:, :2]), shapely.LineString(line))
    assert far.max() < 0.2


def test_a_blend_is_a_drawing_whose_curves_are_ways(blend):
    drawing = read_drawing(blend)
    kinds = {owner.key[-1]: owner.tags.get("kind") for owner in drawing.owners}
    assert kinds == {"Loop": None, "Line": None, "Two": None} | {"Lane": "residential"}
    assert not drawing.located
