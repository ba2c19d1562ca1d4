"""Files that are no experiment, whatever is in them: one sentence, at once."""

from __future__ import annotations

from pathlib import Path

import pytest

from flexscale.errors import LONGEST_LINE, ConfigError
from flexscale.steps.experiment import load_experiment
from flexscale.steps.yaml_file import DEEPEST, MOST_BYTES, read_yaml

BOMB = "\n".join(
    ["b0: &b0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]"]
    + [f"b{k}: &b{k} [{', '.join([f'*b{k - 1}'] * 10)}]" for k in range(1, 12)]
)
FILES: dict[str, tuple[str | bytes, str]] = {
    "no whole number": ("a: 1\ngap: !!int abc", r"line 2: 'abc' is no int\."),
    "no number": ("gap: !!float x", "line 1: 'x' is no float"),
    "no truth value": ("gap: !!bool maybe", "line 1: 'maybe' is no bool"),
    "no such day": ("gap: 2020-13-45", "line 1: '2020-13-45' is no timestamp"),
    "a list as a key": ("a: 1\n? [a] : 1", r"line 2: \['a'\] cannot be a key"),
    "many digits": (f"gap: {'9' * 4400}", "line 1: '9+...9+' is no int"),
    "an object": ("gap: !!python/object/apply:os.getcwd []", "could not determine a constructor"),
    "300 levels": ("[" * 300 + "]" * 300, f"line 1: lists and mappings lie more than {DEEPEST}"),
    "an alias bomb": (BOMB, "stands for more than 1000000 values"),
    "a list in itself": ("a: &a [*a]", "stands for more than"),
    "an unknown alias": ("a: *nothing", "not readable YAML"),
    "tabs": ("a:\n\t- 1", "not readable YAML"),
    "NUL": ("a: \0", "not readable YAML"),
    "two documents": ("a: 1\n---\nb: 2", "not readable YAML"),
    "UTF-16": ("patterns: {}".encode("utf-16"), "byte 0 is no UTF-8"),
    "latin-1": (b"# \xe9\na: 1", "byte 2 is no UTF-8"),
    "a key twice": ("a: 1\na: 2", "line 2: the key 'a' is given twice"),
    "large": (b"#" * (MOST_BYTES + 1), "has more than"),
}


@pytest.mark.parametrize("case", FILES)
def test_each_is_refused_with_its_place(case: str, tmp_path: Path) -> None:
    content, words = FILES[case]
    path = tmp_path / "experiment.yaml"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(ConfigError, match=words) as caught:
        load_experiment(path)
    assert str(caught.value).startswith(str(path))
    assert all(len(line) <= LONGEST_LINE for line in str(caught.value).split("\n"))


def test_what_is_no_file(tmp_path: Path) -> None:
    for path in (tmp_path, Path("/dev/zero"), tmp_path / "a\0b", tmp_path / ("x" * 300)):
        with pytest.raises(ConfigError):
            load_experiment(path)


def test_a_byte_order_mark_and_aliases_are_no_mistake(tmp_path: Path) -> None:
    path = tmp_path / "file.yaml"
    path.write_text("a: &a [1, 2]\nb: *a\n", encoding="utf-8-sig")
    assert read_yaml(path) == {"a": [1, 2], "b": [1, 2]}
