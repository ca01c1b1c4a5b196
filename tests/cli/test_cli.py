import os
import subprocess
import sys

import pytest

from cityx.cli.main import main


def run(monkeypatch, capsys, *words):
    monkeypatch.setattr(sys, "argv", ["cityx", *map(str, words)])
    with pytest.raises(SystemExit) as stop:
        main()
    return stop.value.code, capsys.readouterr()


def test_help_comes_within_half_a_second():
    before = os.times()
    subprocess.run([sys.executable, "-m", "cityx.cli", "--help"], check=True, capture_output=True)
    after = os.times()
    # Of the processor, so that a busy machine does not fail the test.
    used = after.children_user + after.children_system
    assert used - before.children_user - before.children_system < 0.5


def test_importing_cityx_imports_no_engine_and_no_tables():
    code = (
        "import sys, cityx, cityx.cli.main, cityx.city, cityx.protocol;"
        "print([m for m in ('bpy', 'geopandas', 'pandas', 'scipy') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert done.stdout.strip() == "[]"


def test_a_missing_file_is_named_and_nothing_is_written(monkeypatch, capsys, tmp_path):
    code, said = run(monkeypatch, capsys, "build", tmp_path / "no.osm", "-o", tmp_path / "out")
    assert code == 2
    assert said.err.splitlines()[-1] == f"error: {tmp_path / 'no.osm'} does not exist."
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("empty.osm", b"", "is empty."),
        ("notes.xyz", b"hello", "is of no known kind"),
        ("map.png", b"\x89PNG", "is no image"),
        ("binary.osm", bytes(range(256)) * 50, ""),
        ("other.osm", b"<?xml version='1.0'?><gpx></gpx>", ""),
        ("cut.osm", b"<?xml version='1.0'?><osm><node id='1' lat='1' lo", ""),
    ],
)
def test_unusable_files_end_with_code_two_and_one_sentence(
    monkeypatch, capsys, tmp_path, name, content, words
):
    path = tmp_path / name
    path.write_bytes(content)
    code, said = run(monkeypatch, capsys, "build", path, "-o", tmp_path / "out")
    assert code == 2
    (line,) = [line for line in said.err.splitlines() if line.startswith("error: ")]
    assert name in line
    assert words in line
    assert "Traceback" not in said.err
    assert [entry.name for entry in tmp_path.iterdir()] == [name]


@pytest.mark.parametrize(
    ("option", "value", "words"),
    [
        ("--size", "10by20", '--size "10by20" is not of the form 800x600.'),
        ("--at", "60", '--at "60" is not of the form 60.17,24.94.'),
        ("--picture", "1x1", 'Picture size "1x1" is outside 16x16 to 16384x16384.'),
        ("--formats", "obj", 'There is no format "obj". Known are'),
    ],
)
def test_wrong_options_say_what_would_be_right(monkeypatch, capsys, tmp_path, option, value, words):
    path = tmp_path / "map.osm"
    path.write_text("<osm/>")
    code, said = run(monkeypatch, capsys, "build", path, "-o", tmp_path / "o", option, value)
    assert code == 2
    assert words in said.err


def test_a_folder_without_a_city_cannot_be_rendered(monkeypatch, capsys, tmp_path):
    code, said = run(monkeypatch, capsys, "render", tmp_path)
    assert code == 2
    assert "holds no city" in said.err


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        ("build x -o o --lod 5", '--lod is "5"; it takes 0 to 3.'),
        ("build x -o o --lod much", '--lod is "much"; it takes a whole number, 0 to 3.'),
        ("undo o --to 0", '--to is "0"; it takes 1 or more.'),
        ("build x", "-o/--out is missing: Folder of the results. See cityx build --help."),
        (
            "build x --lodd 5",
            'There is no option "--lodd". Did you mean "--lod" or "--look" or "--do"?',
        ),
        ("biuld x", 'There is no command "biuld". Did you mean "build"?'),
        ("plugins list x", "Nothing takes the words: x. See cityx plugins list --help."),
        ("build x -o o --lod", "Option --lod requires an argument. See cityx --help."),
    ],
)
def test_a_wrong_command_line_gives_one_sentence(monkeypatch, capsys, words, sentence):
    code, said = run(monkeypatch, capsys, *words.split())
    assert (code, said.out, said.err) == (2, "", f"error: {sentence}\n")


def test_a_group_alone_shows_its_help(monkeypatch, capsys):
    code, said = run(monkeypatch, capsys, "plugins")
    assert code == 2
    assert said.err.startswith("Usage: cityx plugins")
    assert "error" not in said.err


@pytest.mark.parametrize(("words", "code"), [("frobnicated towers", 1), ("towers", 0), ("", 0)])
def test_a_build_that_leaves_out_words_says_so_and_does_not_end_with_0(
    monkeypatch, capsys, tmp_path, words, code
):
    text = [f"a town of {words}"] if words else []
    flags = ("--size", "100x100", "--lod", "0", "--no-render", "--formats", "")
    ended, told = run(monkeypatch, capsys, "build", *text, "-o", tmp_path / "town", *flags)
    assert (ended or 0, "Done in part" in told.out) == (code, code == 1)
