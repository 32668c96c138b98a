"""The parameter tree: namespaces, replacement, search, and who is told what."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from roslet.master.params import MAX_DEPTH, ParameterTree, changes, steps


@pytest.fixture
def tree() -> ParameterTree:
    made = ParameterTree()
    made.set("/robot", {"arm": {"length": 2}, "name": "r2"})
    made.set("/robot_description", "<robot/>")
    return made


def test_a_namespace_reads_as_a_dictionary(tree: ParameterTree) -> None:
    assert tree.get("/robot") == {"arm": {"length": 2}, "name": "r2"}
    assert tree.get("/robot/arm/length") == 2
    assert tree.get("//robot//arm/") == {"length": 2}
    assert tree.get("/")["robot_description"] == "<robot/>"


def test_what_is_not_set_raises_and_is_not_there(tree: ParameterTree) -> None:
    for key in ("/none", "/robot/none", "/robot/name/deeper", "/robot_description/x"):
        with pytest.raises(KeyError):
            tree.get(key)
        assert not tree.has(key)
    assert tree.has("/robot")
    assert tree.has("/")


def test_a_dictionary_replaces_the_namespace(tree: ParameterTree) -> None:
    tree.set("/robot", {"legs": 4})
    assert tree.names() == ["/robot/legs", "/robot_description"]


def test_a_value_in_the_way_is_replaced_by_a_namespace(tree: ParameterTree) -> None:
    tree.set("/robot/name/first", "r")
    assert tree.get("/robot/name") == {"first": "r"}


def test_the_root_takes_only_a_dictionary(tree: ParameterTree) -> None:
    with pytest.raises(ValueError, match="dictionary"):
        tree.set("/", 5)
    tree.set("/", {"only": 1})
    assert tree.names() == ["/only"]


def test_deleting_removes_a_value_or_a_namespace_but_never_the_root(tree: ParameterTree) -> None:
    tree.delete("/robot/arm")
    assert tree.names() == ["/robot/name", "/robot_description"]
    tree.delete("/robot")
    for key in ("/robot", "/", "/robot_description/x", "/a/b/c"):
        with pytest.raises(KeyError):
            tree.delete(key)
    assert tree.names() == ["/robot_description"]


def test_an_empty_dictionary_is_a_namespace_without_names(tree: ParameterTree) -> None:
    tree.set("/empty", {})
    assert tree.has("/empty")
    assert "/empty" not in tree.names()


def test_search_goes_upwards_and_looks_for_the_first_step_only(tree: ParameterTree) -> None:
    tree.set("/ns/robot", {"x": 1})
    assert tree.search("/ns/sub/node", "robot") == "/ns/robot"
    assert tree.search("/ns/sub/node", "robot/arm") == "/ns/robot/arm"
    assert tree.search("/other/node", "robot/arm") == "/robot/arm"
    assert tree.search("/ns", "robot") == "/ns/robot"
    assert tree.search("/", "robot") == "/robot"
    assert tree.search("/ns/node", "nothing") is None
    assert tree.search("/ns/node", "/robot") == "/robot"
    assert tree.search("/ns/node", "/nothing") is None


@pytest.mark.parametrize(("namespace", "key"), [("/n", ""), ("/n", "~x"), ("n", "x"), ("/n", "//")])
def test_search_refuses_what_has_no_meaning(namespace: str, key: str) -> None:
    if key == "//":
        assert ParameterTree().search(namespace, key) == "//"
        return
    with pytest.raises(ValueError, match=r"cannot search|not global"):
        ParameterTree().search(namespace, key)


def test_a_tree_that_could_not_be_read_again_is_not_stored() -> None:
    tree = ParameterTree()
    tree.set("/a" * MAX_DEPTH, 1)
    with pytest.raises(ValueError, match="deep"):
        tree.set("/b" * (MAX_DEPTH + 1), 1)
    value: Any = 1
    for _ in range(MAX_DEPTH):
        value = [value]
    with pytest.raises(ValueError, match="deep"):
        tree.set("/c", value)
    assert tree.search("/", "b") is None


@pytest.mark.parametrize(
    ("subscribed", "key", "value", "told"),
    [
        ("/a/", "/a", 1, [("/a/", "/a/", 1)]),
        ("/a/", "/a/b", 1, [("/a/", "/a/b/", 1)]),
        ("/", "/a", 1, [("/", "/a/", 1)]),
        ("/a/b/", "/a", {"b": 1}, [("/a/b/", "/a/b/", 1)]),
        ("/a/b/c/", "/a", {"b": {"c": {"d": 1}}}, [("/a/b/c/", "/a/b/c/", {"d": 1})]),
        ("/a/c/", "/a", {"b": 1}, [("/a/c/", "/a/c/", {})]),
        ("/a/b/", "/a", 5, [("/a/b/", "/a/b/", {})]),
        ("/ab/", "/a", 1, []),
        ("/a/", "/ab", 1, []),
    ],
)
def test_subscribers_around_and_inside_a_key_are_told(
    subscribed: str, key: str, value: Any, told: list[tuple[str, str, Any]]
) -> None:
    assert changes([subscribed], key, value) == told


def test_subscribers_are_told_of_a_deletion_by_an_empty_dictionary() -> None:
    assert changes(["/a/", "/a/b/", "/a/b/c/", "/d/"], "/a/b", 1, deleted=True) == [
        ("/a/", "/a/b/", {}),
        ("/a/b/", "/a/b/", {}),
        ("/a/b/c/", "/a/b/c/", {}),
    ]


def test_what_subscribers_are_told_does_not_change_later() -> None:
    tree = ParameterTree()
    value = {"b": {"c": 1}}
    tree.set("/a", value)
    ((_, _, told),) = changes(["/a/"], "/a", value)
    tree.set("/a/b/c", 2)
    assert told == {"b": {"c": 1}}


KEYS = st.lists(st.sampled_from("abc"), min_size=1, max_size=4).map(lambda path: "/" + "/".join(path))
VALUES = st.recursive(
    st.integers(0, 3), lambda inner: st.dictionaries(st.sampled_from("abc"), inner, max_size=2), max_leaves=4
)


@given(
    operations=st.lists(st.tuples(KEYS, VALUES | st.none()), max_size=12),
    watched=st.lists(KEYS, unique=True, max_size=4),
)
def test_somebody_who_follows_the_updates_knows_the_value(
    operations: list[tuple[str, Any]], watched: list[str]
) -> None:
    """A subscriber's copy, kept only by what it is told, equals what getParam would answer."""
    tree = ParameterTree()
    copies = {key: ParameterTree() for key in watched}
    for key, value in operations:
        if value is None:
            try:
                tree.delete(key)
            except KeyError:
                continue
        else:
            tree.set(key, value)
        for name, changed, told in changes([key + "/" for key in watched], key, value, value is None):
            copies[name[:-1]].set("/".join(["", *steps(changed)]), told)
    for key in watched:
        assert _pruned(copies[key], key) == _pruned(tree, key)


def _pruned(tree: ParameterTree, key: str) -> Any:
    """The value without empty namespaces: an empty dictionary also says that there is nothing."""

    def prune(value: Any) -> Any:
        if not isinstance(value, dict):
            return value
        inner = {step: prune(item) for step, item in value.items()}
        return {step: item for step, item in inner.items() if item != {}}

    return prune(tree.get(key)) if tree.has(key) else {}
