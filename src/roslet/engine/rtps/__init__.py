"""A DDS-RTPS participant without sockets or clocks: discovery, writers, readers. Runs on MicroPython.

`participant.Participant` is what a runtime drives; the other modules are its parts. Times that come in are float seconds of
any monotonic clock, source timestamps are int nanoseconds of the Unix epoch.
"""
