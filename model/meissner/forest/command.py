"""``meissner export-forest``: a trained model to F.json."""

from meissner.forest import file
from meissner.forest.models import load
from meissner.terminal import plain


def export(arguments):
    """``meissner export-forest``."""
    given = arguments.integer
    integer = given == "all" or [name for name in (given or "").split(",") if name]
    model = load(arguments.model, integer, arguments.trust).model
    file.write(arguments.out, model)
    parts = f"{len(model.trees)} trees, {model.nodes} nodes, {len(model.classes)} classes"
    print(f"{plain(model.source)}: {parts}, {len(model.features)} features")
    ranked = [each.name for each in model.features if each.thresholds is not None]
    if integer and (wide := [name for name in ranked if integer is True or name in integer]):
        print(f"ranked, because a threshold needs more than 22 bits: {plain(', '.join(wide))}")
    print(f"the forest: {plain(arguments.out)}")
