"""A reference program under tests/reference that answers one JSON line with one JSON line."""

from __future__ import annotations

import json
import os
import pathlib
import subprocess
from typing import Any

REFERENCE = pathlib.Path(__file__).resolve().parent / "reference"


class Oracle:
    """The program, started with the interpreter given; `ask` is one question."""

    def __init__(self, python: pathlib.Path, program: str, *arguments: str) -> None:
        environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
        self.process = subprocess.Popen(
            [str(python), str(REFERENCE / program), *arguments],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=environment,
        )

    def ask(self, **question: Any) -> Any:
        stdin, stdout = self.process.stdin, self.process.stdout
        assert stdin is not None and stdout is not None
        stdin.write(json.dumps(question) + "\n")
        stdin.flush()
        line = stdout.readline()
        assert line, f"the reference program died with code {self.process.wait()} at {question.get('type')}"
        return json.loads(line)

    def close(self) -> None:
        assert self.process.stdin is not None and self.process.stdout is not None
        self.process.stdin.close()
        self.process.wait(20)
        self.process.stdout.close()
