# Generated from the definitions of lifecycle_msgs by roslet.gen.stubs. Do not edit.

import typing as _typing

from roslet.wire import message as _message

class State(_message.Message):
    PRIMARY_STATE_UNKNOWN: _typing.ClassVar[int]
    PRIMARY_STATE_UNCONFIGURED: _typing.ClassVar[int]
    PRIMARY_STATE_INACTIVE: _typing.ClassVar[int]
    PRIMARY_STATE_ACTIVE: _typing.ClassVar[int]
    PRIMARY_STATE_FINALIZED: _typing.ClassVar[int]
    TRANSITION_STATE_CONFIGURING: _typing.ClassVar[int]
    TRANSITION_STATE_CLEANINGUP: _typing.ClassVar[int]
    TRANSITION_STATE_SHUTTINGDOWN: _typing.ClassVar[int]
    TRANSITION_STATE_ACTIVATING: _typing.ClassVar[int]
    TRANSITION_STATE_DEACTIVATING: _typing.ClassVar[int]
    TRANSITION_STATE_ERRORPROCESSING: _typing.ClassVar[int]
    id: int
    label: str
    def __init__(
        self,
        id: int = ...,
        label: str = ...,
    ) -> None: ...

class Transition(_message.Message):
    TRANSITION_CREATE: _typing.ClassVar[int]
    TRANSITION_CONFIGURE: _typing.ClassVar[int]
    TRANSITION_CLEANUP: _typing.ClassVar[int]
    TRANSITION_ACTIVATE: _typing.ClassVar[int]
    TRANSITION_DEACTIVATE: _typing.ClassVar[int]
    TRANSITION_UNCONFIGURED_SHUTDOWN: _typing.ClassVar[int]
    TRANSITION_INACTIVE_SHUTDOWN: _typing.ClassVar[int]
    TRANSITION_ACTIVE_SHUTDOWN: _typing.ClassVar[int]
    TRANSITION_DESTROY: _typing.ClassVar[int]
    TRANSITION_ON_CONFIGURE_SUCCESS: _typing.ClassVar[int]
    TRANSITION_ON_CONFIGURE_FAILURE: _typing.ClassVar[int]
    TRANSITION_ON_CONFIGURE_ERROR: _typing.ClassVar[int]
    TRANSITION_ON_CLEANUP_SUCCESS: _typing.ClassVar[int]
    TRANSITION_ON_CLEANUP_FAILURE: _typing.ClassVar[int]
    TRANSITION_ON_CLEANUP_ERROR: _typing.ClassVar[int]
    TRANSITION_ON_ACTIVATE_SUCCESS: _typing.ClassVar[int]
    TRANSITION_ON_ACTIVATE_FAILURE: _typing.ClassVar[int]
    TRANSITION_ON_ACTIVATE_ERROR: _typing.ClassVar[int]
    TRANSITION_ON_DEACTIVATE_SUCCESS: _typing.ClassVar[int]
    TRANSITION_ON_DEACTIVATE_FAILURE: _typing.ClassVar[int]
    TRANSITION_ON_DEACTIVATE_ERROR: _typing.ClassVar[int]
    TRANSITION_ON_SHUTDOWN_SUCCESS: _typing.ClassVar[int]
    TRANSITION_ON_SHUTDOWN_FAILURE: _typing.ClassVar[int]
    TRANSITION_ON_SHUTDOWN_ERROR: _typing.ClassVar[int]
    TRANSITION_ON_ERROR_SUCCESS: _typing.ClassVar[int]
    TRANSITION_ON_ERROR_FAILURE: _typing.ClassVar[int]
    TRANSITION_ON_ERROR_ERROR: _typing.ClassVar[int]
    TRANSITION_CALLBACK_SUCCESS: _typing.ClassVar[int]
    TRANSITION_CALLBACK_FAILURE: _typing.ClassVar[int]
    TRANSITION_CALLBACK_ERROR: _typing.ClassVar[int]
    id: int
    label: str
    def __init__(
        self,
        id: int = ...,
        label: str = ...,
    ) -> None: ...

class TransitionDescription(_message.Message):
    transition: Transition
    start_state: State
    goal_state: State
    def __init__(
        self,
        transition: Transition | None = ...,
        start_state: State | None = ...,
        goal_state: State | None = ...,
    ) -> None: ...

class TransitionEvent(_message.Message):
    timestamp: int
    transition: Transition
    start_state: State
    goal_state: State
    def __init__(
        self,
        timestamp: int = ...,
        transition: Transition | None = ...,
        start_state: State | None = ...,
        goal_state: State | None = ...,
    ) -> None: ...
