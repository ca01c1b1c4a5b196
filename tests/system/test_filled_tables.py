from collections.abc import Mapping
from dataclasses import dataclass

import pytest

from cityx.errors import InputError
from cityx.system.tables import filled, read_table


@dataclass(frozen=True)
class Part:
    name: str
    share: float = 1.0


@dataclass(frozen=True)
class Whole:
    parts: tuple[Part, ...]
    doors: tuple[tuple[str, float], ...] = ()
    size: tuple[float, float] = (1.0, 2.0)
    named: Mapping[str, Part] | None = None
    street: bool | None = None


def test_tables_become_dataclasses_and_arrays_tuples():
    made = filled(Whole, {"parts": [{"name": "a", "share": 1}], "size": [3, 4]}, "x.toml")
    assert made == Whole((Part("a", 1.0),), size=(3.0, 4.0))
    assert type(made.parts[0].share) is float


def test_pairs_of_words_and_numbers_may_be_a_table_or_one_word():
    made = [
        filled(Whole, {"parts": [], "doors": doors}, "") for doors in ("oak", {"oak": 2, "": 1})
    ]
    assert [each.doors for each in made] == [(("oak", 1.0),), (("oak", 2.0), ("", 1.0))]


@pytest.mark.parametrize(
    ("table", "message"),
    [
        ({"part": []}, 'x.toml: there is no key "part". Did you mean "parts"?'),
        ({}, 'x.toml: the key "parts" is missing.'),
        ({"parts": 3}, "x.toml, parts: 3 is not an array."),
        ({"parts": [], "size": [1]}, "x.toml, size: [1] is not an array of 2."),
        ({"parts": [], "street": 1}, "x.toml, street: 1 is not of type true or false."),
        ({"parts": [{"name": 1}]}, "x.toml, parts, name: 1 is not of type text."),
        ({"parts": [], "named": {"a": {"nam": ""}}},
         'x.toml, named.a: there is no key "nam". Did you mean "name"?'),
    ],
)  # fmt: skip
def test_a_fault_of_a_table_is_one_sentence_with_its_place(table, message):
    with pytest.raises(InputError) as error:
        filled(Whole, table, "x.toml")
    assert str(error.value) == message


def test_what_is_no_toml_is_named_with_its_line(tmp_path):
    (tmp_path / "x.toml").write_text("a = 1\nb = \n")
    with pytest.raises(InputError, match=r"x\.toml cannot be read as TOML: .*line 2"):
        read_table(tmp_path / "x.toml")
