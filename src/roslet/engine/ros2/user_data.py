"""What ROS 2 writes into USER_DATA: `key=value;` pairs. A participant's says its enclave, an endpoint's its type's hash.

rmw_cyclonedds adds `clientid=` and `serviceid=`, which tell the reader and the writer that belong together.
"""

from roslet.wire.primitives import decode

# Octets that are looked at; real ones have some 150. An enclave is as long as a name.
MAX_USER_DATA = 1024


def value_of(data: bytes, key: str) -> "str | None":
    """The value of a key, or None where it is not there, or not in the first MAX_USER_DATA octets."""
    for pair in bytes(data[:MAX_USER_DATA]).split(b";"):
        name, found, value = pair.partition(b"=")
        if found and name == key.encode():
            try:
                return decode(value)
            except ValueError:
                return None
    return None


def pair(key: str, value: str) -> bytes:
    """`key=value;`."""
    return ("%s=%s;" % (key, value)).encode()
