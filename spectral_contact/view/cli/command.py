"""A command is a function: its parameters are the options, its docstring is their help."""

from __future__ import annotations

import argparse
import inspect
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, is_dataclass
from functools import partial
from typing import Any, Final, NoReturn, get_args

from spectral_contact.io.choices import suggestion
from spectral_contact.processes import PROGRAM
from spectral_contact.view.cli.options import Option, UsageError, flag

_SECTION: Final = re.compile(r"\n\n(Parameters|Examples)\n-+\n")
_ENTRY: Final = re.compile(r"(\w+(?:, \w+)*) : (.+)\n((?:    .+\n?)+)")


class Parser(argparse.ArgumentParser):
    """A parser whose complaint is one line, and suggests an option for one that is unknown."""

    def __init__(self, **options: Any) -> None:
        super().__init__(allow_abbrev=False, **options)

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Parse, and refuse what is unknown."""
        found, unknown = super().parse_known_args(args, namespace)
        if unknown:
            known = [name for action in self._actions for name in action.option_strings]
            meant = suggestion(unknown[0].partition("=")[0], known)
            self.error(f"unrecognized arguments: {' '.join(unknown)}{meant}")
        return found, unknown

    def _get_value(self, action: argparse.Action, text: str) -> Any:
        """Read a value, and keep the words of a ValueError, which argparse would drop."""
        try:
            return text if action.type is None else action.type(text)  # type: ignore[operator]
        except ValueError as error:
            raise argparse.ArgumentError(action, str(error)) from error

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        """Suggest a choice for one that is unknown; argparse does so from Python 3.14 on."""
        if value == []:  # of a positional argument that may be left out
            return
        try:
            super()._check_value(action, value)
        except argparse.ArgumentError as error:
            error.message += suggestion(value, action.choices or ())
            raise

    def error(self, message: str) -> NoReturn:
        """Raise a `UsageError`."""
        raise UsageError(f"{message} (see {self.prog} --help)")


@dataclass(frozen=True, slots=True)
class Documentation:
    """The docstring of a command.

    Attributes
    ----------
    summary, description : str
        Its first line without the full stop, and what follows up to the parameters.
    options : dict of str to (str, str)
        What stands for the value, and the help, by the name of the parameter.
    examples : str
        Command lines below a heading; empty if there are none.
    """

    summary: str
    description: str
    options: dict[str, tuple[str, str]]
    examples: str

    @classmethod
    def of(cls, function: Callable[..., Any]) -> Documentation:
        """Return that of a function."""
        text, *sections = _SECTION.split((inspect.getdoc(function) or "") + "\n")
        named = dict(zip(sections[::2], sections[1::2], strict=True))
        options = {
            name: (metavar, _lowered(" ".join(told.split()).removesuffix(".")))
            for listed, metavar, told in _ENTRY.findall(named.get("Parameters", "") + "\n")
            for name in listed.split(", ")
        }
        summary, _, rest = text.partition("\n\n")
        lines = "".join(f"\n  {line}" for line in named.get("Examples", "").splitlines())
        examples = f"\n\nexamples:{lines}" if lines else ""
        return cls(summary.strip().removesuffix("."), rest.strip(), options, examples)


def add_commands(parser: Parser, commands: Mapping[str, Any], dest: str = "command") -> None:
    """Add commands by name: functions, or pairs of words and the kinds of a command."""
    parsers = parser.add_subparsers(dest=dest, metavar=dest, required=True)
    for name, command in commands.items():
        if isinstance(command, tuple):
            about, kinds = command
            add_commands(parsers.add_parser(name, help=about, description=about), kinds, "kind")
            continue
        told = Documentation.of(command)
        one = parsers.add_parser(
            name,
            usage=f"{PROGRAM} {name} [options]{told.examples}" if told.examples else None,
            help=_lowered(told.summary),
            description=f"{told.summary}. {told.description}",
        )
        add_options(one, command, "request")
        one.set_defaults(run=partial(_call, command))


def _call(function: Callable[..., Any], arguments: argparse.Namespace) -> Any:
    """Call a function with its options, some of which may make one argument."""
    values = {}
    for name, parameter in inspect.signature(function, eval_str=True).parameters.items():
        kind = parameter.annotation
        if hasattr(kind, "of"):
            values[name] = kind.of(vars(arguments))
        elif is_dataclass(kind):
            values[name] = _call(kind, arguments)  # type: ignore[arg-type]
        else:
            values[name] = getattr(arguments, name)
    return function(**values)


def add_options(parser: Parser, function: Callable[..., Any], title: str = "") -> Any:
    """Add the options of a function, and return their group.

    A parameter whose kind is a dataclass has options of its own; `add_options` of it may add them.
    """
    told, own = Documentation.of(function), []
    for parameter in inspect.signature(function, eval_str=True).parameters.values():
        kind: Any = parameter.annotation
        if hasattr(kind, "add_options"):
            kind.add_options(parser)
        elif is_dataclass(kind):
            add_options(parser, kind)  # type: ignore[arg-type]
        else:
            own.append(parameter)
    about = () if title else (told.description,)
    group = parser.add_argument_group(title or _lowered(told.summary), *about)
    for parameter in own:
        _add_option(group, parameter, *told.options.get(parameter.name, (None, "")))
    return group


def _lowered(sentence: str) -> str:
    """Return a sentence as it stands in a list."""
    return f"{sentence[:1].lower()}{sentence[1:]}"


def _add_option(group: Any, parameter: inspect.Parameter, metavar: str | None, told: str) -> None:
    kinds = (parameter.annotation, *get_args(parameter.annotation))
    [kind] = [one.__metadata__[0] for one in kinds if hasattr(one, "__metadata__")] or [Option()]
    keywords = dict(kind.keywords)
    if parameter.annotation is bool:
        keywords["action"] = "store_true"
    elif "choices" not in keywords:
        keywords["metavar"] = metavar
    if parameter.default is not parameter.empty:
        keywords["default"] = parameter.default
        if isinstance(parameter.default, float | int | str) and parameter.annotation is not bool:
            told += " (default: %(default)s)"
    if parameter.kind is not parameter.KEYWORD_ONLY:
        optional = {"nargs": "?"} if "default" in keywords else {}
        group.add_argument(parameter.name, help=told, **{**optional, **keywords})
        return
    keywords["required"] = "default" not in keywords
    names = (flag(parameter.name), *kind.also)
    told += f": {', '.join(kind.names)}" if kind.names else ""
    group.add_argument(*names, dest=parameter.name, help=told, **keywords)
