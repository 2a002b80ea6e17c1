"""What the papers print, beside what this repository computes: a module for each page of docs/papers."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """A figure, table or statement of a paper, and ours. Texts; ``owes``: constants that ours hangs on."""

    figure: str
    what: str
    published: str
    ours: str
    difference: str
    owes: str


@dataclass(frozen=True)
class Table:
    """A heading, with a paragraph and a table of its own; rows after it stand under it."""

    title: str
    text: str = ""
    header: tuple = ()
    rows: tuple = ()
