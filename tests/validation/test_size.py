"""What ../validation/size.py counts: no line is a saving, and no comment costs anything."""

import ast
import sys
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).parents[2] / "validation"))

import size


def module(text, name="spectral_contact.contact.example"):
    return size.Module(name, text, ast.parse(text))


def test_comments_docstrings_and_blank_lines_cost_no_token():
    dense = module("def norm(x):\n    return abs(x)\n")
    prose = module(
        '"""A module."""\n\n\n# why\ndef norm(x):\n    """Return it.\n\n    In lines.\n    """\n\n'
        "    # what for\n    return abs(\n        x\n    )\n"
    )
    assert size.token_count(dense) == size.token_count(prose) == 11
    assert size.code_line_count(dense) == 2
    assert size.code_line_count(prose) == 4


def test_a_string_that_is_no_docstring_costs_one_token():
    assert size.token_count(module('"""A module."""\nTEXT = """two\nlines"""\n')) == 3


@pytest.mark.parametrize("text", ["''", "f'{a}'", "f'{a + b!r:>{c}} and {f\"{d}\"}'"])
def test_an_f_string_is_one_token_on_every_version_of_python(text):
    assert size.token_count(module(f"TEXT = {text}\n")) == 3


def test_long_names_cost_as_much_as_short_ones():
    short = module("r = a * b\n")
    long = module("boundary_residual = jacobian * boundary_change\n")
    assert size.token_count(short) == size.token_count(long)


@pytest.mark.parametrize(
    ("text", "named", "tuned"),
    [
        ("LIMIT = 4\nHALF = -0.5\n", 2, 0),
        ("LIMIT = 40\n", 1, 1),
        ("_FEW, _MANY = 2, 8\n", 2, 1),
        ("NAMES = ('a', 'b')\n", 0, 0),
        ("limit: float = 2.5\n", 0, 1),
        # no literal, but the product of two tuned numbers is a third
        ("SMALL, PROBE = 1e-3, 1e-2\nNEAR = SMALL * PROBE\n", 3, 3),
        ("#: The exponent of docs/theory, section 4.\nEXPONENT = 2.5\n", 1, 0),
        ("#: Of (Spence, 1975).\nEXPONENT = 2.5\n", 1, 0),
        ("#: Measured on 1974 scenes.\nEXPONENT = 2.5\n", 1, 1),
        ('"""See docs/theory."""\nEXPONENT = 2.5\n', 1, 1),
    ],
)
def test_constants_at_the_top_of_a_module(text, named, tuned):
    assert size.named_constants(module(text)) == named
    assert size.tuned_constants(module(text)) == tuned


def test_every_name_of_a_tuning_table_is_tuned():
    text = "LIMIT = 2.0\nBOTH = ROW * LIMIT\nROW = Row(first=0.4, second=0.6, third=7)\n"
    table = module(text, "spectral_contact.contact.tuning")
    assert size.tuned_constants(table) == 1 + 1 + 3
    assert size.tuned_constants(module(text)) == 0 + 1 + 3


@pytest.mark.parametrize(
    ("documents", "count"),
    [
        (("", "", ""), 2),
        (("", "", "By Eq. (3)."), 1),
        (("", "Of (1975).", ""), 0),
        (("docs/theory, section 3.", "", ""), 0),
    ],
)
def test_numbers_in_functions_need_a_formula(documents, count):
    head, outer, inner = (f'"""{text}"""' for text in documents)
    text = (
        f"{head}\ndef outer(x):\n    {outer}\n    def inner(y):\n        {inner}\n"
        "        return 0.25 * y\n    return 7 * inner(x) / 2.0\n"
    )
    assert size.tuned_literals(module(text)) == count


def test_packed_assignments_have_tuples_on_both_sides():
    text = "a, b = 1, 2\n(c, d) = e, f = 3, 4\ng, h = divmod(7, 2)\npair = 5, 6\n"
    assert size.packed_assignments(module(text)) == 2


def test_private_words_are_words_of_identifiers():
    text = (
        "from library.driven import Driven as System\n"
        "def tone(own_slip, *, known):\n"
        "    phone = shown.seen(share=known)\n"
        "    SeenNodes = _NOT_FOUND\n"
        "    return 'one own', one_error\n"
    )
    assert size.private_uses(module(text)) == {
        "driven": 2,
        "System": 1,
        "own": 1,
        "seen": 2,
        "share": 1,
        "found": 1,
        "one": 1,
    }


def test_the_list_of_private_words_can_match():
    lists = size.private_words()
    assert set(lists) == {"parts", "names"}
    # the words of an identifier are compared in small letters, of letters alone
    assert all(size.words_of(word) == [word] for word in lists["parts"])
    assert not {"known", "unknown"} & {name.lower() for names in lists.values() for name in names}
    assert not any(set(size.words_of(name)) & set(lists["parts"]) for name in lists["names"])


def test_new_modules_of_contact_and_spectral_are_of_the_flat_core(monkeypatch):
    names = ["contact", "contact.new", "contact.layered", "spectral.deep.new", "solving.new"]
    made = {f"spectral_contact.{name}": module("", f"spectral_contact.{name}") for name in names}
    monkeypatch.setattr(size, "modules", lambda: made)
    monkeypatch.setattr(size, "files", lambda: made)
    monkeypatch.setattr(size, "packages", lambda: {"spectral_contact.contact"})
    core = [one.short_name for one in size.flat_core()]
    assert core == ["contact", "contact.new", "spectral.deep.new"]
    assert "spectral.cells" in size.stale_exclusions()
    assert "contact.layered" not in size.stale_exclusions()


@pytest.mark.parametrize(("value", "code"), [(5, 0), (4, 0), (6, 1)])
def test_it_fails_above_a_gate_alone(monkeypatch, capsys, value, code):
    held, reported = size.Gate("held", 7, 5, 3), size.Gate("reported", 1, None, 1)
    monkeypatch.setattr(size, "GATES", (held, reported))
    monkeypatch.setattr(size, "figures", lambda: {"held": (value, "why"), "reported": (99, "")})
    assert size.main() == code
    printed = capsys.readouterr()
    assert f"| held | 7 | {value} | 5 | 3 | why |" in printed.out
    assert "| reported | 1 | 99 | reported | 1 |  |" in printed.out
    assert ("held: 6, the gate is 5" in printed.err) is bool(code)


def test_nothing_that_is_no_module_is_left_out_of_the_core():
    assert size.stale_exclusions() == []
