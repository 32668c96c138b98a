"""How a peer program of the ROS 2 tests is told what to do: a line of JSON, [COMMAND, ARGUMENT...], answered by one line,
["ok", RESULT] or ["error", TEXT]. What happens meanwhile it keeps, until it is asked for.
"""

import gc
import json
import os
import sys
import traceback


def run(commands):
    """Obey until the input ends."""
    for line in sys.stdin:
        name, *arguments = json.loads(line)
        try:
            answer = ["ok", commands[name](*arguments)]
        except Exception:
            answer = ["error", traceback.format_exc()]
        print(json.dumps(answer), flush=True)


def process():
    """What this process holds of the system: descriptors, and resident memory in KiB."""
    gc.collect()
    with open("/proc/self/statm") as file:
        pages = int(file.read().split()[1])
    return {
        "pid": os.getpid(),
        "descriptors": len(os.listdir("/proc/self/fd")),
        "memory": pages * os.sysconf("SC_PAGESIZE") // 1024,
    }


def logged(entry):
    """Of an rcl_interfaces/msg/Log all but its time, of which only the seconds."""
    place = [entry.file.rpartition("/")[2], entry.function, entry.line > 0]
    return [entry.name, entry.level, entry.msg, *place, entry.stamp.sec]


def described(response):
    """A GetTypeDescription response as plain data."""

    def fields(one):
        return [
            [each.name, each.default_value]
            + [
                getattr(each.type, name)
                for name in ("type_id", "capacity", "string_capacity", "nested_type_name")
            ]
            for each in one.fields
        ]

    found = response.type_description
    every = [found.type_description, *found.referenced_type_descriptions]
    return [response.successful, [[one.type_name, fields(one)] for one in every]]


def fork(start):
    """A child that was forked before anything was begun, runs `start` and lives until it is killed; its pid."""
    pid = os.fork()
    if pid == 0:
        # The pipes are the parent's.
        nothing = os.open(os.devnull, os.O_RDWR)
        os.dup2(nothing, 0)
        os.dup2(nothing, 1)
        try:
            start()
        except BaseException:
            traceback.print_exc()
        os._exit(1)
    return pid


def kill(pid):
    """kill -9, until it is gone."""
    os.kill(pid, 9)
    os.waitpid(pid, 0)
