"""The report of a sweep: verdict, picture and front of each axis, each listed point with its command."""

from meissner import interval
from meissner.files import written
from meissner.report.page import write_html
from meissner.report.words import number
from meissner.tradeoff import draw
from meissner.tradeoff.points import command_of
from meissner.tradeoff.sweep import figure_of

ROWS = 40  # at most, of a table


def shown(value):
    """A figure as the text of a cell: a rate with its interval, a number to four digits."""
    if isinstance(value, dict):
        between = interval.ends(value["low"], value["high"])
        return f"{value['count']} of {value['runs']} ({between} %)"
    if value is None or isinstance(value, (bool, str)):
        return value
    return number(value)


def listed(axis, rows):
    """(rows of the table, their number without the limit ROWS): the front, ordered, and the shipped point."""
    chosen = [row for row in rows if row["front"] or row["shipped"]] if axis.judged else rows
    if axis.judged:
        order = [*axis.judged[1:2], *axis.judged[:1]]
        chosen.sort(key=lambda row: [_last(figure_of(row, key)) for key in order])
    keep = [row for row in chosen if row["shipped"]]
    rest = [row for row in chosen if not row["shipped"]]
    kept = rest[: max(0, ROWS - len(keep))]
    return [row for row in chosen if any(row is one for one in (*keep, *kept))], len(chosen)


def _last(value):
    return (value is None, value or 0)


def table(axis, rows, command=True):
    """The rows of ``listed`` as dicts of words, without columns that are equal in all rows."""
    found, _ = listed(axis, rows)
    usual = {key for key in axis.runs} | {key for key in axis.values}
    measured = [
        figure for figure in axis.figures if any(figure_of(row, figure.key) is not None for row in rows)
    ]
    placed = [key for key in ("lut", "mhz") if any(row["cost"].get(key) is not None for row in rows)]
    cells = []
    for row in found:
        cell = {key.replace("_", " "): str(row["point"][key]) for key in row["point"] if key in usual}
        cell["ships"] = "yes" if row["shipped"] else ""
        if axis.judged:
            cell["on the front"] = "yes" if row["front"] else "no"
        cell |= {draw.label(figure): shown(figure_of(row, figure.key)) for figure in measured}
        cell |= {{"lut": "LUT", "mhz": "Fmax (MHz)"}[key]: shown(row["cost"].get(key)) for key in placed}
        if command:
            cell["again"] = command_of(axis, row["point"])
        cells.append(cell)
    if len(cells) == 1:
        return cells
    differ = [key for key in cells[0] if len({str(cell[key]) for cell in cells}) > 1]
    return [{key: cell[key] for key in differ} for cell in cells]


def survivors(axis, rows):
    """Yield (conclusion, number of changes it survives, number of changes, those it does not survive)."""
    changed = [row for row in rows if not row["shipped"]]
    first = next(iter(axis.values))
    for key in axis.conclusions:
        fell = [str(row["point"][first]) for row in changed if not figure_of(row, key)]
        yield axis.figure(key).label, len(changed) - len(fell), len(changed), fell


def verdict(axis, rows):
    """A sentence about the shipped point and the front, or about the conclusions."""
    if axis.conclusions:
        parts = [
            f"{text}: with {held} of {of} changes" + (f", not with {', '.join(fell)}" if fell else "")
            for text, held, of, fell in survivors(axis, rows)
        ]
        return "; ".join(parts)
    front = sum(row["front"] for row in rows)
    text = f"{len(rows)} points, {front} on the front"
    shipped = [row for row in rows if row["shipped"]]
    if shipped:
        text += "; the shipped one is on it" if shipped[0]["front"] else "; the shipped one is not"
        better = beaten_by(axis, rows, shipped[0])
        if better:
            some = "1 point dominates it" if len(better) == 1 else f"{len(better)} points dominate it"
            text += f": {some}, for example {command_of(axis, better[0]['point'])}"
    return text


def beaten_by(axis, rows, row):
    """The points of the front that dominate ``row``."""
    from meissner.tradeoff.pareto import dominates

    own = [figure_of(row, key) for key in axis.judged]
    found = []
    for other in rows:
        theirs = [figure_of(other, key) for key in axis.judged]
        same = axis.kind(other["point"]) == axis.kind(row["point"])
        if same and other["front"] and None not in own and dominates(theirs, own):
            found.append(other)
    return found


def write(out, axes, rows, facts):
    """Write a picture of each axis and report.html into ``out``; returns the names of the files."""
    pictures, tables, names = [], {}, []
    for axis in axes:
        if not rows[axis.name]:
            continue
        path = out / f"{axis.name}.png"
        with written(path) as file:
            draw.draw(file, axis, rows[axis.name])
        names.append(path.name)
        pictures.append((path, axis.title, verdict(axis, rows[axis.name])))
        found, count = listed(axis, rows[axis.name])
        more = f", {len(found)} of {count} rows" if len(found) < count else ""
        kind = "the front and the shipped point" if axis.judged else "every point"
        tables[f"{axis.title} ({kind}{more})"] = table(axis, rows[axis.name])
    count = sum(map(len, rows.values()))
    kinds = f"{len(rows)} ax{'es' if len(rows) > 1 else 'is'}"
    text = f"{count} points on {kinds}, measured; grey: dominated in all judged figures."
    text += " Columns with one value in all rows are left out."
    write_html(out / "report.html", facts, pictures, tables, "What accuracy costs", text)
    return [*names, "report.html"]
