"""The table of a latency's terms that ``meissner budget`` prints."""


def table(found, names, of_total=""):
    """Lines: a head, each term of ``found``'s terms_clocks that takes at least one clock, and the total.
    ``names``: {term: what happens in it}; ``of_total``: what the total covers."""
    clock_us = 1e6 / found["clock_hz"]
    line = lambda name, clocks: f"{name:15} {clocks:9} {clocks * clock_us:10.3f}"
    terms = [
        f"{line(name, clocks)}  {names[name]}" for name, clocks in found["terms_clocks"].items() if clocks
    ]
    total = line("total", found["total_clocks"])
    return [f"{'term':15} {'clocks':>9} {'us':>10}", *terms, f"{total}  {of_total}" if of_total else total]
