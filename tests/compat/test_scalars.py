"""Strings as rospy prints them, judged by PyYAML, which rospy prints them with."""

from __future__ import annotations

import json
import random
import subprocess

import peers
from roslet.compat.scalars import double_quoted, plain_or_quoted

# What a stored string looks like alone, and as an element of a list.
KNOWN = [
    ("hello", '"hello"', "hello"),
    ("", '""', "''"),
    ("a b", '"a b"', "a b"),
    ("é", '"\\xE9"', '"\\xE9"'),
    ("€ 😀", '"\\u20AC \\U0001F600"', '"\\u20AC \\U0001F600"'),
    ('say "it"', '"say \\"it\\""', 'say "it"'),
    ("it's", '"it\'s"', "it's"),
    ("a: b", '"a: b"', "'a: b'"),
    ("12", '"12"', "'12'"),
    ("0x1f", '"0x1f"', "'0x1f'"),
    ("1.5", '"1.5"', "'1.5'"),
    ("yes", '"yes"', "'yes'"),
    ("null", '"null"', "'null'"),
    ("#x", '"#x"', "'#x'"),
    ("- x", '"- x"', "'- x'"),
    (" x", '" x"', "' x'"),
    ("line\nbreak", '"line\\nbreak"', "'line\n\n  break'"),
    ("tab\t", '"tab\\t"', '"tab\\t"'),
    ("\x00\x1b\x85\u2028", '"\\0\\e\\N\\L"', '"\\0\\e\\N\\L"'),
    (
        "word " * 17,
        '"' + "word " * 16 + 'word "',
        "'" + "word " * 15 + "word\n  word '",
    ),
]

JUDGE = """
import json, sys, yaml
texts = json.load(sys.stdin)
print(json.dumps([[yaml.dump(text, default_style='"').rstrip("\\n"),
                   yaml.dump([text], default_flow_style=False)[2:].rstrip("\\n")] for text in texts]))
"""

ALPHABETS = [
    "abc xyz",
    'ab \n\t"\\é€😀',
    " ",
    "-?:,[]{}#&*!|>'\"%@`~=<",
    "0123456789.eE+-:_xT",
    "words and spaces ",
    "\x00\x7f\x85\xa0\u2028",
]


LOOKALIKES = [
    "y",
    "n",
    "on",
    "off",
    "~",
    "=",
    "<<",
    "1_0",
    "07",
    "0o7",
    ".5",
    "1e5",
    "1.0e+5",
    ".inf",
    ".nan",
]
LOOKALIKES += [
    "2020-01-01",
    "2020-1-1 1:02:03",
    "1:20",
    "190:20:30.15",
    "+1",
    "--",
    "---",
    "...",
    "?",
    ":",
    "a:",
]


def random_text(numbers: random.Random) -> str:
    alphabet = "".join(numbers.sample(ALPHABETS, numbers.randint(1, 3)))
    length = numbers.choice([0, 1, 2, 3, 5, 10, 30, 100, 250])
    if numbers.random() < 0.5:
        return "".join(numbers.choice(alphabet) for _ in range(length))
    words = [
        "".join(numbers.choice(alphabet) for _ in range(numbers.randint(1, 12))) for _ in range(length // 5)
    ]
    return " ".join(words)


def test_a_known_string_is_spelled_as_yaml_spells_it() -> None:
    for text, alone, in_list in KNOWN:
        assert (double_quoted(text), plain_or_quoted(text)) == (alone, in_list), text


def test_random_strings_are_spelled_and_folded_as_pyyaml_does() -> None:
    peers.require("rospy")
    numbers = random.Random("scalars")
    texts = [text for text, _, _ in KNOWN] + [random_text(numbers) for _ in range(3000)]
    texts += LOOKALIKES
    done = subprocess.run(
        [str(peers.DEBIAN_PYTHON), "-c", JUDGE],
        input=json.dumps(texts),
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    )
    for text, expected in zip(texts, json.loads(done.stdout), strict=True):
        assert [double_quoted(text), plain_or_quoted(text)] == expected, repr(text)
