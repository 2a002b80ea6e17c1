"""A tactile image, a centre of pressure and a slip on pins (docs/pin_display.md)."""

TOP, BLOCKS = "msn_render", ()
