"""The papers' figures and tables beside those of this repository: a module per page of docs/papers."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """A figure, table or statement of a paper, and ours, as text."""

    figure: str
    what: str
    published: str
    ours: str
    difference: str


@dataclass(frozen=True)
class Table:
    """A heading with its own paragraph and table; rows that follow appear below it."""

    title: str
    text: str = ""
    header: tuple = ()
    rows: tuple = ()
