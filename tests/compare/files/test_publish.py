"""An old result is replaced only by a complete new one."""

from __future__ import annotations

from pathlib import Path

import pytest

from compare.files.publish import staged


def _write(folder: Path, **files: str) -> None:
    for name, text in files.items():
        (folder / name).write_text(text)


def test_files_appear_only_when_the_block_has_succeeded(tmp_path: Path) -> None:
    target = tmp_path / "new" / "output"
    with staged(target) as stage:
        _write(stage, a="1", b="2")
        assert not (target / "a").exists()
    assert (target / "a").read_text() == "1"
    assert sorted(path.name for path in target.iterdir()) == ["a", "b"]


def test_a_failure_leaves_the_old_result_whole(tmp_path: Path) -> None:
    with staged(tmp_path) as stage:
        _write(stage, a="old", b="old")
    with pytest.raises(ValueError, match="cannot be written"), staged(tmp_path) as stage:
        _write(stage, **{"a": "new", "no/such/folder": ""})
    assert (tmp_path / "a").read_text() == (tmp_path / "b").read_text() == "old"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a", "b"]


def test_files_of_others_are_never_touched(tmp_path: Path) -> None:
    _write(tmp_path, mine="keep")
    with staged(tmp_path) as stage:
        _write(stage, a="1")
        (stage / "sub").mkdir()
        _write(stage / "sub", c="3")
    assert (tmp_path / "mine").read_text() == "keep"
    assert (tmp_path / "sub" / "c").read_text() == "3"


def test_a_folder_in_the_place_of_a_file_is_named(tmp_path: Path) -> None:
    (tmp_path / "b").mkdir()
    with pytest.raises(ValueError, match=r"b: results cannot be written \(Is a directory\)"), staged(tmp_path) as stage:
        _write(stage, a="new", b="new")


def test_a_full_disk_is_named(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"cannot be written .*No space left"), staged(tmp_path):
        Path("/dev/full").write_text("result")


def test_a_folder_that_cannot_be_made_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(ValueError, match="cannot be written to"), staged(tmp_path / "file"):
        pass
