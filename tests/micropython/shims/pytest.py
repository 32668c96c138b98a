"""A stand-in, for MicroPython, for the parts of pytest that core tests use.

`raises`, `approx`, `fail`, `param`, `mark.parametrize` and marks without effect.
"""

import re


class _Test:
    """A decorated test: the function, its parameter sets and its marks."""

    def __init__(self, function):
        self.function = function
        self.parameters = []
        self.marks = []

    def __call__(self, *arguments, **named):
        return self.function(*arguments, **named)


def _wrap(function):
    return function if isinstance(function, _Test) else _Test(function)


class _Mark:
    def __init__(self, name):
        self.name = name

    def __call__(self, *arguments, **named):
        if len(arguments) == 1 and not named and (callable(arguments[0]) or isinstance(arguments[0], _Test)):
            test = _wrap(arguments[0])
            test.marks.append(self.name)
            return test
        return self


class _Parametrize:
    def __init__(self, names, values):
        self.names = names
        self.values = values

    def __call__(self, function):
        test = _wrap(function)
        test.parameters.append((self.names, self.values))
        return test


class _Marks:
    def parametrize(self, names, values, ids=None):
        if isinstance(names, str):
            names = [name.strip() for name in names.split(",")]
        return _Parametrize(names, list(values))

    def __getattr__(self, name):
        return _Mark(name)


mark = _Marks()


class _Param:
    def __init__(self, values):
        self.values = values


def param(*values, id=None, marks=None):
    return _Param(values)


class _Raised:
    value = None


class raises:
    """`with raises(Type, match=pattern) as raised:`; raised.value is the exception."""

    def __init__(self, expected, match=None):
        self.expected = expected
        self.match = match
        self.raised = _Raised()

    def __enter__(self):
        return self.raised

    def __exit__(self, kind, error, trace):
        if kind is None:
            raise AssertionError("did not raise " + repr(self.expected))
        if not isinstance(error, self.expected):
            return False
        self.raised.value = error
        if self.match is not None and re.search(self.match, str(error)) is None:
            raise AssertionError(repr(str(error)) + " does not match " + repr(self.match))
        return True


class approx:
    """Equal within a relative 1e-6, or 1e-12 absolute."""

    def __init__(self, expected, rel=1e-6, abs=1e-12):
        self.expected = expected
        self.rel = rel
        self.absolute = abs

    def __eq__(self, other):
        difference = other - self.expected
        if difference < 0:
            difference = -difference
        size = self.expected if self.expected >= 0 else -self.expected
        return difference <= max(self.absolute, self.rel * size)


def fail(text=""):
    raise AssertionError(text)


def is_marked(function, name):
    return isinstance(function, _Test) and name in function.marks


def plain(function):
    return function.function if isinstance(function, _Test) else function


def cases(function):
    """Every combination of the parameter sets, as keyword arguments."""
    combined = [{}]
    if isinstance(function, _Test):
        for names, values in function.parameters:
            grown = []
            for base in combined:
                for value in values:
                    if isinstance(value, _Param):
                        value = value.values if len(names) > 1 else value.values[0]
                    merged = dict(base)
                    if len(names) == 1:
                        merged[names[0]] = value
                    else:
                        for name, part in zip(names, value):
                            merged[name] = part
                    grown.append(merged)
            combined = grown
    return combined
