"""What a block uses of a SystemVerilog package, so that a type that is added makes nothing else stale."""

import re
from functools import cache

_END = re.compile(r"[;{}]")


class Unknown(ValueError):
    """A declaration that is none of a package's known kinds."""


def _statement(text, at):
    """Past the ; that ends the statement at ``at``: the next outside braces."""
    depth = 0
    while found := _END.search(text, at):
        at = found.end()
        depth += {"{": 1, "}": -1, ";": 0}[found[0]]
        if found[0] == ";" and not depth:
            return at
    raise Unknown(text[:40])


def _names(declaration):
    """What a declaration is called, and the members of an enum, which are names of the package, too."""
    if declaration.startswith("function"):
        return re.findall(r"(\w+)\s*[(;]", declaration)[:1]
    if declaration.startswith("typedef"):
        name = re.findall(r"(\w+)\s*;$", declaration)
        inside = re.search(r"enum\b[^{]*\{(.*)\}", declaration)
        return name + (re.findall(r"(?:^|,)\s*(\w+)", inside[1]) if inside else [])
    if declaration.startswith(("localparam", "parameter")):
        return re.findall(r"(\w+)\s*=", declaration)[:1]
    raise Unknown(declaration[:40])


@cache
def declarations(text):
    """{name: declaration} of a package's text without comments, on one line."""
    body = re.search(r"\bpackage \w+;(.*)\bendpackage\b", text)
    if not body:
        raise Unknown(text[:40])
    text, at, found = body[1].strip(), 0, {}
    while at < len(text):
        if text.startswith("function", at):
            end = text.index("endfunction", at) + len("endfunction")
        else:
            end = _statement(text, at)
        declaration = text[at:end].strip()
        names = _names(declaration)
        if not names:
            raise Unknown(declaration[:40])
        found |= dict.fromkeys(names, declaration)
        at = end + len(text[end:]) - len(text[end:].lstrip())
    return found


def used(name, text, users):
    """The declarations of package ``name`` that the texts ``users`` name, and what these need, in order;
    all of ``text`` if it has something unknown, or a user imports from it."""
    try:
        known = declarations(text)
    except Unknown:
        return text
    if any(re.search(rf"\bimport\s+{name}\b", user) for user in users):
        return text
    wanted = {word for user in users for word in re.findall(rf"\b{name}::(\w+)", user)}
    needed, waiting = set(), [word for word in wanted if word in known]
    while waiting:
        word = waiting.pop()
        if word not in needed:
            needed.add(word)
            waiting += [other for other in re.findall(r"\w+", known[word]) if other in known]
    return "\n".join(dict.fromkeys(known[word] for word in known if word in needed))
