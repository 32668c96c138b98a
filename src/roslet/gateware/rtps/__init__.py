"""RTPS in gates: discovery, topics and their reliability, between UDP datagrams and messages of words.

`queue` makes words of datagrams, `walker` goes through their submessages, `submessages` and `discovery` do what they say;
`sender` decides what is to be sent and composes it from the templates of `rom`, and `outbox` sends it. What is known of
peers and of the node itself lies in two memories, laid out by `tables`.
"""
