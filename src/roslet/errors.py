"""Every exception that roslet raises on purpose.

    RosletError
    +-- DefinitionError        a .msg, .srv or .action text is wrong; says file, line and column
    |   +-- UnknownType        a type that no search path holds
    |   +-- RecursiveType      a type that contains itself; says the cycle
    +-- InvalidName            not a legal ROS name
    +-- InvalidMessage         a value that its field cannot hold; says the value path
    +-- MalformedMessage       bytes that are not a message of the type; says offset and path
    +-- ProtocolError          a peer broke its protocol; carries the named reason
    +-- RemoteError            a peer answered with an error
    |   +-- HandshakeRefused   a TCPROS connection header was refused
    |   +-- ServiceFailed      a service handler reported failure
    |   +-- Fault              an XML-RPC fault or an unsuccessful status
    +-- Unreachable            a peer or master could not be reached
    +-- CallTimeout            no answer within the time given
    +-- Unsupported            what this network lacks; says which network and why
    +-- NodeClosed             the node, or the object, has been closed
    +-- ParameterNotSet        no such parameter
    |   +-- ParameterNotDeclared     nobody declared it (ROS 2)
    |   +-- ParameterUninitialized   it was declared without a value (ROS 2)
    +-- ParameterAlreadyDeclared     a parameter is declared once (ROS 2)
    +-- ParameterReadOnly      it is neither undeclared nor described anew (ROS 2)
    +-- ParameterRefused       a value that does not suit its parameter; says why (ROS 2)

Runs on MicroPython. Local misuse raises at once; what a peer does wrong raises only where a caller waits for it,
otherwise it is counted under its named reason.
"""


class RosletError(Exception):
    """Base of every exception that roslet raises on purpose."""


class DefinitionError(RosletError):
    """An interface definition is wrong. `line` and `column` count from 1; 0 where there is none."""

    def __init__(self, message: str, file: str = "", line: int = 0, column: int = 0) -> None:
        where = file
        if line:
            where = "%s:%d:%d" % (file or "<text>", line, column)
        super().__init__("%s: %s" % (where, message) if where else message)
        self.message = message
        self.file = file
        self.line = line
        self.column = column


class UnknownType(DefinitionError):
    """No search path holds the definition of this type."""


class RecursiveType(DefinitionError):
    """A definition contains itself; the message names the cycle."""


class InvalidName(RosletError):
    """Not a legal ROS graph resource, package or type name."""


class InvalidMessage(RosletError):
    """A value that its field cannot hold. `path` is the value path, such as `poses[3].orientation.w`."""

    def __init__(self, message: str, path: str = "") -> None:
        super().__init__("%s: %s" % (path, message) if path else message)
        self.message = message
        self.path = path


class MalformedMessage(RosletError):
    """Bytes that are no message of the type. `offset` counts from the start of the message's bytes."""

    def __init__(self, message: str, offset: int = 0, path: str = "") -> None:
        where = "at byte %d" % offset
        if path:
            where = "%s (%s)" % (where, path)
        super().__init__("%s: %s" % (where, message))
        self.message = message
        self.offset = offset
        self.path = path


class ProtocolError(RosletError):
    """A peer broke its protocol. `reason` is the short name under which the fault is counted."""

    def __init__(self, reason: str, message: str = "") -> None:
        super().__init__("%s: %s" % (reason, message) if message else reason)
        self.reason = reason
        self.message = message


class RemoteError(RosletError):
    """A peer answered with an error."""


class HandshakeRefused(RemoteError):
    """A peer refused a TCPROS connection header, or we refused its."""


class ServiceFailed(RemoteError):
    """A service handler reported failure; the text is the server's."""


class Fault(RemoteError):
    """An XML-RPC fault, or a ROS API reply whose status code is not success."""

    def __init__(self, code: int, message: str) -> None:
        super().__init__("%s (code %d)" % (message, code))
        self.code = code
        self.message = message


class Unreachable(RosletError):
    """A peer or a master could not be reached."""


class CallTimeout(RosletError):
    """No answer within the time given."""


class Unsupported(RosletError):
    """What this network cannot do; the message says which network and why."""


class NodeClosed(RosletError):
    """The node, or the object, has been closed."""


class ParameterNotSet(RosletError):
    """No such parameter."""


class ParameterNotDeclared(ParameterNotSet):
    """Nobody declared a parameter of this name."""


class ParameterUninitialized(ParameterNotSet):
    """The parameter was declared with a type, and has no value yet."""


class ParameterAlreadyDeclared(RosletError):
    """A parameter of this name exists."""


class ParameterReadOnly(RosletError):
    """A read-only parameter is not undeclared, nor described anew."""


class ParameterRefused(RosletError):
    """The value does not suit the parameter; `reason` says why, `wrong_type` whether that is its type."""

    def __init__(self, name: str, reason: str, wrong_type: bool = False) -> None:
        super().__init__("%s: %s" % (name, reason))
        self.name = name
        self.reason = reason
        self.wrong_type = wrong_type
