"""Engine ``rtl``: the Verilated core behind batch C++ drivers, complete numpy arrays in and out."""

from meissner.engines.protocol import found_in

__getattr__ = found_in(
    {
        **dict.fromkeys(("watch", "watch_pins", "windows"), "rtl_slip"),
        **dict.fromkeys(("cop4", "cop_slip"), "rtl_cop4"),
        **dict.fromkeys(("demodulate", "calibrate"), "rtl_frontend"),
        "cop": "rtl_cop",
        "forest": "rtl_forest",
        "CoreOnPins": "rtl_core",
    }
)
