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

#: How a negative number begins, alone or in a list, a range or before a unit.
_NEGATIVE: Final = re.compile(r"-(?:[0-9.]|inf|nan)", re.IGNORECASE)
_SECTION: Final = re.compile(r"\n\n(Parameters|Examples)\n-+\n")
_ENTRY: Final = re.compile(r"(\w+(?:, \w+)*) : (.+)\n((?:    .+\n?)+)")


class Parser(argparse.ArgumentParser):
    """A parser whose errors are one line: what is allowed, or a suggestion of what was meant.

    The namespace that it returns has attributes for the options that are given, and no others.
    """

    def __init__(self, **options: Any) -> None:
        super().__init__(allow_abbrev=False, argument_default=argparse.SUPPRESS, **options)
        self._negative_number_matcher = _NEGATIVE  # argparse takes -1e-3 and -1,0 for options

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Parse, and refuse what is unknown."""
        found, unknown = super().parse_known_args(args, namespace)
        if unknown:
            known = [name for action in self._actions for name in action.option_strings]
            hint = suggestion(unknown[0].partition("=")[0], known)
            if not unknown[0].startswith("--") and (before := args[: args.index(unknown[0])]):
                hint = f", after {' '.join(before[-2:])}: quote a value with blanks, as '5 mm'"
            self.error(f"unrecognized arguments: {' '.join(unknown)}{hint}")
        return found, unknown

    def _match_argument(self, action: argparse.Action, pattern: str) -> int:
        """Match arguments, and say in an error about a missing value what the option takes."""
        try:
            return super()._match_argument(action, pattern)
        except argparse.ArgumentError as error:
            allowed = f"one of {', '.join(action.choices)}" if action.choices else action.help
            error.message += f": {allowed}"
            raise

    def _get_value(self, action: argparse.Action, text: str) -> Any:
        """Read a value, and keep the words of a ValueError, which argparse would drop."""
        try:
            return text if action.type is None else action.type(text)  # type: ignore[operator]
        except ValueError as error:
            where = "" if text in str(error) else f", in {text!r}"
            raise argparse.ArgumentError(action, f"{error}{where}") from error

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        """Suggest a choice for one that is unknown; argparse does so from Python 3.14 on."""
        if value == argparse.SUPPRESS:  # a positional argument is left out
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


def add_commands(
    parser: Parser, commands: Mapping[str, Callable[..., Any]], about: Mapping[str, str]
) -> None:
    """Add commands by name; the second word of a name is a subcommand of the first one.

    Parameters
    ----------
    parser : Parser
    commands : mapping of str to callable
    about : mapping of str to str
        Descriptions of the commands that have subcommands.
    """
    groups = {"": _subparsers(parser, "command")}
    for names, function in commands.items():
        group, _, command = names.rpartition(" ")
        if group not in groups:
            told = _lowered(about[group].removesuffix("."))
            added = groups[""].add_parser(group, help=told, description=about[group])
            groups[group] = _subparsers(added, "kind")
        documented = Documentation.of(function)
        examples = documented.examples
        added = groups[group].add_parser(
            command,
            usage=f"{PROGRAM} {names} [options]{examples}" if examples else None,
            help=_lowered(documented.summary),
            description=f"{documented.summary}. {documented.description}",
        )
        add_options(added, function, "request")
        known = {action.dest for action in added._actions if action.option_strings}
        # `scene_options` and `__main__` find the options of the command under `options`
        added.set_defaults(run=partial(_call, function), options=known)


def _subparsers(parser: Parser, dest: str) -> Any:
    """Return the object to which commands are added; without a command an error lists them."""
    parsers = parser.add_subparsers(dest=dest, metavar=dest)

    def refuse(_: Any) -> NoReturn:
        parser.error(f"give a {dest}: {', '.join(parsers.choices)}")

    parser.set_defaults(run=refuse)  # each command replaces it by its own `run`
    return parsers


def _call(function: Callable[..., Any], given: Mapping[str, Any]) -> Any:
    """Call a function with the options given.

    A parameter whose type is a class, as `SceneOptions`, gets an object made of several options.
    """
    values = {}
    for name, parameter in inspect.signature(function, eval_str=True).parameters.items():
        kind: Any = parameter.annotation
        if hasattr(kind, "add_options"):
            values[name] = kind(given)
        elif is_dataclass(kind):
            values[name] = _call(kind, given)  # type: ignore[arg-type]
        elif name in given:
            values[name] = given[name]
    return function(**values)


def add_options(parser: Parser, function: Callable[..., Any], title: str = "") -> Any:
    """Add the options of a function, and return their group.

    A parameter whose type is a class with a method `add_options` stands for the options that this
    adds; one whose type is another dataclass, for an option for each field.
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
        _add_option(group, parameter, *told.options[parameter.name])
    return group


def _lowered(sentence: str) -> str:
    """Return a sentence as it stands in a list."""
    return f"{sentence[:1].lower()}{sentence[1:]}"


def _add_option(group: Any, parameter: inspect.Parameter, metavar: str, told: str) -> None:
    """Add the option of a parameter that is keyword-only, else a positional argument."""
    kinds = (parameter.annotation, *get_args(parameter.annotation))
    [kind] = [one.__metadata__[0] for one in kinds if hasattr(one, "__metadata__")] or [Option()]
    required = parameter.default is parameter.empty
    keywords = {"metavar": metavar, **kind.keywords}
    if parameter.annotation is bool:
        keywords = {"action": "store_true"}
    elif isinstance(parameter.default, float | int | str):
        told += f" (default: {parameter.default})"
    if kind.names:
        told += f": {', '.join(kind.names)}"
    if parameter.kind is parameter.KEYWORD_ONLY:
        names = filter(None, (flag(parameter.name), kind.also))
        group.add_argument(*names, dest=parameter.name, required=required, help=told, **keywords)
    else:
        optional = {} if required else {"nargs": "?"}
        group.add_argument(parameter.name, help=told, **{**optional, **keywords})
