# Generated from the definitions of type_description_interfaces by roslet.gen.stubs. Do not edit.

import typing as _typing

from roslet.wire import message as _message

class Field(_message.Message):
    name: str
    type: FieldType
    default_value: str
    def __init__(
        self,
        name: str = ...,
        type: FieldType | None = ...,
        default_value: str = ...,
    ) -> None: ...

class FieldType(_message.Message):
    FIELD_TYPE_NOT_SET: _typing.ClassVar[int]
    FIELD_TYPE_NESTED_TYPE: _typing.ClassVar[int]
    FIELD_TYPE_INT8: _typing.ClassVar[int]
    FIELD_TYPE_UINT8: _typing.ClassVar[int]
    FIELD_TYPE_INT16: _typing.ClassVar[int]
    FIELD_TYPE_UINT16: _typing.ClassVar[int]
    FIELD_TYPE_INT32: _typing.ClassVar[int]
    FIELD_TYPE_UINT32: _typing.ClassVar[int]
    FIELD_TYPE_INT64: _typing.ClassVar[int]
    FIELD_TYPE_UINT64: _typing.ClassVar[int]
    FIELD_TYPE_FLOAT: _typing.ClassVar[int]
    FIELD_TYPE_DOUBLE: _typing.ClassVar[int]
    FIELD_TYPE_LONG_DOUBLE: _typing.ClassVar[int]
    FIELD_TYPE_CHAR: _typing.ClassVar[int]
    FIELD_TYPE_WCHAR: _typing.ClassVar[int]
    FIELD_TYPE_BOOLEAN: _typing.ClassVar[int]
    FIELD_TYPE_BYTE: _typing.ClassVar[int]
    FIELD_TYPE_STRING: _typing.ClassVar[int]
    FIELD_TYPE_WSTRING: _typing.ClassVar[int]
    FIELD_TYPE_FIXED_STRING: _typing.ClassVar[int]
    FIELD_TYPE_FIXED_WSTRING: _typing.ClassVar[int]
    FIELD_TYPE_BOUNDED_STRING: _typing.ClassVar[int]
    FIELD_TYPE_BOUNDED_WSTRING: _typing.ClassVar[int]
    FIELD_TYPE_NESTED_TYPE_ARRAY: _typing.ClassVar[int]
    FIELD_TYPE_INT8_ARRAY: _typing.ClassVar[int]
    FIELD_TYPE_UINT8_ARRAY: _typing.ClassVar[int]
    FIELD_TYPE_INT16_ARRAY: _typing.ClassVar[int]
    FIELD_TYPE_UINT16_ARRAY: _typing.ClassVar[int]
    FIELD_TYPE_INT32_ARRAY: _typing.ClassVar[int]
    FIELD_TYPE_UINT32_ARRAY: _typing.ClassVar[int]
    FIELD_TYPE_INT64_ARRAY: _typing.ClassVar[int]
    FIELD_TYPE_UINT64_ARRAY: _typing.ClassVar[int]
    FIELD_TYPE_FLOAT_ARRAY: _typing.ClassVar[int]
    FIELD_TYPE_DOUBLE_ARRAY: _typing.ClassVar[int]
    FIELD_TYPE_LONG_DOUBLE_ARRAY: _typing.ClassVar[int]
    FIELD_TYPE_CHAR_ARRAY: _typing.ClassVar[int]
    FIELD_TYPE_WCHAR_ARRAY: _typing.ClassVar[int]
    FIELD_TYPE_BOOLEAN_ARRAY: _typing.ClassVar[int]
    FIELD_TYPE_BYTE_ARRAY: _typing.ClassVar[int]
    FIELD_TYPE_STRING_ARRAY: _typing.ClassVar[int]
    FIELD_TYPE_WSTRING_ARRAY: _typing.ClassVar[int]
    FIELD_TYPE_FIXED_STRING_ARRAY: _typing.ClassVar[int]
    FIELD_TYPE_FIXED_WSTRING_ARRAY: _typing.ClassVar[int]
    FIELD_TYPE_BOUNDED_STRING_ARRAY: _typing.ClassVar[int]
    FIELD_TYPE_BOUNDED_WSTRING_ARRAY: _typing.ClassVar[int]
    FIELD_TYPE_NESTED_TYPE_BOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_INT8_BOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_UINT8_BOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_INT16_BOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_UINT16_BOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_INT32_BOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_UINT32_BOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_INT64_BOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_UINT64_BOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_FLOAT_BOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_DOUBLE_BOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_LONG_DOUBLE_BOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_CHAR_BOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_WCHAR_BOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_BOOLEAN_BOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_BYTE_BOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_STRING_BOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_WSTRING_BOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_FIXED_STRING_BOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_FIXED_WSTRING_BOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_BOUNDED_STRING_BOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_BOUNDED_WSTRING_BOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_NESTED_TYPE_UNBOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_INT8_UNBOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_UINT8_UNBOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_INT16_UNBOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_UINT16_UNBOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_INT32_UNBOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_UINT32_UNBOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_INT64_UNBOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_UINT64_UNBOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_FLOAT_UNBOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_DOUBLE_UNBOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_LONG_DOUBLE_UNBOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_CHAR_UNBOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_WCHAR_UNBOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_BOOLEAN_UNBOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_BYTE_UNBOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_STRING_UNBOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_WSTRING_UNBOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_FIXED_STRING_UNBOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_FIXED_WSTRING_UNBOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_BOUNDED_STRING_UNBOUNDED_SEQUENCE: _typing.ClassVar[int]
    FIELD_TYPE_BOUNDED_WSTRING_UNBOUNDED_SEQUENCE: _typing.ClassVar[int]
    type_id: int
    capacity: int
    string_capacity: int
    nested_type_name: str
    def __init__(
        self,
        type_id: int = ...,
        capacity: int = ...,
        string_capacity: int = ...,
        nested_type_name: str = ...,
    ) -> None: ...

class IndividualTypeDescription(_message.Message):
    type_name: str
    fields: list[Field]
    def __init__(
        self,
        type_name: str = ...,
        fields: list[Field] | None = ...,
    ) -> None: ...

class KeyValue(_message.Message):
    key: str
    value: str
    def __init__(
        self,
        key: str = ...,
        value: str = ...,
    ) -> None: ...

class TypeDescription(_message.Message):
    type_description: IndividualTypeDescription
    referenced_type_descriptions: list[IndividualTypeDescription]
    def __init__(
        self,
        type_description: IndividualTypeDescription | None = ...,
        referenced_type_descriptions: list[IndividualTypeDescription] | None = ...,
    ) -> None: ...

class TypeSource(_message.Message):
    type_name: str
    encoding: str
    raw_file_contents: str
    def __init__(
        self,
        type_name: str = ...,
        encoding: str = ...,
        raw_file_contents: str = ...,
    ) -> None: ...
