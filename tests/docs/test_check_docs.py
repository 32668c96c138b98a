"""The checker of the documentation catches what is not true."""

from __future__ import annotations

import pathlib
import textwrap

import pytest

from docs.pages import checker

check_docs = checker()


def problems(folder: pathlib.Path, page: str) -> list[str]:
    path = folder / "page.md"
    path.write_text(textwrap.dedent(page), encoding="utf-8")
    found: list[str] = check_docs.Page(path).run()
    return found


def test_true_blocks_pass(tmp_path: pathlib.Path) -> None:
    page = """\
    ```python file=hello.py
    print("hello", 2)
    ```

    ```python
    print("one"), print("two"), print(3)
    ```

    ```text
    one
    ...
    ```

    ```console
    $ python hello.py; export WHO=you
    hello 2
    $ echo $WHO > file
    $ false
    $ echo "$?
    > $(cat file) $ROS_MASTER_URI"
    ...
    you http://localhost:11311
    ```
    """
    wrong = problems(tmp_path, page)
    assert len(wrong) == 1 and "`false`: exit code 1" in wrong[0], wrong


@pytest.mark.parametrize(
    ("block", "complaint"),
    [
        ("```python\n1 +\n```", "page.md:2: invalid syntax"),
        ("```python file=x.py\n1 +\n```", "page.md:2: invalid syntax"),
        ("```python\nimport sys; sys.exit(3)\n```", "page.md:2: exit code 3"),
        ("```python\nprint(1)\n```\n\n```text\n2\n```", "page.md:6: printed:\n1"),
        ("```console\n$ echo 1\n2\n```", "page.md:2: `echo 1` printed:\n1"),
        ("```console\n$ echo 1\n```", "page.md:2: `echo 1` printed:\n1"),
        ("```console\n$ exit 0\n$ echo 1\n1\n```", "page.md:2: `exit 0` was not reached"),
        ("```console stays\n$ echo 1\n2\n```", "page.md:2: printed:\n1"),
    ],
)
def test_an_untrue_block_is_named(tmp_path: pathlib.Path, block: str, complaint: str) -> None:
    wrong = problems(tmp_path, block + "\n")
    assert len(wrong) == 1 and complaint in wrong[0], wrong


def test_excerpts_and_prose_do_not_run(tmp_path: pathlib.Path) -> None:
    page = "```python no-run\nraise SystemExit(1)\n```\n\n```text\nprose\n```\n\n```sh\nexit 1\n```\n"
    assert problems(tmp_path, page) == []


def test_a_terminal_that_stays_sees_what_later_blocks_do(tmp_path: pathlib.Path) -> None:
    page = """\
    ```console stays
    $ until [ -e done ]; do sleep 0.02; done; cat done; sleep 60
    yes
    ```

    ```console
    $ echo yes > done
    ```
    """
    assert problems(tmp_path, page) == []


@pytest.mark.parametrize(
    ("shown", "printed", "similar", "equal"),
    [
        ("a ... c", "a b c", False, True),
        ("a ... c", "a b", False, False),
        ("a\n...", "a\nb\nc", False, True),
        ("...\nc", "a\nb\nc", False, True),
        ("rate 1.5 ms", "rate   20 us", True, True),
        ("rate 1.5 ms", "rate   20 us", False, False),
        ("rate 1.5 ms", "state 1.5 ms", True, False),
        ("", "", False, True),
    ],
)
def test_shown_output_is_compared(shown: str, printed: str, similar: bool, equal: bool) -> None:
    assert check_docs.matches(shown, printed, similar) is equal
