"""What each counted reason means: the names in `Node.counters`.

Nothing is refused, dropped or given up without one of these being counted. What is wrong with an XML-RPC request is counted
under the reasons that `wire.http`, `wire.xmlrpc` and `engine.ros1.rpc` list.
"""

REASONS = {
    # connections that come in
    "bad-callerid": "a connection header's callerid is too long or holds control characters",
    "closed-before-header": "a connection ended before its header was whole",
    "connection-evicted": "a connection that had said nothing was closed to make room for a new one",
    "handshake-timeout": "a peer did not send its connection header in time",
    "header-field-missing": "a connection header lacks a field that it must have",
    "header-field-without-equals": "a field of a connection header is not name=value",
    "header-not-utf-8": "a field of a connection header is not text",
    "header-too-large": "a connection header is announced longer than any is",
    "header-too-many-fields": "a connection header has more fields than exist",
    "header-truncated": "a field of a connection header is longer than the header",
    "md5sum-mismatch": "two nodes have different definitions of one type",
    "no-descriptors": "the process could not take a connection: it has too many files open",
    "too-many-connections": "a connection was closed at once: as many as are allowed stand",
    "type-mismatch": "two nodes use one topic with different types",
    "unknown-service": "a client asked for a service that this node does not offer",
    "unknown-topic": "a subscriber asked for a topic that this node does not publish",
    # publishing
    "blocked-too-long": "keep_all: a message was dropped for a subscriber that took nothing for too long",
    "data-from-subscriber": "a subscriber sent data where only the publisher speaks",
    "queued-at-close": "messages waited for slow subscribers when the node was closed",
    "queued-for-lost-subscriber": "messages waited for a subscriber whose connection ended",
    "send-queue-full": "the oldest message that waited for a slow subscriber was dropped",
    # subscribing
    "bad-publisher-uri": "the master, or a publisher, named an address that is none",
    "frame-too-large": "a message is longer than the subscription, or the service, allows",
    "frame-truncated": "a connection ended within a message",
    "malformed-message": "bytes that are no message of the topic's type",
    "no-common-transport": "publisher and subscriber speak no common transport",
    "publisher-lost": "the connection to a publisher ended",
    "receive-queue-full": "the oldest message that nobody had taken was dropped",
    "refused-by-peer": "a publisher or a service refused our connection header",
    "too-many-publishers": "publishers of a topic beyond the bound were ignored",
    "update-of-unknown-topic": "the master told of publishers of a topic that is not subscribed",
    # services
    "handler-raised": "a service's handler raised something other than ServiceFailed",
    "malformed-request": "bytes that are no request of the service's type",
    "malformed-response": "bytes that are no response of the service's type",
    "reply-without-call": "a service answered what was not asked",
    "request-after-the-last": "a client sent more requests on a connection for one",
    # master and slave API
    "name-taken": "another node has this node's name",
    "parameter-not-subscribed": "a change of a parameter was told that nobody watches",
    "registration-refused": "the master refused to register a topic or a service",
    "request-truncated": "a client of the slave API ended within its request",
    "too-many-callbacks": "callbacks of connections or parameters were dropped: nobody spins",
    "unread-answers": "a client of the slave API did not read its answers",
    # UDPROS
    "udp-answer": "a publisher's answer about UDPROS has not the shape it must have",
    "udp-block-beyond-count": "a block's number is beyond its message's count",
    "udp-duplicate-block": "a block came twice",
    "udp-foreign-source": "a datagram came from somebody else than the publisher",
    "udp-ignored-operation": "a PING or ERR, which nobody answers",
    "udp-incomplete": "blocks of a message were lost",
    "udp-length-mismatch": "a message is not as long as it says",
    "udp-message-too-large": "a message has more blocks than can be counted",
    "udp-no-blocks": "a message of no blocks",
    "udp-no-port": "no port for datagrams could be had",
    "udp-not-sent": "the kernel did not take a datagram",
    "udp-parameters": "a subscriber asked for UDPROS with parameters that make no sense",
    "udp-subscriber-gone": "a UDPROS subscriber no longer subscribes",
    "udp-too-many-subscribers": "UDPROS subscribers beyond the bound were refused",
    "udp-too-short": "a datagram without a whole head",
    "udp-unknown-connection": "a datagram for a connection that does not exist",
    "udp-unknown-operation": "a datagram with an operation that does not exist",
}
