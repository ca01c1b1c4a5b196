"""Tables of data: what is read is typed, shared and checked, and faults are named."""

import shutil
import tomllib
from dataclasses import dataclass
from math import inf
from typing import Annotated

import pytest

from cityx.assets import kept_prototypes
from cityx.errors import InputError
from cityx.protocol import catalogue
from cityx.system import tables
from cityx.system.tables import Between, files_of, files_read_by, load, table


@dataclass(frozen=True)
class Leaf:
    name: str
    size: float
    color: tuple[int, int, int] = (0, 0, 0)
    words: tuple[str, ...] = ()
    rib: "Rib | None" = None


@dataclass(frozen=True)
class Rib:
    count: int


@pytest.fixture
def written(tmp_path, monkeypatch):
    """Return a function that makes the file `leaves.toml` of a text."""
    monkeypatch.setattr(tables, "DATA", tmp_path)
    tables._read_once.cache_clear()
    yield lambda text: (tmp_path / "leaves.toml").write_text(text, encoding="utf-8")
    tables._read_once.cache_clear()


def test_rows_become_the_type_that_holds_them_in_their_order(written):
    written(
        'oak = {size = 2, color = [1, 2, 3], words = "a b", rib = {count = 4}}\nfir = [inf]\n'
        'ash = {size = 1.5, color = "$red"}\n[shared]\nred = [9, 0, 0]\n'
    )
    held = load("leaves", dict[str, Leaf] | None)
    assert list(held.items()) == [
        ("oak", Leaf("oak", 2.0, (1, 2, 3), ("a", "b"), Rib(4))),
        ("fir", Leaf("fir", inf)),
        ("ash", Leaf("ash", 1.5, (9, 0, 0))),
    ]


def test_long_texts_are_folded_and_keys_may_be_numbers(written):
    written("text = '''\none two,\nthree\n'''\n[colors]\n0xFF = 1\n10 = 0.5\n")
    assert load("leaves", str, "text") == "one two, three"
    assert load("leaves", dict[int, float], "colors") == {255: 1.0, 10: 0.5}


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ("size = 1.0, sise = 2.0", r'leaves\.toml\.oak: there is no key "sise"\. .* "size"\?'),
        ("color = [1, 2, 3]", r'leaves\.toml\.oak: the key "size" is missing'),
        ('size = "big"', r"leaves\.toml\.oak, size: 'big' is not of type number"),
        ("size = 1.0, color = [1, 2]", r"oak, color: \[1, 2\] is not an array of 3"),
        ("size = 1.0, color = [1, 2, 0.5]", r"color\[2\]: 0\.5 is not of type integer"),
        ('size = 1.0, rib = "$rib"', r'there is no shared "rib"\. Did you mean "ribs"'),
    ],
)
def test_a_row_that_does_not_fit_is_named_with_its_file_and_key(written, row, message):
    written(f"oak = {{{row}}}\n[shared]\nribs = {{count = 1}}\n")
    with pytest.raises(InputError, match=message):
        table("leaves", Leaf)


def test_all_faults_of_a_file_are_told_at_once_and_bounds_are_kept(written):
    bounded = dict[int, Annotated[float, Between(0.0, 1.0)]]
    written('[shares]\n1 = 0.5\ntwo = 1.0\n3 = 2\n4 = "all"\n')
    with pytest.raises(InputError) as raised:
        load("leaves", bounded, "shares")
    assert str(raised.value).splitlines() == [
        'leaves.toml, shares: the key "two" is no integer.',
        "leaves.toml, shares.3: 2.0 is not a number from 0 to 1.",
        "leaves.toml, shares.4: 'all' is not of type number.",
    ]


def test_weights_may_be_a_table_or_one_word(written):
    written('many = {oak = 2, fir = 0.5}\none = "oak"\n')
    weights = tuple[tuple[str, float], ...]
    assert load("leaves", weights, "many") == (("oak", 2.0), ("fir", 0.5))
    assert load("leaves", weights, "one") == (("oak", 1.0),)


def test_a_file_that_is_absent_or_no_table_is_named(written):
    with pytest.raises(InputError, match=r"leaves\.toml cannot be read as TOML"):
        load("leaves", dict[str, str])
    written("oak = \n")
    with pytest.raises(InputError, match=r"leaves\.toml cannot be read as TOML"):
        load("leaves", dict[str, str])


def test_every_file_of_data_is_loaded_by_some_module():
    sources = [path.read_text() for path in tables.DATA.parent.rglob("*.py")]
    read = {path for source in sources for path in files_read_by(source)}
    by_name = {"generators", "places"}  # a file of each generator and country, found by its name
    files = [path for path in files_of() if path.parent.name not in by_name]
    assert len(files) > 30
    for path in files:
        assert path in read, f"nothing loads {path.name}"
        assert path.suffix != ".toml" or tomllib.loads(path.read_text(encoding="utf-8"))


def test_what_is_kept_is_of_the_data_it_was_made_from(tmp_path, monkeypatch):
    shutil.copytree(tables.DATA, tmp_path / "data", ignore=shutil.ignore_patterns("*.onnx"))
    before = kept_prototypes.edition.__wrapped__(), catalogue.code_digest.__wrapped__()
    monkeypatch.setattr(tables, "DATA", tmp_path / "data")
    assert before == (kept_prototypes.edition.__wrapped__(), catalogue.code_digest.__wrapped__())
    cars = tmp_path / "data" / "assets" / "cars.toml"
    cars.write_text(cars.read_text().replace("length = 4.05", "length = 4.06"))
    after = kept_prototypes.edition.__wrapped__(), catalogue.code_digest.__wrapped__()
    assert all(one != other for one, other in zip(before, after, strict=True))


def test_tables_that_an_earlier_run_has_read_are_the_files_of_now(tmp_path, monkeypatch):
    folder = tmp_path / "data"
    folder.mkdir()
    monkeypatch.setattr(tables, "DATA", folder)
    monkeypatch.setenv("CITYX_CACHE", str(tmp_path / "cache"))
    one, other = folder / "one.toml", folder / "other.toml"
    one.write_text("a = 1\n[b]\nc = [1.5, inf]\n")
    other.write_text("a = \n")

    def kept():
        return tables._kept_tables.__wrapped__()

    expected = {str(one): {"a": 1, "b": {"c": [1.5, inf]}}}
    assert kept() == kept() == expected
    other.write_text("a = 20\n")
    assert kept() == expected | {str(other): {"a": 20}}
    assert len(list((tmp_path / "cache").glob("*.json"))) == 2
