"""The world for engines on MicroPython: one poller, one clock, sockets. One thread, nothing imported that a board lacks."""
