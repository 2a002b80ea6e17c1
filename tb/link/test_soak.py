"""Slip events at full image load through the Verilated link, read by the C decoder, with none lost: a short
version of tools/published/soak_link.py."""

from published.soak_link import soak


def test_no_event_is_lost_at_full_image_load():
    found = soak(2000)
    assert (found.events, found.lost, found.wrong) == (2000, 0, 0)
    assert found.images > 10 and found.cops > 10 and found.held > 0
