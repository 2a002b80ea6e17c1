"""Forests for the benches, drawn at random, and a decision by a plain loop over the nodes of F.json."""

from meissner.forest import file, words


def tree(draw, features, leaves, span, depth=6, stop=0.2, chain=False):
    """The lists of a tree: thresholds within ±``span``; ``chain``: one child of each node is a leaf."""
    lists = {name: [] for name in ("feature", "threshold", "left", "right")}

    def grow(deeper):
        if deeper == 0 or (not chain and draw.random() < stop):
            return -1 - draw.randrange(leaves)
        node = len(lists["feature"])
        for name, value in zip(lists, (draw.randrange(features), draw.randint(-span, span), 0, 0)):
            lists[name].append(value)
        sides = ["left", "right"]
        ended = draw.choice(sides) if chain else None
        for side in sides:
            lists[side][node] = grow(0 if side == ended else deeper - 1)
        return node

    root = grow(depth)
    return lists | ({"leaf": -1 - root} if root < 0 else {})


def leaf(draw, classes):
    """Votes that add up to 65535; some of pure leaves."""
    if draw.random() < 0.3 or classes == 1:
        pure = draw.randrange(classes)
        return [65535 * (label == pure) for label in range(classes)]
    cuts = sorted(draw.randint(0, 65535) for _ in range(classes - 1))
    return [high - low for low, high in zip([0, *cuts], [*cuts, 65535])]


def forest(draw, features, classes, trees, leaves=9, span=1000, **shape):
    """A checked model of integers: ``trees`` of the given shape, or the lists of each."""
    if isinstance(trees, int):
        trees = [tree(draw, features, leaves, span, **shape) for _ in range(trees)]
    return file.check(
        {"format": "meissner-forest", "version": 1, "source": "drawn", "classes": list(range(classes))}
        | {"features": [{"name": f"x{index}", "kind": "integer"} for index in range(features)]}
        | {"leaves": [leaf(draw, classes) for _ in range(leaves)], "trees": trees}
    )


def decide(model, row):
    """(votes of each class, first class with the most, nodes on the way), by a plain loop."""
    votes, steps = [0] * len(model.classes), 0
    for each in model.trees:
        at = each.root
        steps += at < 0  # a tree that is one leaf is a word, too
        while at >= 0:
            steps += 1
            side = each.left if row[each.feature[at]] <= each.threshold[at] else each.right
            at = int(side[at])
        for label, value in enumerate(model.leaves[-1 - at]):
            votes[label] += int(value)
    return votes, votes.index(max(votes)), steps


def moved(table, base):
    """The loads of ``table`` [(kind, engine, address, data)], its nodes ``base`` further up in the memory."""
    placed = []
    for kind, engine, address, data in table:
        if kind == words.NODE:
            address, data = address + base, data + (base if data >> 62 == 0 else 0)  # a child's address
        placed.append((kind, engine, address, data + base if kind == words.ROOT else data))
    return placed


def rows(draw, model, count, span):
    """Rows with every feature at both ends, then at thresholds exactly, one below and one above, then
    random."""
    features = len(model.features)
    given = [[-span] * features, [span - 1] * features]
    of_node = [
        (int(feature), int(limit))
        for each in model.trees
        for feature, limit in zip(each.feature, each.threshold)
    ]
    while len(given) < count:
        row = [draw.randint(-span, span - 1) for _ in range(features)]
        if of_node and len(given) % 2:
            for feature, limit in draw.choices(of_node, k=3):
                row[feature] = max(min(limit + draw.choice([-1, 0, 0, 1]), span - 1), -span)
        given.append(row)
    return given
