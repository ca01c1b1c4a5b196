import pytest

from cityx.system.atomic import replaced


def test_the_file_appears_when_the_block_ends(tmp_path):
    target = tmp_path / "new" / "report.json"
    with replaced(target) as temporary:
        temporary.write_text("{}")
        assert temporary.suffix == ".json"
        assert not target.exists()
    assert target.read_text() == "{}"
    assert list(target.parent.iterdir()) == [target]


def test_an_error_keeps_the_old_file_and_leaves_nothing_beside_it(tmp_path):
    target = tmp_path / "city.glb"
    target.write_text("old")

    def fail():
        with replaced(target) as temporary:
            temporary.write_text("half")
            raise RuntimeError("full disk")

    with pytest.raises(RuntimeError, match="full disk"):
        fail()
    assert target.read_text() == "old"
    assert list(tmp_path.iterdir()) == [target]


def test_a_block_that_writes_nothing_is_an_error(tmp_path):
    with pytest.raises(FileNotFoundError), replaced(tmp_path / "a.txt"):
        pass
    assert not list(tmp_path.iterdir())
