"""Write docs/blocks.md from the header comments of the sources in rtl/rtl.f, and the list of these sources in
meissner.core (for FuseSoC).

    python tools/make/blocks.py           print the page
    python tools/make/blocks.py --page    write both

The first sentence of a header states what the block does, the sentence that begins with "Latency" or
"Combinational" its latency, and a path under model/meissner/ its twin. The test has the block's name.
"""

import argparse
import re

from meissner.builds import toolchain

PAGE = toolchain.ROOT / "docs/blocks.md"
CORE = toolchain.ROOT / "meissner.core"
MODEL = "model/meissner/twins/"
HEAD = """# Blocks

`python tools/make/blocks.py --page` writes this page from the header comments of the sources, in the order of
`rtl/rtl.f`. The headers also give each block's formula and formats. [frames.md](frames.md) describes the
handshake and how each block handles damaged frames. A cell is empty if the header gives no single latency
or the file does not exist.

| block | stage | what it does | latency, throughput | twin | test |
|---|---|---|---|---|---|
"""


def header(path):
    """Paragraphs of the comment at the head of a source, without the licence."""
    lines = []
    for line in path.read_text().splitlines():
        if not line.startswith("//"):
            break
        lines.append(line.removeprefix("//").removeprefix(" ").rstrip())
    paragraphs = "\n".join(lines[1:]).strip().split("\n\n")
    # The first paragraph of a file that tools/make/registers.py generates says only that.
    return [text for text in paragraphs if not text.startswith("Made by ")]


END = r"(?<!\.)\.(?=\s|$)"  # of a sentence; skips the ".." of a range and the point in 1.5


def purpose(paragraphs):
    """The first sentence, without a formula that ends it."""
    sentence = re.split(rf"{END}|:\s{{2,}}|\s+Model:", paragraphs[0])[0]
    return " ".join(sentence.split()).rstrip(":")


def latency(paragraphs):
    """The statement of the latency sentence; empty if the header has none."""
    begin = r"(?:^|[.:]\s|\s\s)(Latency(?: and formats are)?|Combinational)\b"
    found = re.search(rf"{begin}(.*?){END}", "\n".join(paragraphs), re.DOTALL | re.MULTILINE)
    if not found:
        return ""
    words = " ".join(found[2].split()).strip(" :")
    return {"Combinational": f"0 clocks {words}".strip()}.get(found[1], words)


def link(path):
    """Markdown link to a file, relative to docs/."""
    text = str(path).removeprefix(MODEL).removeprefix("tb/")
    return f"[`{text}`](../{path})"


def row(path):
    """A block's row."""
    paragraphs = header(path)
    block = path.stem.removeprefix("msn_")
    twins = re.findall(rf"{MODEL}[\w/]+\.py", " ".join(paragraphs))
    tests = sorted(test.relative_to(toolchain.ROOT) for test in toolchain.ROOT.glob(f"tb/**/test_{block}.py"))
    cells = [
        f"[`{path.stem}`](../{path.relative_to(toolchain.ROOT)})",
        path.parent.name.replace("rtl", "top"),
        purpose(paragraphs),
        latency(paragraphs),
        "" if path.stem.endswith("_pkg") else ", ".join(map(link, dict.fromkeys(twins))),
        ", ".join(link(test) for test in tests if test.parent.name in (path.parent.name, "core")),
    ]
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def page():
    """docs/blocks.md as text."""
    return HEAD + "\n".join(map(row, toolchain.sources())) + "\n"


def core(before):
    """The text of meissner.core with its list of sources replaced by that of rtl/rtl.f."""
    listed = "".join(f"      - {path.relative_to(toolchain.ROOT)}\n" for path in toolchain.sources())
    return re.sub(r"(?m)(?:^ +- rtl/.*\n)+", listed, before, count=1)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--page", action="store_true", help="write docs/blocks.md and meissner.core")
    if parser.parse_args().page:
        PAGE.write_text(page())
        CORE.write_text(core(CORE.read_text()))
    else:
        print(page(), end="")


if __name__ == "__main__":
    main()
