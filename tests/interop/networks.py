"""Talkers and listeners on different networks: whether samples get through."""

from __future__ import annotations

import time

from interop import rtps
from interop.namespace import Namespace, Program

# Seconds after both are ready: what has not been heard by then is not going to be. Ours announce themselves twice a second;
# Fast DDS and Cyclone, which come to a talker that is there, five times in the first half second, or at once.
SILENCE = 1.5
# Seconds: of our programs here, and of Fast DDS with this profile.
LEASE = 3.0
PROFILE = """<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns="http://www.eprosima.com"><profiles><participant profile_name="hasty" is_default_profile="true"><rtps><builtin>
<discovery_config><leaseDuration><sec>3</sec></leaseDuration><leaseAnnouncement><sec>1</sec></leaseAnnouncement>
</discovery_config></builtin></rtps></participant></profiles></dds>
"""


def _start(at: Namespace, peer: str, role: str, count: int, *words: str, **environment: str) -> Program:
    if peer == "roslet":
        words = (*words, "hasty")
    profile = at.folder / "hasty.xml"
    profile.write_text(PROFILE)
    command = rtps.command(peer, role, count, *words)
    program = at.start(*command, name=role, FASTDDS_DEFAULT_PROFILES_FILE=str(profile), **environment)
    program.wait_for("ready")
    return program


def talk(at: Namespace, peer: str, *words: str, count: int = 3, **environment: str) -> Program:
    """A talker that has begun to look for a listener."""
    return _start(at, peer, "talker", count, *words, **environment)


def listen(at: Namespace, peer: str, *words: str, count: int = 3, **environment: str) -> Program:
    """A listener that has begun to look for a talker."""
    return _start(at, peer, "listener", count, *words, **environment)


def check_heard(listener: Program, count: int = 3) -> None:
    """Every sample arrives."""
    assert listener.finish() == ["ready"] + [f"heard hello {number}" for number in range(count)]


def check_silence(*programs: Program) -> None:
    """Nothing arrives, although all still run."""
    time.sleep(SILENCE)
    for program in programs:
        assert program.lines() == ["ready"]
        assert program.process.poll() is None
