"""A block's source with one change of source_mutants.py, or with many, one of which an input selects.

alone(text, change)               the text with this change
together(text, numbered, width)   the text with all of {number: Change}; `mutsel` selects one, 0: none
"""

import re


def alone(text, change):
    """The source with one change."""
    for edit in sorted(change.edits, key=lambda edit: -edit.start):
        new = f".{edit.port}({edit.text})" if edit.port else edit.text
        text = text[: edit.start] + new + text[edit.end :]
    return text


def together(text, numbered, width):
    """The source with all changes {number: Change}; an input ``mutsel`` of ``width`` bits selects one."""
    spans, crossed = {}, {}
    for number, change in numbered.items():
        if change.outputs:
            instance, (one, other), bits = change.outputs
            for place, (port, goes) in enumerate(((one, other), (other, one))):
                edit = change.edits[place]
                entry = crossed.setdefault((edit.start, edit.end), (instance, port, bits, edit, {}))
                entry[-1][number] = goes
        else:
            for edit in change.edits:
                spans.setdefault((edit.start, edit.end, edit.port), []).append((number, edit.text))
    inserted = {}
    for (start, end), (instance, port, bits, edit, others) in crossed.items():
        net = f"m_{instance}_{{}}".format
        target = edit.port or text[start:end]
        value = net(port)
        for number, other in others.items():
            value = f"mutsel == {number} ? {net(other)} : {value}"
        lines = f"logic [{bits - 1}:0] {net(port)}; assign {target} = {value}; "
        inserted[instance] = inserted.get(instance, "") + lines
        spans[start, end, edit.port] = net(port)
    head = re.search(r"\n\);", text).start() + 1
    inserted[head] = f", input logic [{width - 1}:0] mutsel\n"
    return _rendered(text, spans, inserted, 0, len(text))


def _rendered(text, spans, inserted, start, end, within=None):
    """The source between two offsets with every choice inserted; choices may be nested."""
    out, at = [], start
    inside = [s for s in spans if start <= s[0] and s[1] <= end and s != within]
    points = sorted([(s[0], -s[1], s) for s in inside] + [(p, 1, None) for p in inserted if start <= p < end])
    for place, _, span in points:
        if place < at:
            continue  # inside a choice already rendered
        out.append(text[at:place])
        at = place
        if span is None:
            out.append(inserted[place])
            continue
        said = spans[span]
        own = span[2] or _rendered(text, spans, {}, *span[:2], within=span)
        if isinstance(said, str):
            new = said
        else:
            new = own
            for number, other in said:
                new = f"(mutsel == {number} ? ({other}) : ({new}))"
        out.append(f".{span[2]}({new})" if span[2] else new)
        at = span[1]
    out.append(text[at:end])
    return "".join(out)
