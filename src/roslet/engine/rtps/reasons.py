"""What each counted reason of the RTPS engine means: names in `Node.counters` of a node on ROS 2, and in
`Participant.counters`.

Nothing that comes is dropped without one of these being counted.
"""

REASONS = {
    # datagrams
    "not-rtps": "a datagram that does not begin as RTPS",
    "version-unsupported": "a message of another major version of the protocol",
    "message-truncated": "a datagram shorter than a message's header",
    "submessage-truncated": "a submessage that ends too early for what it must hold",
    "submessage-too-long": "a submessage that says it is longer than the datagram",
    "too-many-submessages": "more submessages than are read of one datagram",
    "number-set-base-invalid": "a set of sequence or fragment numbers that begins below 1",
    "number-set-too-large": "a set of more than 256 numbers",
    "number-set-truncated": "a set shorter than it says",
    "payload-truncated": "a payload without a whole encapsulation header",
    "payload-not-a-parameter-list": "a payload of discovery in an encapsulation that holds no parameter list",
    # parameter lists
    "parameter-list-unterminated": "a list without its end",
    "parameter-truncated": "a parameter that says it is longer than the list, or is too short for its value",
    "parameter-too-many-elements": "a parameter with more elements than are taken",
    "parameter-not-understood": "a parameter that must be understood and is not known",
    "too-many-parameters": "a list of more parameters than are read",
    "too-many-locators": "a peer lists more addresses than are taken",
    "locator-list-truncated": "a list of addresses shorter than it says",
    # discovery
    "participant-without-guid": "an announcement that does not say whose it is",
    "participant-of-another-prefix": "an announcement of a participant other than its sender",
    "participant-of-another-domain": "a participant of another domain, or with another domain tag",
    "participants-full": "a participant beyond the bound",
    "discovery-from-another-address": "discovery data in the name of a participant that lives elsewhere",
    "endpoint-without-guid": "an endpoint that does not say which it is",
    "endpoint-without-topic": "an endpoint without a topic",
    "endpoint-without-type": "an endpoint without a type",
    "endpoint-kind-unknown": "an endpoint that is neither reader nor writer",
    "endpoint-of-another-participant": "an endpoint announced by a participant that it does not belong to",
    "discovery-bytes-full": "an endpoint whose announcement is beyond what its participant, or all together, may take",
    "endpoints-full": "an endpoint beyond the bound of its participant",
    "endpoint-not-kept": "an endpoint of a peer that could match none of ours, on a machine that keeps no others",
    "participant-message-truncated": "a message about liveliness that ends too early",
    "participant-message-invalid": "a message about liveliness that is none",
    # readers
    "data-of-unmatched-writer": "a sample of a writer that no reader here is matched with",
    "submessage-of-unmatched-writer": "a HEARTBEAT, GAP or HEARTBEAT_FRAG of such a writer",
    "sample-repeated": "a sample, or a fragment, that was there already",
    "sample-expired": "a sample older than its lifespan",
    "sample-too-large": "a sample in fragments beyond the bound",
    "assemblies-full": "the oldest incomplete sample made room for a newer one",
    "assembly-bytes-full": "a sample in fragments for which there is no room",
    "fragment-of-another-size": "a fragment that does not fit the others of its sample",
    "held-samples-full": "a sample that came while too many wait for an earlier one",
    "held-bytes-full": "the same, by octets",
    "heartbeat-repeated": "a HEARTBEAT no newer than the last",
    "instances-full": "an instance of a keyed topic beyond the bound",
    "events-full": "a sample or event that the loop did not take in time",
    # writers
    "acknack-of-unknown-writer": "an ACKNACK to a writer that is not here",
    "acknack-of-unmatched-reader": "an ACKNACK of a reader that is not matched",
    "acknack-repeated": "an ACKNACK no newer than the last",
    "nack-frag-of-unknown-writer": "a NACK_FRAG to a writer that is not here",
    "nack-frag-of-unmatched-reader": "a NACK_FRAG of a reader that is not matched",
    "nack-frag-of-unwritten-sample": "a NACK_FRAG for a sample that was not written yet",
    "nack-frag-early": "a NACK_FRAG for fragments that are still under way",
    "nack-frag-repeated": "a NACK_FRAG no newer than the last",
    "write-to-unmatched-reader": "a sample for one reader, which is not matched",
}
