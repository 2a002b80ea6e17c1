"""The site builds without a warning and its core decides as the twin, each where its tools are installed."""

import re
import shutil
import subprocess
import sys

import pytest

from meissner.builds.toolchain import ROOT

pytestmark = pytest.mark.long

# Written from the page of the front page's core: every sample goes in, every decision is compared.
PLAY = """
global.window = {}; eval(require("fs").readFileSync("build/wasm/scene.js", "utf8"));
const S = window.SCENE, to = (t, K) => new K(Uint8Array.from(Buffer.from(t, "base64")).buffer);
require(process.cwd() + "/build/wasm/core.js")().then((core) => {
  core._start();
  for (const [address, word] of Object.entries(S.registers)) core._put(Number(address), word);
  if (process.argv[1]) core._put(S.threshold.address, Number(process.argv[1]));
  const p2p = to(S.p2p, Int32Array), state = to(S.state, Uint8Array);
  let decisions = 0, wrong = 0; const clocks = new Set();
  for (const code of to(S.codes, Int16Array)) {
    const f = core._next(code, S.bits) >> 2, H = core.HEAP32;
    if (!H[f]) continue;
    wrong += H[f + 1] !== p2p[decisions] || H[f + 2] !== state[decisions];
    clocks.add(H[f + 4]); decisions += 1;
  }
  console.log(JSON.stringify([decisions, p2p.length, wrong, [...clocks]]));
});
"""


def node(*arguments):
    done = subprocess.run(
        ["node", "--no-experimental-fetch", "-e", PLAY, *arguments], cwd=ROOT, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return [int(number) for number in re.findall(r"\d+", done.stdout)]


@pytest.mark.skipif(not shutil.which("em++") or not shutil.which("node"), reason="needs em++ and node")
def test_the_browsers_core_decides_as_the_twin():
    subprocess.run([sys.executable, "tools/make/wasm.py"], cwd=ROOT, check=True)
    assert node() == [27500, 27500, 0, 6]
    decisions, _, wrong, _ = node("2000")  # the threshold is that of the register
    assert decisions == 27500 and wrong > 0


def test_the_site_builds_without_a_warning(tmp_path):
    pytest.importorskip("sphinx", reason="needs Sphinx: make docs installs it")
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "-b", "html", "docs", str(tmp_path)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    pages = [path for path in tmp_path.rglob("*.html") if "src" not in path.relative_to(tmp_path).parts]
    assert len(pages) > 50
    for page in pages:  # links to sources lead somewhere
        for link in re.findall(r'href="((?:\.\./)*src/[^"#]+)', page.read_text("utf-8")):
            assert (page.parent / link).exists(), (page.name, link)
