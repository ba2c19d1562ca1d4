"""YAML files as people and programs write them: plain data, or one sentence on what is wrong."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml

from flexscale.errors import ConfigError, shown

MOST_BYTES = 20_000_000
DEEPEST = 50  # levels of lists and mappings in one another
MOST_VALUES = 1_000_000  # what aliases stand for included


def read_yaml(path: Path) -> Any:
    """What a YAML file holds: dicts, lists, texts, numbers, truth values, dates and None.

    Raises
    ------
    ConfigError : the file cannot be read, is too large, or is no YAML; with the line where known.
    """
    try:
        if path.exists() and not path.is_file():
            raise ConfigError(f"{path} is no file: give an experiment file.")
        with path.open("rb") as file:
            data = file.read(MOST_BYTES + 1)
    except OSError as error:
        raise ConfigError(f"{path} cannot be read: {error.strerror}.") from error
    except ValueError as error:
        raise ConfigError(f"{shown(str(path))} cannot be read: {error}.") from error
    if len(data) > MOST_BYTES:
        raise ConfigError(f"{path} has more than {MOST_BYTES} bytes: give an experiment file.")
    try:
        return _load(data.decode("utf-8-sig"))
    except UnicodeDecodeError as error:
        raise ConfigError(
            f"{path} is not readable YAML: byte {error.start} is no UTF-8: save it as UTF-8."
        ) from error
    except yaml.YAMLError as error:
        reason = " ".join(str(error).split())
        raise ConfigError(f"{path} is not readable YAML: {reason}.") from error
    except ConfigError as error:
        raise ConfigError(f"{path}: {error}") from error


def _load(text: str) -> Any:
    loader = _Loader(text)
    try:
        node = loader.get_single_node()
        if node is None:
            return None
        if _count(node, {}) > MOST_VALUES:
            raise ConfigError(f"the file stands for more than {MOST_VALUES} values.")
        return loader.construct_document(node)
    finally:
        loader.dispose()


def _count(node: yaml.Node, known: dict[int, int]) -> int:
    """How many values a node stands for, those of aliases as often as they occur."""
    if id(node) not in known:
        known[id(node)] = MOST_VALUES + 1  # until it is counted: an alias in its own anchor
        children: list[yaml.Node] = []
        if isinstance(node, yaml.MappingNode):
            children = [item for pair in node.value for item in pair]
        elif isinstance(node, yaml.SequenceNode):
            children = node.value
        known[id(node)] = 1 + sum(_count(child, known) for child in children)
    return known[id(node)]


class _Loader(yaml.SafeLoader):
    """Refuses keys given twice, deep nesting, and what cannot be what it is marked as."""

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self._depth = 0

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        """One value of the file, and all in it."""
        self._depth += 1
        if self._depth > DEEPEST:
            line = self.peek_event().start_mark.line + 1
            raise ConfigError(f"line {line}: lists and mappings lie more than {DEEPEST} deep.")
        node: yaml.Node | None = super().compose_node(parent, index)
        self._depth -= 1
        return node

    def construct_object(self, node: yaml.Node, deep: bool = False) -> Any:
        """A value of plain Python."""
        try:
            return super().construct_object(node, deep=deep)
        except (ValueError, LookupError, AttributeError, TypeError, OverflowError) as error:
            kind = node.tag.rpartition(":")[2]
            raise ConfigError(
                f"line {node.start_mark.line + 1}: {shown(node.value)} is no {kind}."
            ) from error


def _mapping_without_repeats(loader: _Loader, node: yaml.MappingNode) -> dict[Any, Any]:
    mapping: dict[Any, Any] = {}
    for key_node, value_node in node.value:
        key = loader.construct_object(key_node, deep=True)
        line = key_node.start_mark.line + 1
        if isinstance(key, list | dict | set):
            raise ConfigError(f"line {line}: {shown(key)} cannot be a key: write a text.")
        if key in mapping:
            raise ConfigError(f"line {line}: the key {shown(key)} is given twice: keep one.")
        mapping[key] = loader.construct_object(value_node, deep=True)
    return mapping


_Loader.add_constructor("tag:yaml.org,2002:map", _mapping_without_repeats)
