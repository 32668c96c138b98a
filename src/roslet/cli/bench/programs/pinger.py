"""What the programs of `roslet bench` share: a stack is told what to be, and says what it saw, in JSON lines.

    PROGRAM ping '{"cases": ["1", "1024", "coordinate"], "count": 200, "warm_up": 20}'
    PROGRAM echo '{}'
    PROGRAM mirror '{"types": ["std_msgs/Int8", ...]}'

`ping` publishes on `ping` and takes the time until the answer on `pong` is in its callback, one message in flight. A String
is one letter: the N-th of the alphabet asks for 2**N letters, as in the mROS paper, where one byte goes there and as many as
are measured come back. A Coordinate goes both ways. `mirror` says what it read of each message, and publishes it again.

Nothing but the standard library is here: the interpreter of each stack runs it. Standard input ends the program.
"""

import json
import os
import sys
import threading
import time

TEXT, COORDINATE = "text", "coordinate"
TOPICS = {TEXT: ("ping", "pong"), COORDINATE: ("ping_coordinate", "pong_coordinate")}
MATCH_SECONDS = 20.0
ANSWER_SECONDS = 2.0
LOSSES = 3
# Between probes, and how long nothing comes when no probe is under way any more.
PROBE, QUIET = 0.2, 0.15
LETTERS = "abcdefghijklmnopqrstuvwxyz"

closed = threading.Event()
_output = threading.Lock()


def say(fact):
    """One line for who started this."""
    with _output:
        print(json.dumps(fact), flush=True)


def letter(size):
    """What asks for `size` letters, a power of two."""
    return LETTERS[size.bit_length() - 1]


def answers(text):
    """How many letters a text asks for."""
    return 1 << LETTERS.index(text)


class Stack:
    """One client library. What is not here each has to bring: `publisher subscriber text coordinate`."""

    kinds = (TEXT, COORDINATE)

    def spin(self, predicate, seconds):
        """Until it holds or the time is over; the library calls back in threads of its own."""
        with self.changed:
            return self.changed.wait_for(predicate, seconds)

    def wake(self):
        """The predicate of `spin` may have become true."""
        with self.changed:
            self.changed.notify_all()

    def __init__(self):
        self.changed = threading.Condition()

    def fields(self, message):
        """Names of its fields, in order; None where it is no message."""
        return ("secs", "nsecs") if hasattr(message, "secs") else getattr(message, "__slots__", None)

    def close(self):
        """Leave the network."""

    def flat(self, value):
        """Every value in a message, in order."""
        if isinstance(value, (bool, int, float, str)):
            return [value]
        if isinstance(value, (bytes, bytearray, memoryview)):
            return list(bytes(value))
        if hasattr(value, "tolist"):
            return self.flat(value.tolist())
        names = self.fields(value)
        parts = value if names is None else [getattr(value, name) for name in names]
        return [leaf for part in parts for leaf in self.flat(part)]


class Pinger:
    """The sending and the receiving node of the paper, in one process, so that one clock counts."""

    def __init__(self, stack, kind):
        self.stack = stack
        self.kind = kind
        self.seen = 0
        self.left = 0
        self.begin = 0
        self.taken = []
        self.message = None
        there, back = TOPICS[kind]
        self.publish = stack.publisher(kind, there)
        stack.subscriber(kind, back, self.answered)

    def answered(self, message):
        now = time.perf_counter_ns()
        self.seen += 1
        if self.left:
            self.taken.append((now - self.begin) / 1000)
            self.left -= 1
            if self.left:
                self.send()
                return
        self.stack.wake()

    def send(self):
        self.begin = time.perf_counter_ns()
        self.publish(self.message)

    def find(self):
        """Until answers come, and those to the probes are in."""
        end = time.monotonic() + MATCH_SECONDS
        self.seen = 0
        while not self.seen and time.monotonic() < end and not closed.is_set():
            self.publish(self.message)
            self.stack.spin(lambda: self.seen, PROBE)
        before = -1
        while before != self.seen:
            before = self.seen
            self.stack.spin(lambda: False, QUIET)
        return bool(before)

    def measure(self, message, count, warm_up):
        """Round trips in microseconds, and how many messages were lost; None where nobody answers."""
        self.message = message
        if not self.find():
            return None
        lost, self.taken, self.left = 0, [], count + warm_up
        self.send()
        while self.left and lost <= LOSSES and not closed.is_set():
            before = len(self.taken)
            end = time.monotonic() + ANSWER_SECONDS
            while self.left and time.monotonic() < end:
                self.stack.spin(lambda: not self.left, 0.1)
            if self.left and len(self.taken) == before:
                lost += 1
                self.send()
        self.left = 0
        return self.taken[warm_up:], lost


def ping(stack, cases, count, warm_up):
    pingers = {}
    for case in cases:
        kind = COORDINATE if case == COORDINATE else TEXT
        if kind not in stack.kinds:
            continue
        if kind not in pingers:
            pingers[kind] = Pinger(stack, kind)
        message = stack.coordinate() if kind == COORDINATE else stack.text(letter(int(case)))
        found = pingers[kind].measure(message, count, warm_up)
        if found is None:
            say({"case": case, "failed": "nobody answers"})
        else:
            say({"case": case, "us": found[0], "lost": found[1]})
    say({"done": True})
    closed.wait()


def echo(stack):
    texts = {1 << power: stack.text("x" * (1 << power)) for power in range(16)}
    publish = stack.publisher(TEXT, TOPICS[TEXT][1])
    stack.subscriber(TEXT, TOPICS[TEXT][0], lambda message: publish(texts[answers(message.data)]))
    if COORDINATE in stack.kinds:
        back = stack.publisher(COORDINATE, TOPICS[COORDINATE][1])
        stack.subscriber(COORDINATE, TOPICS[COORDINATE][0], back)
    say({"ready": True})
    while not closed.is_set():
        stack.spin(closed.is_set, 0.25)


def mirror(stack, types):
    def one(number, type_name):
        publish = stack.publisher(type_name, "back_%d" % number)

        def heard(message):
            say({"type": number, "values": stack.flat(message)})
            publish(message)

        stack.subscriber(type_name, "there_%d" % number, heard)

    for number, type_name in enumerate(types):
        try:
            one(number, type_name)
        except (AttributeError, ImportError, KeyError, ValueError) as error:
            say({"type": number, "lacks": type_name, "why": repr(error)})
    say({"ready": True})
    while not closed.is_set():
        stack.spin(closed.is_set, 0.1)


def _listen():
    while sys.stdin.read(1):
        pass
    closed.set()


def main(make):
    """Be what the arguments say."""
    role, options = sys.argv[1], json.loads(sys.argv[2])
    threading.Thread(target=_listen, daemon=True).start()
    stack = make()
    {"ping": ping, "echo": echo, "mirror": mirror}[role](stack, **options)
    try:
        stack.close()
    finally:
        sys.stdout.flush()
        os._exit(0)  # whatever threads of the library are doing
