"""The errors of a board: :class:`BoardError` is the base of all."""


class BoardError(Exception):
    """A board did not do what it was asked to; the sentence has the reason."""


class ConnectError(BoardError):
    """There is no board at this port: no such port, another program has it, or nothing answers as a board."""


class VersionError(ConnectError):
    """The board speaks another version of the protocol."""


class LinkLostError(BoardError):
    """The connection is closed, the cable is lost, the board was started again, or it stopped answering."""


class RefusedError(BoardError):
    """The board refused a request, and nothing has changed; the sentence has the values and the bounds."""


class ParameterError(BoardError, KeyError):
    """An argument or a parameter that does not exist, or a value that it cannot have."""

    # A KeyError shows its argument, not a sentence.
    __str__ = Exception.__str__


class StreamError(BoardError):
    """A stream of torques that did not begin or was ended, because of its rate or a torque; or that still runs."""
