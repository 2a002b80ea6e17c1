"""Mutants of a block's source text: another operator, one more or one less, operands or ports exchanged.

    changes(text, elaborated)      [Change, ...]: all possible changes
    draw(changes, count, seed)     some of them, alternating between the kinds

slang gives the syntax tree and, for the block with its parameters, the elaborated generate blocks and the
port widths of its instances. The head of the module, its parameter checks (`gen_check_*`) and messages are
not changed. A ``constant`` change is where SystemVerilog needs a constant, or in the target of an assignment;
it cannot be combined with others in one text (source_text.py).
"""

import random
import re
from dataclasses import dataclass, field

import pyslang
from pyslang import ast, parsing, syntax

SIZED = re.compile(r"(\d+)\s*'(s?)([bdho])\s*([\da-f_]+)$", re.IGNORECASE)
BASES = {"b": 2, "o": 8, "d": 10, "h": 16}
OTHER = {
    **{"GreaterThan": ">=", "GreaterThanEqual": ">", "LessThan": "<=", "LessThanEqual": "<"},
    **{"Equality": "!=", "Inequality": "=="},
}
NARROWER = {"GreaterThan": "+", "GreaterThanEqual": "-", "LessThan": "-", "LessThanEqual": "+"}
ORDERED = ("GreaterThan", "GreaterThanEqual", "LessThan", "LessThanEqual", "Subtract", "Divide", "Mod")
SHIFTS = ("LogicalShiftLeft", "LogicalShiftRight", "ArithmeticShiftLeft", "ArithmeticShiftRight")
SKIPPED = ("ModuleHeader", "ElabSystemTask", "StringLiteralExpression", "AttributeInstance", "BlockStatement")
CONSTANT = {
    *("ParameterDeclaration", "VariableDimension", "SimpleRangeSelect", "ParameterValueAssignment"),
    *("TypedefDeclaration", "FunctionDeclaration", "InitialBlock", "Declarator", "RangeSelect"),
}
FIXED = {  # syntax nodes with a part that must be constant or is the target of an assignment
    **{"AssignmentExpression": "left", "NonblockingAssignmentExpression": "left", "CastExpression": "left"},
    **{
        "MultipleConcatenationExpression": "expression",
        "IfGenerate": "condition",
        "CaseGenerate": "condition",
    },
    **{"AscendingRangeSelect": "right", "DescendingRangeSelect": "right"},
}
NOT_FIXED = {"LoopGenerate": "block", "ForLoopStatement": "statement", "StandardCaseItem": "clause"}
LITERALS = ("IntegerLiteral", "IntegerVector", "UnbasedUnsizedLiteral")


@dataclass(frozen=True)
class Edit:
    """Replaces the source between two offsets by ``text``; ``port``: the port of a name-only connection."""

    start: int
    end: int
    text: str
    port: str = ""


@dataclass(frozen=True)
class Change:
    """One mutant. ``outputs``: (instance, its ports, their width) if two outputs are exchanged."""

    kind: str
    line: int
    what: str
    edits: tuple[Edit, ...]
    constant: bool = False
    outputs: tuple = ()


@dataclass
class Elaborated:
    """slang's facts about a block with its parameters: the offsets of generate blocks that are not
    elaborated, and {offset of an instance: {port: (direction, width)}}."""

    absent: list[tuple[int, int]] = field(default_factory=list)
    instances: dict[int, dict] = field(default_factory=dict)


def _bag():
    """slang's options to read a source as synthesis does, without assertions."""
    options = parsing.PreprocessorOptions()
    options.predefines = ["SYNTHESIS=1"]
    return options


def read(path):
    """A source as text; non-ASCII letters in comments are dropped, since slang's offsets count bytes."""
    return path.read_bytes().decode("ascii", "replace").replace("\ufffd", "?")


def elaborate(paths, top, parameters):
    """slang's facts about ``top``, in the last of ``paths``, with these parameters."""
    options, found = ast.CompilationOptions(), Elaborated()
    options.topModules = {top}
    options.paramOverrides = [f"{name}={value}" for name, value in parameters.items()]
    bag = pyslang.Bag([options, _bag()])
    compilation, manager = ast.Compilation(bag), pyslang.SourceManager()
    trees = [syntax.SyntaxTree.fromFile(str(path), manager, bag) for path in paths]
    for tree in trees:
        compilation.addSyntaxTree(tree)
    own = trees[-1].root.sourceRange.start.buffer
    present, blocks = set(), set()

    def see(symbol):
        node = getattr(symbol, "syntax", None)
        if node is None or node.sourceRange.start.buffer != own:
            return
        place = node.sourceRange.start.offset, node.sourceRange.end.offset
        if isinstance(symbol, ast.GenerateBlockSymbol):
            blocks.add(place)
            if not symbol.isUninstantiated:
                present.add(place)
        elif isinstance(symbol, ast.InstanceSymbol) and place[0]:
            known = found.instances.setdefault(place[0], {})
            for connection in symbol.portConnections:
                port, way = connection.port, connection.port.direction.name
                told = way, port.type.bitWidth
                known[port.name] = told if known.get(port.name, told) == told else (way, None)

    compilation.getRoot().visit(see)
    for node, _ in _nodes(trees[-1].root):
        if node.kind.name == "GenerateBlock":  # a loop with no iteration has no symbol
            blocks.add((node.sourceRange.start.offset, node.sourceRange.end.offset))
    found.absent = sorted(blocks - present)
    return found


def _nodes(node, above=None):
    yield node, above
    for child in node:
        if isinstance(child, syntax.SyntaxNode):
            yield from _nodes(child, node)


def changes(text, elaborated):
    """All changes of a block's source, in the order of the text."""
    tree = syntax.SyntaxTree.fromText(text, pyslang.SourceManager(), "own", "", pyslang.Bag([_bag()]))
    listing = _Listing(text, elaborated)
    listing.walk(tree.root, False)
    return sorted(listing.found, key=lambda change: change.edits[0].start)


class _Listing:
    def __init__(self, text, elaborated):
        self.text, self.elaborated, self.found = text, elaborated, []

    def of(self, node):
        return self.text[node.sourceRange.start.offset : node.sourceRange.end.offset]

    def add(self, kind, node, new, constant):
        span = node.sourceRange
        self.note(kind, [Edit(span.start.offset, span.end.offset, new)], self.of(node), new, constant)

    def note(self, kind, edits, old, new, constant, outputs=()):
        line = self.text.count("\n", 0, edits[0].start) + 1
        what = " ".join(f"{kind}: {old} -> {new}".split())
        self.found.append(Change(kind, line, what, tuple(edits), constant, outputs))

    def walk(self, node, constant):
        kind, start = node.kind.name, node.sourceRange.start.offset
        if kind in SKIPPED or any(first <= start < end for first, end in self.elaborated.absent):
            return
        if kind.endswith("Assertion") or kind.endswith("AssertionStatement"):
            return
        if kind == "IfGenerate" and "begin : gen_check_" in self.of(node.block)[:30]:
            return
        constant = constant or kind in CONSTANT
        self.here(node, kind.removesuffix("Expression"), constant)
        for child in node:
            if isinstance(child, syntax.SyntaxNode):
                self.walk(child, constant or self.fixed(node, kind, child))

    def fixed(self, node, kind, child):
        """Whether the child of a node must be constant, or is the target of an assignment."""
        if kind == "NamedPortConnection":
            ports = self.elaborated.instances.get(node.parent.sourceRange.start.offset, {})
            return ports.get(node.name.rawText, ("",))[0] != "In"
        if kind in NOT_FIXED:
            return not _same(child, getattr(node, NOT_FIXED[kind]))
        return kind in FIXED and _same(child, getattr(node, FIXED[kind]))

    def here(self, node, kind, constant):
        """The changes at a node."""
        if kind in OTHER or kind in ORDERED or kind in SHIFTS:
            left, right = self.of(node.left), self.of(node.right)
            sign = node.operatorToken.rawText
            literal = any(
                side.kind.name.removesuffix("Expression") in LITERALS for side in (node.left, node.right)
            )
            if kind in OTHER:
                self.add("comparison", node, f"{left} {OTHER[kind]} {right}", constant)
            if kind in NARROWER and not literal:
                self.add("one", node, f"{left} {sign} {_inner(right)} {NARROWER[kind]} 1", constant)
            if kind in ORDERED or (kind in SHIFTS and not literal):
                self.add("operands", node, f"{_inner(right)} {sign} {_inner(left)}", constant)
        elif kind == "Conditional":
            arms = self.of(node.right), self.of(node.left)
            new = f"{self.of(node.predicate)} ? {_inner(arms[0])} : {_inner(arms[1])}"
            self.add("operands", node, new, constant)
        elif kind in LITERALS:
            for new in neighbours(self.of(node)):
                self.add("one", node, new, constant)
        elif kind == "HierarchicalInstance":
            self.ports(node)

    def ports(self, node):
        """Exchange the connections of two ports of equal width and direction."""
        widths = self.elaborated.instances.get(node.sourceRange.start.offset, {})
        known = []
        for connection in node.connections:
            if getattr(connection, "kind", None) is None or connection.kind.name != "NamedPortConnection":
                continue
            name, span = connection.name.rawText, connection.sourceRange
            way, width = widths.get(name, ("", None))
            inner = connection.expr
            if width is None or name == "clk_i" or (inner is None and connection.openParen.rawText):
                continue
            expression = self.of(inner) if inner is not None else name
            known.append((way, width, name, expression, inner, span))
        for place, one in enumerate(known):
            for other in known[place + 1 :]:
                if one[:2] == other[:2] and one[3] != other[3]:
                    edits = [self.given(*one[2:], other[3]), self.given(*other[2:], one[3])]
                    away = (node.parent.sourceRange.start.offset, (one[2], other[2]), one[1])
                    old = f"{self.of(node.decl)} .{one[2]} .{other[2]}"
                    new = f".{other[2]} .{one[2]}"
                    self.note("ports", edits, old, new, False, away if one[0] == "Out" else ())

    def given(self, port, _, inner, span, text):
        if inner is None:
            return Edit(span.start.offset, span.end.offset, text, port)
        return Edit(inner.sourceRange.start.offset, inner.sourceRange.end.offset, text)


def _inner(text):
    """An operand's text for another place, in parentheses unless it is a name or a number."""
    return text if re.fullmatch(r"[\w.'\[\]:]+", text) else f"({text})"


def _same(node, other):
    """Whether two objects are the same node, since each access to the tree creates new objects."""
    one, two = node.sourceRange, other.sourceRange
    return node.kind == other.kind and (one.start, one.end) == (two.start, two.end)


def neighbours(literal):
    """The literals of one more and one less, of the same size; they wrap around between the largest and 0."""
    if literal == "'0":
        return ["1'b1"]
    if re.fullmatch(r"[\d_]+", literal):
        value = int(literal.replace("_", ""))
        return [str(value + 1), *([str(value - 1)] if value else [])]
    if not (sized := SIZED.match(literal)):
        return []  # not a number, or without a size
    size, signed, base, digits = sized.groups()
    value, end = int(digits.replace("_", ""), BASES[base.lower()]), 1 << int(size)
    shown = {"b": "b", "o": "o", "d": "d", "h": "x"}[base.lower()]
    others = dict.fromkeys(other % end for other in (value + 1, value - 1))
    return [f"{size}'{signed}{base}{other:{shown}}" for other in others]


def draw(known, count, seed):
    """At most ``count`` random changes, alternating between kinds; changes of constants are kinds apart."""
    chance, kinds = random.Random(f"{seed}"), {}
    for change in known:
        kinds.setdefault((change.kind, change.constant), []).append(change)
    for some in kinds.values():
        chance.shuffle(some)
    turns = [(turn, kind) for kind, some in kinds.items() for turn in range(len(some))]
    return [kinds[kind][turn] for turn, kind in sorted(turns)[:count]]
