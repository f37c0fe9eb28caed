"""What goes in and out: input is checked, files are written whole or not at all; internal.

Input: `checks` of numbers, `choices` of names, `kinds` of values, `units` and `physical` data.
Output: `documents`, `codecs`, `schema` and `storage` of solutions, as JSON and npz.
"""

__all__: list[str] = []
