"""A display of tactile pins (docs/pin_display.md)."""

TOP, BLOCKS = "msn_pin_display", ()
