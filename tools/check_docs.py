"""Runs the code blocks of README.md and docs/: `check_docs.py [FILE...]`.

The blocks of a page run in order, in one empty folder, with a master of ours on a free port and a ROS 2 domain that does
not leave this host. What a block is, its info
string says:

    python             runs in a process of its own and must exit 0; a `text` block right after it is its standard output
    python no-run      is only compiled: an excerpt
    console            commands after `$ ` (`> ` continues one) and what they print; run by bash. A command for which no
                       output is shown must exit 0
    console stays      a terminal of its own, whose last command goes on until the page ends. What it prints must begin
                       with what is shown
    LANGUAGE file=NAME is written to the file NAME in the page's folder (Python is compiled)
    similar            (after `console` or `text`) numbers, their units and spaces may differ

Any other block is prose. In shown output a line of three dots stands for any lines, three dots within a line for any
text. The default port 11311 in commands and output stands for the page's own. A page that runs `roslet master` itself
gets no other.
"""

from __future__ import annotations

import ast
import os
import pathlib
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
LIMIT = 40.0  # seconds for one block
SETTLE = 1.5  # seconds for a block that stays to print something before the page goes on
PORT = "11311"
FENCE = re.compile(r"^```(\w*)([^\n]*)\n(.*?)^```\s*?$", re.MULTILINE | re.DOTALL)
MARK = "\x01"  # between the output of two commands
NUMBER = re.compile(r"-?\d+(\.\d+)?([eE][-+]?\d+)?( ?(us|ms|s|B|kB|MB|GB|KiB|MiB)\b)?")


class Block:
    """One fenced block. `line` is that of its first line of code."""

    def __init__(self, page: pathlib.Path, text: str, found: re.Match[str]) -> None:
        self.page = page
        self.line = text.count("\n", 0, found.start(3)) + 1
        self.language = found[1]
        self.words = found[2].split()
        self.source = found[3]
        # Whether nothing but empty lines stands between the block before and this one.
        self.follows = text[: found.start()].rstrip().endswith("```")
        self.output: Block | None = None

    @property
    def where(self) -> str:
        """The place, for people."""
        page = self.page.relative_to(ROOT) if self.page.is_relative_to(ROOT) else self.page
        return f"{page}:{self.line}"

    @property
    def file(self) -> str | None:
        """The file that the block is written to."""
        return next((word[5:] for word in self.words if word.startswith("file=")), None)

    @property
    def runs(self) -> bool:
        """Whether the block is more than prose."""
        return self.file is not None or self.language in ("python", "console")


def blocks(page: pathlib.Path) -> list[Block]:
    """The blocks of a page that are to be checked, each with the block that shows its output."""
    text = page.read_text(encoding="utf-8")
    found: list[Block] = []
    previous: Block | None = None
    for match in FENCE.finditer(text):
        block = Block(page, text, match)
        if block.language == "text" and block.file is None:
            if previous is not None and previous.language == "python" and block.follows:
                previous.output = block
        elif block.runs:
            found.append(block)
        previous = block
    return found


def commands(block: Block) -> list[tuple[str, str]]:
    """The commands of a console block and the output shown for each."""
    found: list[tuple[str, list[str]]] = []
    for line in block.source.splitlines():
        if line.startswith("$ "):
            found.append((line[2:], []))
        elif line.startswith("> ") and found and not found[-1][1]:
            found[-1] = (found[-1][0] + "\n" + line[2:], [])
        elif found:
            found[-1][1].append(line)
    return [(command, "\n".join(shown)) for command, shown in found]


def matches(shown: str, printed: str, similar: bool, begins: bool = False) -> bool:
    """Whether `printed` is what was shown; `begins`: whether it begins so."""
    shown, printed = shown.strip("\n"), printed.strip("\n")
    if similar:
        shown, printed = _vague(shown), _vague(printed)
    parts = []
    for line in shown.split("\n"):
        if line.strip() == "...":
            parts.append(r"(?:.*\n)*?")
        else:
            parts.append(re.escape(line.rstrip()).replace(r"\.\.\.", ".*") + r"[ \t]*\n")
    pattern = "".join(parts)
    printed = printed + "\n" if printed or shown else "\n"
    found = re.match(pattern, printed) if begins else re.fullmatch(pattern, printed)
    return found is not None


def _vague(text: str) -> str:
    return "\n".join(" ".join(NUMBER.sub("0", line).split()) for line in text.split("\n"))


def free_port() -> int:
    """A TCP port on which nobody listens now."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port


class Process:
    """A command in a process group of its own, its output in a file."""

    def __init__(
        self, command: list[str], folder: pathlib.Path, environment: dict[str, str], apart: bool = False
    ) -> None:
        self._output = tempfile.TemporaryFile()  # noqa: SIM115 - closed by `end`
        self._errors = tempfile.TemporaryFile() if apart else None  # noqa: SIM115
        self._process = subprocess.Popen(
            command,
            cwd=folder,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=self._output,
            stderr=subprocess.STDOUT if self._errors is None else self._errors,
            start_new_session=True,
        )

    def output(self) -> str:
        """What it has printed so far; without standard error, where that is kept apart."""
        return self._read(self._output.fileno())

    def errors(self) -> str:
        """What it has printed to standard error, where that is kept apart."""
        return "" if self._errors is None else self._read(self._errors.fileno())

    def _read(self, fd: int) -> str:
        # pread: the offset belongs to the child as well.
        return os.pread(fd, os.fstat(fd).st_size, 0).decode("utf-8", "replace")

    def wait(self, seconds: float) -> int | None:
        """The exit code; None where it still runs after so long."""
        try:
            return self._process.wait(seconds)
        except subprocess.TimeoutExpired:
            return None

    def end(self) -> None:
        """Interrupt it as Ctrl-C does, and then kill what is left of its group."""
        for number, patience in ((signal.SIGINT, 5.0), (signal.SIGKILL, 5.0)):
            try:
                os.killpg(self._process.pid, number)
            except ProcessLookupError:
                break
            self.wait(patience)
        self.wait(5.0)
        self._output.close()
        if self._errors is not None:
            self._errors.close()


class Page:
    """Runs the blocks of one page."""

    def __init__(self, page: pathlib.Path) -> None:
        self.blocks = blocks(page)
        self.page = page
        self.problems: list[str] = []
        self._port = str(free_port())
        self._stay: list[tuple[Block, Process]] = []

    def run(self) -> list[str]:
        """What is wrong, one text for each block."""
        own = any(
            command.startswith("roslet master") and "--port" not in command
            for block in self.blocks
            if block.language == "console"
            for command, _ in commands(block)
        )
        with tempfile.TemporaryDirectory() as name:
            self._folder = pathlib.Path(name)
            self._environment = dict(
                os.environ,
                ROS_MASTER_URI=f"http://localhost:{self._port}",
                ROS_DOMAIN_ID=str(1 + os.getpid() % 100),
                ROS_AUTOMATIC_DISCOVERY_RANGE="LOCALHOST",
                ROS_HOSTNAME="localhost",
                PATH=os.path.dirname(sys.executable) + os.pathsep + os.environ.get("PATH", ""),
                PYTHONUNBUFFERED="1",
                HOME=name,
            )
            master = None if own else self._start_master()
            try:
                for block in self.blocks:
                    self._run(block)
                for block, process in self._stay:
                    self._check_stay(block, process)
            finally:
                for _, process in reversed(self._stay):
                    process.end()
                if master is not None:
                    master.end()
        return self.problems

    def _start_master(self) -> Process | None:
        if not any(block.runs for block in self.blocks):
            return None
        master = Process(
            [sys.executable, "-m", "roslet", "master", "--port", self._port], self._folder, self._environment
        )
        end = time.monotonic() + 10
        while time.monotonic() < end:
            with socket.socket() as probe:
                if probe.connect_ex(("127.0.0.1", int(self._port))) == 0:
                    return master
            time.sleep(0.02)
        text = master.output()
        master.end()
        raise SystemExit(f"check_docs.py: `roslet master` does not start: {text}")

    def _wrong(self, block: Block, text: str) -> None:
        self.problems.append(f"{block.where}: {text}")

    def _run(self, block: Block) -> None:
        if block.language == "python":
            try:
                compile("\n" * (block.line - 1) + block.source, str(self.page), "exec", ast.PyCF_ONLY_AST)
            except SyntaxError as error:
                self._wrong(block, str(error))
                return
        if block.file is not None:
            path = self._folder / block.file
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(block.source.replace(PORT, self._port), encoding="utf-8")
        elif block.language == "console":
            self._run_console(block)
        elif "no-run" not in block.words:
            self._run_python(block)

    def _run_python(self, block: Block) -> None:
        command = [sys.executable, "-c", block.source.replace(PORT, self._port)]
        process = Process(command, self._folder, self._environment, apart=True)
        code = process.wait(LIMIT)
        printed = process.output().replace(self._port, PORT)
        errors = process.errors()
        process.end()
        if code is None:
            self._wrong(block, f"still running after {LIMIT:g} s\n{printed}{errors}")
        elif code:
            self._wrong(block, f"exit code {code}\n{printed}{errors}")
        elif block.output is not None:
            shown = block.output
            if not matches(shown.source, printed, "similar" in shown.words):
                self._wrong(shown, f"printed:\n{printed}")

    def _run_console(self, block: Block) -> None:
        todo = commands(block)
        script = ["set +m"]
        for command, _ in todo:
            script.append(command.replace(PORT, self._port))
            script.append(f"__code=$?; printf '{MARK}%d{MARK}' $__code; (exit $__code)")
        process = Process(["bash", "-c", "\n".join(script)], self._folder, self._environment)
        if "stays" in block.words:
            self._stay.append((block, process))
            end = time.monotonic() + SETTLE
            while time.monotonic() < end and not process.output() and process.wait(0.02) is None:
                pass
            return
        code = process.wait(LIMIT)
        printed = process.output().replace(self._port, PORT)
        process.end()
        results = printed.split(MARK)
        if code is None:
            self._wrong(block, f"still running after {LIMIT:g} s\n{printed}")
            return
        for at, (command, shown) in enumerate(todo):
            if 2 * at + 1 >= len(results):
                self._wrong(block, f"`{command}` was not reached\n{printed}")
                return
            text, status = results[2 * at], results[2 * at + 1]
            if not shown and status != "0":
                self._wrong(block, f"`{command}`: exit code {status}\n{text}")
            elif (shown or text.strip()) and not matches(shown, text, "similar" in block.words):
                self._wrong(block, f"`{command}` printed:\n{text}")

    def _check_stay(self, block: Block, process: Process) -> None:
        shown = "\n".join(shown for _, shown in commands(block) if shown)
        end = time.monotonic() + LIMIT
        while True:
            printed = re.sub(f"{MARK}.*?{MARK}", "", process.output()).replace(self._port, PORT)
            if not shown or matches(shown, printed, "similar" in block.words, begins=True):
                return
            if time.monotonic() >= end or process.wait(0.05) is not None:
                self._wrong(block, f"printed:\n{printed}")
                return


def pages() -> list[pathlib.Path]:
    """Every page that is checked."""
    root = [ROOT / name for name in ("README.md", "FEATURES.md", "CONTRIBUTING.md")]
    return [page for page in (*root, *sorted((ROOT / "docs").rglob("*.md"))) if page.exists()]


def main(arguments: list[str]) -> int:
    """Check the pages named, or all; the exit code."""
    count = wrong = 0
    for path in [pathlib.Path(argument).resolve() for argument in arguments] or pages():
        page = Page(path)
        problems = page.run() if page.blocks else []
        count += len(page.blocks)
        wrong += len(problems)
        for problem in problems:
            print(problem, file=sys.stderr)
    print(f"{count} blocks, {wrong} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
