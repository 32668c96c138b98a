"""DDS-RTPS 2.x on the wire: bytes to values and back, one module a submessage. Runs on MicroPython.

`message` walks a datagram; `participant_data` and `endpoint_data` are what SPDP
and SEDP carry. Section numbers are those of OMG DDSI-RTPS 2.3 (formal/2019-04-03). What a peer got wrong raises
ProtocolError with a named reason.
"""
