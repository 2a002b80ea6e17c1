"""The parts of a SystemVerilog package that a block uses, so that adding a type makes no evidence stale."""

import re
from functools import cache

_END = re.compile(r"[;{}]")


class Unknown(ValueError):
    """A declaration of an unknown kind in a package."""


def _statement(text, at):
    """The position after the ; that ends the statement at ``at``: the next one outside braces."""
    depth = 0
    while found := _END.search(text, at):
        at = found.end()
        depth += {"{": 1, "}": -1, ";": 0}[found[0]]
        if found[0] == ";" and not depth:
            return at
    raise Unknown(text[:40])


def _names(declaration):
    """The name of a declaration, and the members of an enum, which are also names of the package."""
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


@cache
def _named(name, user):
    """The names of package ``name`` in the text ``user``; None if it imports from it."""
    if re.search(rf"\bimport\s+{name}\b", user):
        return None
    return re.findall(rf"\b{name}::(\w+)", user)


def used(name, text, users):
    """The declarations of package ``name`` that the texts ``users`` name, with those that they need, in
    order; all of ``text`` if it has a declaration of unknown kind or a user imports from it."""
    try:
        known = declarations(text)
    except Unknown:
        return text
    named = [_named(name, user) for user in users]
    if None in named:
        return text
    wanted = {word for words in named for word in words}
    needed, waiting = set(), [word for word in wanted if word in known]
    while waiting:
        word = waiting.pop()
        if word not in needed:
            needed.add(word)
            waiting += [other for other in re.findall(r"\w+", known[word]) if other in known]
    return "\n".join(dict.fromkeys(known[word] for word in known if word in needed))
