import json
import shutil
import sys

import pytest

from cityx.cli.main import main


def run(monkeypatch, capsys, *words):
    monkeypatch.setattr(sys, "argv", ["cityx", "assets", *map(str, words)])
    with pytest.raises(SystemExit) as stop:
        main()
    return stop.value.code, capsys.readouterr()


def test_a_library_is_listed_shown_searched_and_checked(monkeypatch, capsys, small_library):
    folder = small_library.folder
    code, said = run(monkeypatch, capsys, "list", folder, "--group", "plants", "--limit", "1")
    assert code == 0
    assert "plants" in said.out
    name = said.out.split()[0]
    code, said = run(monkeypatch, capsys, "show", folder, name)
    assert json.loads(said.out)["id"] == name
    code, said = run(monkeypatch, capsys, "search", folder, "evergreen tree", "-n", "2")
    assert said.out.splitlines()[-1] == "encoder: local-text/1, not CLIP"
    assert len(said.out.splitlines()) == 3
    code, said = run(monkeypatch, capsys, "check", folder)
    assert (code, said.out.strip()) == (0, "90 assets, 0 faults")


def test_growing_says_what_the_library_holds(monkeypatch, capsys, tmp_path):
    words = ("grow", "-o", tmp_path / "l", "--count", "3", "--groups", "furniture")
    code, said = run(monkeypatch, capsys, *words)
    assert code == 0
    assert said.out.strip() == f"3 assets grown; {tmp_path / 'l'} holds 3 furniture"


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (("list", "{}/none"), "holds no library"),
        (("grow", "-o", "{}/l", "--groups", "castles"), 'Group "castles" cannot be grown'),
        (("import", "{}/none", "-o", "{}/l"), "is no folder"),
        (("search", "{lib}", "x", "--encoder", "clip"), "CLIP needs weights"),
        (("show", "{lib}", "zzz"), 'has no asset "zzz"'),
        (("place", "{}/none", "{lib}", "-o", "{}/out"), "holds no city"),
    ],
)
def test_mistakes_end_with_code_two_and_one_sentence(
    monkeypatch, capsys, tmp_path, small_library, words, text
):
    filled = [word.replace("{lib}", str(small_library.folder)).replace("{}", str(tmp_path))
              for word in words]  # fmt: skip
    code, said = run(monkeypatch, capsys, *filled)
    assert code == 2
    (line,) = [line for line in said.err.splitlines() if line.startswith("error: ")]
    assert text in line
    assert list(tmp_path.iterdir()) == []


def test_a_partly_refused_import_ends_with_code_one(monkeypatch, capsys, tmp_path):
    folder = tmp_path / "in"
    folder.mkdir()
    (folder / "a.obj").write_text("v 0 0 0\nv 4 0 0\nv 4 3 4\nv 0 3 4\nf 1 2 3\nf 1 3 4\n")
    (folder / "b.glb").write_bytes(b"")
    code, said = run(monkeypatch, capsys, "import", folder, "-o", tmp_path / "l")
    assert code == 1
    assert "b.glb is refused: it is empty." in said.out
    assert "1 assets imported" in said.out


def test_a_damaged_library_ends_with_code_one(monkeypatch, capsys, tmp_path, small_library):
    folder = tmp_path / "l"
    shutil.copytree(small_library.folder, folder)
    sorted((folder / "buildings").glob("*.npz"))[0].unlink()
    code, said = run(monkeypatch, capsys, "check", folder)
    assert code == 1
    assert "is missing from the library" in said.out
