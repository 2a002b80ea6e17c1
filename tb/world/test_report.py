"""Pictures and the report: they are written, complete, and need nothing from outside."""

import re

import numpy as np
import pytest

from meissner import report, scenes


@pytest.mark.parametrize(
    "name, flag", [("acrylic_slip", 3.9), ("acrylic_slip", None), ("normal_force", None)]
)
def test_a_slip_run_is_drawn(tmp_path, name, flag):
    run = scenes.simulate(scenes.load(name), seed=1)
    count = len(run.time_s) // 2
    picture = report.draw_slip(
        tmp_path / "slip.png",
        run,
        detail_time_s=run.time_s[1::2],
        detail_v=np.diff(run.volts)[::2] / -np.sqrt(2),
        p2p_v=np.zeros(count),
        state=np.arange(count) * 5 // count,
        threshold_v=0.02,
        flag_s=flag,
    )
    assert picture.read_bytes().startswith(b"\x89PNG") and picture.stat().st_size > 30_000


def test_the_report_needs_no_other_file(tmp_path):
    (tmp_path / "one.png").write_bytes(b"\x89PNG not really")
    page = report.write_html(
        tmp_path / "report.html",
        {"scene": "a <b> & c", "modelled": ["rubber", "adc"], "delay_s": 0.00123456, "flag_s": None},
        [(tmp_path / "one.png", "a caption"), str(tmp_path / "one.png")],
        {"conditions": [{"load": 2.0, "missed": 0}, {"load": 4.0, "missed": 1}], "empty": []},
    ).read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,") == 2
    assert "a &lt;b&gt; &amp; c" in page and "rubber, adc" in page and "0.001235" in page
    assert "<th>missed</th>" in page and "empty" not in page
    assert not re.search(r"""(src|href)=["'](?!data:)|https?://|url\(""", page)
