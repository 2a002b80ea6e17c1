"""A latency term by term, as the pages of ``meissner budget`` print it."""


def table(found, names, of_total=""):
    """Lines: a head, each of ``found``'s terms_clocks that takes a clock, and the total; ``names``: {term:
    what happens in it}; ``of_total``: what the total is of."""
    clock_us = 1e6 / found["clock_hz"]
    line = lambda name, clocks: f"{name:15} {clocks:9} {clocks * clock_us:10.3f}"
    terms = [
        f"{line(name, clocks)}  {names[name]}" for name, clocks in found["terms_clocks"].items() if clocks
    ]
    total = line("total", found["total_clocks"])
    return [f"{'term':15} {'clocks':>9} {'us':>10}", *terms, f"{total}  {of_total}" if of_total else total]
