"""The errors of the package.

The tree, with the built-in that each class also is::

    SpectralContactError (Exception)
      |
      +-- SceneError (ValueError)               an input is outside its allowed range
      |
      +-- NotComputedError                      a quantity was asked for that the plan left out
      |
      +-- ConvergenceError                      the tolerance was not met; carries the best solution
      |
      +-- SolutionFileError (ValueError)        a file or text is unreadable, foreign or too new
      |
      +-- MissingDependencyError (ImportError)  an optional package is not installed

All of them keep their attributes when pickled, so that they cross process boundaries whole.
"""

import pickle
from importlib import import_module
from typing import Any

import numpy as np

__all__ = [
    "ConvergenceError",
    "MissingDependencyError",
    "NotComputedError",
    "SceneError",
    "SolutionFileError",
    "SpectralContactError",
    "optional",
    "shown",
]

# A message is one line on a terminal: long values (arrays) are cut to this many characters.
_SHOWN_CHARACTERS = 80


class SpectralContactError(Exception):
    """Base class of every error the package raises on purpose."""

    def _rebuilt_from(self, *arguments: object) -> tuple[Any, ...]:
        """Return what ``__reduce__`` needs: the constructor's arguments, and notes and the rest."""
        return type(self), arguments, dict(self.__dict__)


class SceneError(SpectralContactError, ValueError):
    """An input is not one that the theory or the library allows.

    Parameters
    ----------
    parameter : str
        Name of the offending parameter; several are separated by ``", "``.
    value : object
        The value given. In a pickle, a value that cannot be pickled is replaced by its text in
        the message.
    allowed : str
        The values allowed, worded to follow "must be".

    Examples
    --------
    >>> print(SceneError("poisson_ratio", 0.7, "in (-1, 0.5]"))
    poisson_ratio = 0.7: must be in (-1, 0.5]
    """

    def __init__(self, parameter: str, value: object, allowed: str) -> None:
        self.parameter = parameter
        self.value = value
        self.allowed = allowed
        super().__init__(f"{parameter} = {shown(value)}: must be {allowed}")

    def __reduce__(self) -> tuple[Any, ...]:
        value = self.value if _can_be_pickled(self.value) else shown(self.value)
        # args go with the state: the message is about the value given, not about its stand-in.
        state = {**self.__dict__, "value": value, "args": self.args}
        return type(self), (self.parameter, value, self.allowed), state


class NotComputedError(SpectralContactError):
    """A quantity was asked of a solution whose plan left it out.

    Parameters
    ----------
    quantity : str
        Name of the quantity, as the user wrote it.
    reason : str
        The plan's reason for leaving it out.
    """

    def __init__(self, quantity: str, reason: str) -> None:
        self.quantity = quantity
        self.reason = reason
        super().__init__(f"{quantity} not computed: {reason}")

    def __reduce__(self) -> tuple[Any, ...]:
        return self._rebuilt_from(self.quantity, self.reason)


class ConvergenceError(SpectralContactError):
    """The requested tolerance was not met.

    Parameters
    ----------
    cause : str
        The reason why refinement stopped.
    remedy : str
        Advice for the user.
    solution : object, optional
        The best solution reached, with its error estimates (``converged`` is False).
    """

    def __init__(self, cause: str, remedy: str, solution: Any = None) -> None:
        self.cause = cause
        self.remedy = remedy
        self.solution = solution
        super().__init__(f"{cause}; {remedy}")

    def __reduce__(self) -> tuple[Any, ...]:
        return self._rebuilt_from(self.cause, self.remedy, self.solution)


class SolutionFileError(SpectralContactError, ValueError):
    """A file or text is unreadable, not one of this library, or of a newer version.

    Parameters
    ----------
    source : str
        The path of the file, or the kind of text.
    reason : str
        The problem.
    """

    def __init__(self, source: str, reason: str) -> None:
        self.source = source
        self.reason = reason
        # A path, or a key of the file, may have line breaks.
        super().__init__(" ".join(f"{source}: {reason}".split()))

    def __reduce__(self) -> tuple[Any, ...]:
        return self._rebuilt_from(self.source, self.reason)


class MissingDependencyError(SpectralContactError, ImportError):
    """An optional dependency is needed and not installed.

    Parameters
    ----------
    module : str
        The module that could not be imported; also in ``name``, as in every `ImportError`.
    extra : str
        The extra of this package that installs it.
    """

    def __init__(self, module: str, extra: str) -> None:
        self.module = module
        self.extra = extra
        # No index has this package: its extras are installed from a clone.
        super().__init__(
            f'{module} is not installed: run  pip install ".[{extra}]"  '
            "in your clone of spectral_contact",
            name=module,
        )

    def __reduce__(self) -> tuple[Any, ...]:
        return self._rebuilt_from(self.module, self.extra)


def optional(module: str, extra: str) -> Any:
    """Return a package that an extra installs.

    Raises
    ------
    MissingDependencyError
        If it cannot be imported.
    """
    try:
        return import_module(module)
    except ImportError as error:
        raise MissingDependencyError(module, extra) from error


def shown(value: object) -> str:
    """Return the value on one line, short, whatever it is."""
    try:
        # Plain numbers: "0.7", not "np.float64(0.7)".
        text = str(value) if isinstance(value, np.number) else repr(value)
    except Exception:  # an int beyond the interpreter's digit limit, or a broken __repr__
        return f"<{type(value).__name__}>"
    text = " ".join(text.split())
    return text if len(text) <= _SHOWN_CHARACTERS else text[: _SHOWN_CHARACTERS - 3] + "..."


def _can_be_pickled(value: object) -> bool:
    try:
        pickle.dumps(value)
    except Exception:  # pickle raises whatever the object's own hooks raise
        return False
    return True
