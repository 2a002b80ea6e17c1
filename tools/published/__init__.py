"""What computes the pages of results, among them the papers' (papers.py)."""


def markdown(header, rows):
    """A table of Markdown."""
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join(f"| {' | '.join(map(str, line))} |" for line in lines)


def section(title, text="", header=(), rows=()):
    """A heading with its own paragraph and table."""
    table = [markdown(header, rows)] if rows else []
    return "\n\n".join([f"## {title}", *filter(None, [text.strip()]), *table])


def rows_of(text):
    """Rows of cells, which `|` separates; a blank line separates rows."""
    return [tuple(" ".join(cell.split()) for cell in row.split("|")) for row in text.strip().split("\n\n")]
