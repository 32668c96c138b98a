"""What each counted reason means that ROS 2 adds to those of RTPS: names in `Node.counters` of a node on ROS 2, and in
`Context.counters`. The others are in `engine.rtps.reasons`.

Nothing is refused, dropped or given up without one of these being counted.
"""

REASONS = {
    # what participants tell of their nodes
    "discovery-info-encapsulation": "what a participant tells of its nodes is in no encapsulation that it can be in",
    "discovery-info-gid": "octets where the gids of older participants have zeros",
    "discovery-info-incompatible": "a participant offers or requests it with another QoS than ROS 2 has",
    "discovery-info-name": "the name or namespace of a node that is none",
    "discovery-info-of-another-participant": "a participant tells of another's nodes",
    "discovery-info-of-unknown-participant": "a participant tells of its nodes that has just gone",
    "discovery-info-too-large": "it is longer, or tells of more nodes or endpoints, than is taken",
    "discovery-info-too-long": "octets are left over behind it",
    "discovery-info-truncated": "it ends too early for what it must hold",
    # topics
    "blocked-too-long": "keep_all: a message was dropped because a subscription acknowledged nothing for too long",
    "datagram-not-sent": "the kernel did not take a datagram",
    "malformed-message": "bytes that are no message of the topic's type",
    "message-too-large": "a message is longer than the subscription allows",
    "messages-lost": "messages of a publisher will never come; counted once each time that it is noticed",
    "receive-queue-full": "the oldest message that nobody had taken was dropped",
    # services
    "handler-raised": "a handler of a service or action raised something other than ServiceFailed",
    "malformed-request": "bytes that are no request of the service's type",
    "malformed-response": "bytes that are no response of the service's type",
    "replies-waiting-full": "as many replies as may wait already wait for their clients' readers",
    "reply-client-gone": "a reply was ready when its client had gone",
    "reply-history-full": "a reply was dropped: a client does not acknowledge earlier ones",
    "reply-reader-unmatched": "a reply was given up: its client's reader was not found in time",
    "reply-without-call": "a reply to a call that was answered or given up",
    "reply-without-identity": "a reply that does not say which call it is for",
    "requests-full": "the newest request was dropped: nobody spins",
    "service-header-truncated": "a request or reply of Cyclone's dialect without its whole header",
    # actions
    "goal-id-repeated": "a goal with the id of one that is known was refused",
    "goals-full": "a goal was refused: as many as are allowed have no result yet",
    "result-displaced": "the oldest result was forgotten to make room for a new goal",
    "result-requests-full": "the oldest of too many requests for one result was dropped",
    # all of them
    "too-many-callbacks": "callbacks other than those of topics were dropped: nobody spins",
}
