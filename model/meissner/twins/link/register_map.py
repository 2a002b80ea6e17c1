# ruff: noqa: E501 - the texts are as long as their source's
"""The register map. Made by tools/registers.py from rtl/registers.rdl: change that, then `make registers`."""

from meissner.twins.link.register import Field, Group, Register

GROUPS = (
    Group(
        "core",
        "What this core is",
        False,
        False,
        (
            Register(
                "id",
                0x000,
                "The letters MSNR: a Meissner core answers here.",
                (Field("value", 31, 0, "constant", 0x4D534E52),),
            ),
            Register(
                "version",
                0x004,
                "Of this register map. A host refuses another major and, while major is 0, another minor.",
                (
                    Field("patch", 7, 0, "constant", 0x0),
                    Field("minor", 15, 8, "constant", 0x4),
                    Field("major", 31, 16, "constant", 0x0),
                ),
            ),
            Register(
                "features",
                0x008,
                "A bit for each group of registers below, the first lowest: 1 where the build has it.",
                (Field("value", 31, 0, "status", 0x0),),
            ),
            Register(
                "size",
                0x00C,
                "Of the array; one row of as many columns as channels where there is no array.",
                (
                    Field("rows", 15, 0, "status", 0x0),
                    Field("columns", 31, 16, "status", 0x0),
                ),
            ),
            Register(
                "clk_khz",
                0x010,
                "The clock that ticks count, in kHz.",
                (Field("value", 31, 0, "status", 0x0),),
            ),
            Register(
                "scratch",
                0x014,
                "Keeps what is written, to try a link.",
                (Field("value", 31, 0, "setting", 0x0),),
            ),
            Register(
                "widths",
                0x018,
                "Bits that this build has for a detail, a time in details, a load and an offset; settings that are wider are held at their ends, and read so.",
                (
                    Field("detail", 7, 0, "status", 0x0),
                    Field("timer", 15, 8, "status", 0x0),
                    Field("load", 23, 16, "status", 0x0),
                    Field("offset", 31, 24, "status", 0x0),
                ),
            ),
            Register(
                "beats",
                0x01C,
                "Of a frame of the array; what is written to a word from this on is lost.",
                (Field("value", 20, 0, "status", 0x0),),
            ),
        ),
    ),
    Group(
        "adc",
        "Converter of single channels or of four electrodes",
        True,
        False,
        (
            Register("enable", 0x100, "Converts while 1.", (Field("value", 0, 0, "setting", 0x0),)),
            Register(
                "period",
                0x104,
                "Clocks from convert start to convert start; 0: 2^24.",
                (Field("value", 23, 0, "setting", 0x0),),
            ),
            Register(
                "dropped",
                0x108,
                "Frames dropped whole, because the chain was not ready.",
                (Field("value", 31, 0, "status", 0x0),),
            ),
            Register(
                "overrun",
                0x10C,
                "Ticks without a conversion, because the frame before was under way.",
                (Field("value", 31, 0, "status", 0x0),),
            ),
            Register(
                "timeout",
                0x110,
                "Frames given up, because the converter did not answer.",
                (Field("value", 31, 0, "status", 0x0),),
            ),
            Register(
                "mistagged",
                0x114,
                "Frames whose answers had another channel's number.",
                (Field("value", 31, 0, "status", 0x0),),
            ),
            Register(
                "over_range",
                0x118,
                "Samples at an end of the converter's range.",
                (Field("value", 31, 0, "status", 0x0),),
            ),
        ),
    ),
    Group(
        "slip",
        "Slip of each channel",
        True,
        True,
        (
            Register(
                "threshold",
                0x200,
                "Incipient slip: a peak-to-peak of the detail above this, in codes.",
                (Field("value", 19, 0, "setting", 0xFFFFF, False, "detail"),),
            ),
            Register(
                "gross_threshold",
                0x204,
                "Gross slip above this, in codes.",
                (Field("value", 19, 0, "setting", 0xFFFFF, False, "detail"),),
            ),
            Register(
                "contact_level",
                0x208,
                "Contact where a group's sum reaches this, in codes, signed.",
                (Field("value", 19, 0, "setting", 0x0, True, "detail"),),
            ),
            Register(
                "release_level",
                0x20C,
                "Released where it falls back past this, in codes, signed.",
                (Field("value", 19, 0, "setting", 0x0, True, "detail"),),
            ),
            Register(
                "contact_rises",
                0x210,
                "1: the code rises with the force; 0: it falls.",
                (Field("value", 0, 0, "setting", 0x1),),
            ),
            Register(
                "hold",
                0x214,
                "Details that a flag outlasts its cause.",
                (Field("value", 15, 0, "setting", 0x0, False, "timer"),),
            ),
            Register(
                "refractory",
                0x218,
                "Details deaf after a flag.",
                (Field("value", 15, 0, "setting", 0x0, False, "timer"),),
            ),
            Register(
                "blank",
                0x21C,
                "Details deaf after contact.",
                (Field("value", 15, 0, "setting", 0x0, False, "timer"),),
            ),
            Register(
                "damaged",
                0x220,
                "Frames with channels out of order.",
                (Field("value", 31, 0, "status", 0x0),),
            ),
            Register(
                "blanked",
                0x224,
                "Details over the threshold while deaf.",
                (Field("value", 31, 0, "status", 0x0),),
            ),
            Register(
                "keep_threshold",
                0x228,
                "A flag that is up stays up above this too, in codes; the threshold or more: no hysteresis.",
                (Field("value", 19, 0, "setting", 0xFFFFF, False, "detail"),),
            ),
        ),
    ),
    Group(
        "scan",
        "Scan of an array",
        True,
        False,
        (
            Register("enable", 0x300, "Scans while 1.", (Field("value", 0, 0, "setting", 0x0),)),
            Register(
                "settle",
                0x304,
                "Clocks from a change of row or group to the convert start.",
                (Field("value", 15, 0, "setting", 0x1),),
            ),
            Register(
                "period",
                0x308,
                "Clocks from frame start to frame start; 0: one after the other.",
                (Field("value", 31, 0, "setting", 0x0),),
            ),
            Register(
                "interleave",
                0x30C,
                "1: even rows first, then odd ones.",
                (Field("value", 0, 0, "setting", 0x0),),
            ),
            Register(
                "dropped",
                0x310,
                "Frames dropped whole, because the chain was not ready.",
                (Field("value", 31, 0, "status", 0x0),),
            ),
            Register(
                "overrun",
                0x314,
                "Frame ticks without a frame, because the one before was under way.",
                (Field("value", 31, 0, "status", 0x0),),
            ),
            Register(
                "held",
                0x318,
                "Clocks that the scan waited for room: none, as its buffer holds a whole frame.",
                (Field("value", 31, 0, "status", 0x0),),
            ),
            Register(
                "lost",
                0x31C,
                "Conversions in which a converter did not answer.",
                (Field("value", 31, 0, "status", 0x0),),
            ),
        ),
    ),
    Group(
        "health",
        "Health of taxels",
        True,
        False,
        (
            Register(
                "band", 0x400, "A move is more than this, in codes.", (Field("value", 16, 0, "setting", 0x2),)
            ),
            Register(
                "jump",
                0x404,
                "A step that a finger cannot make, in codes; 0: any.",
                (Field("value", 16, 0, "setting", 0x0),),
            ),
            Register(
                "low",
                0x408,
                "Railed at or below this code, signed.",
                (Field("value", 16, 0, "setting", 0x0, True, ""),),
            ),
            Register(
                "high",
                0x40C,
                "Railed at or above this code, signed.",
                (Field("value", 16, 0, "setting", 0xFFFF, True, ""),),
            ),
            Register(
                "use",
                0x410,
                "user: over-range samples count as railed; edges: taxels at the border are judged by one neighbour.",
                (
                    Field("user", 0, 0, "setting", 0x1),
                    Field("edges", 1, 1, "setting", 0x1),
                ),
            ),
            Register(
                "still", 0x414, "Dead from this count on; 0: off.", (Field("value", 7, 0, "setting", 0x0),)
            ),
            Register(
                "rail",
                0x418,
                "At the rail in this many of the frames 0, 16, 32, .. in a row; 0: off.",
                (Field("value", 7, 0, "setting", 0x0),),
            ),
            Register(
                "blink",
                0x41C,
                "Blinking from this count on; 0: off.",
                (Field("value", 7, 0, "setting", 0x0),),
            ),
            Register("clear", 0x420, "Forgets every fault.", (Field("value", 0, 0, "command", 0x0),)),
            Register("report", 0x424, "Sends every fault again.", (Field("value", 0, 0, "command", 0x0),)),
            Register("dead", 0x428, "Dead taxels.", (Field("value", 20, 0, "status", 0x0),)),
            Register("railed", 0x42C, "Railed taxels.", (Field("value", 20, 0, "status", 0x0),)),
            Register("blinking", 0x430, "Blinking taxels.", (Field("value", 20, 0, "status", 0x0),)),
        ),
    ),
    Group(
        "tare",
        "Zero of each taxel",
        True,
        False,
        (
            Register(
                "contact",
                0x480,
                "Contact is more than this above the zero, in codes.",
                (Field("value", 16, 0, "setting", 0x40),),
            ),
            Register(
                "step",
                0x484,
                "The zero follows by this in 2^-12 codes a frame; 0: it does not.",
                (Field("value", 7, 0, "setting", 0x1),),
            ),
            Register(
                "force",
                0x488,
                "1: an averaging is not refused because something presses.",
                (Field("value", 0, 0, "setting", 0x0),),
            ),
            Register(
                "at_start",
                0x48C,
                "1: averages at once after reset, whatever presses.",
                (Field("value", 0, 0, "setting", 0x1),),
            ),
            Register(
                "average",
                0x490,
                "Averages the next frames into the zeros.",
                (Field("value", 0, 0, "command", 0x0),),
            ),
            Register(
                "load",
                0x494,
                "While 1 frames are swallowed and zeros can be written.",
                (Field("value", 0, 0, "setting", 0x0),),
            ),
            Register(
                "word",
                0x498,
                "Beat whose zeros are written; none from core.beats on.",
                (Field("value", 19, 0, "setting", 0x0),),
            ),
            Register(
                "zero",
                0x49C,
                "What is written, in codes, signed.",
                (Field("value", 16, 0, "setting", 0x0, True, ""),),
            ),
            Register(
                "write",
                0x4A0,
                "Lanes of the word to write; each write to this register writes them.",
                (Field("value", 7, 0, "setting", 0x0),),
                True,
            ),
            Register(
                "state",
                0x4A4,
                "loading: zeros can be written; taring: averages; pressed: the last frame was in contact.",
                (
                    Field("loading", 0, 0, "status", 0x0),
                    Field("taring", 1, 1, "status", 0x0),
                    Field("pressed", 2, 2, "status", 0x0),
                ),
            ),
            Register("tared", 0x4A8, "Averagings done.", (Field("value", 15, 0, "status", 0x0),)),
            Register(
                "refused",
                0x4AC,
                "Averagings refused, because something pressed.",
                (Field("value", 15, 0, "status", 0x0),),
            ),
            Register(
                "swallowed",
                0x4B0,
                "Frames swallowed while zeros were loaded.",
                (Field("value", 31, 0, "status", 0x0),),
            ),
        ),
    ),
    Group(
        "calibrate",
        "Calibration of taxels",
        True,
        False,
        (
            Register(
                "preset",
                0x500,
                "Gain that every taxel has from reset on, before any is loaded; 0: forces are 0 until then.",
                (Field("value", 15, 0, "setting", 0x0),),
            ),
            Register(
                "word",
                0x504,
                "Beat whose calibration is written; with gains of rows and columns, the row or the beat of a row.",
                (Field("value", 19, 0, "setting", 0x0),),
            ),
            Register(
                "offset",
                0x508,
                "Offset to write, in codes, signed.",
                (Field("value", 16, 0, "setting", 0x0, True, "offset"),),
            ),
            Register("gain", 0x50C, "Gain to write.", (Field("value", 15, 0, "setting", 0x0),)),
            Register(
                "write",
                0x510,
                "lanes: of the word to write; row: the word is a row's. Each write to this register writes them.",
                (
                    Field("lanes", 7, 0, "setting", 0x0),
                    Field("row", 8, 8, "setting", 0x0),
                ),
                True,
            ),
            Register(
                "swap",
                0x514,
                "What was written is used from the next frame on.",
                (Field("value", 0, 0, "command", 0x0),),
            ),
            Register(
                "swapping",
                0x518,
                "A swap is asked for and not done yet.",
                (Field("value", 0, 0, "status", 0x0),),
            ),
        ),
    ),
    Group(
        "cop",
        "Centre of pressure of an array",
        True,
        True,
        (
            Register(
                "min_load",
                0x600,
                "Pressed from this load on, in units of force.",
                (Field("value", 31, 0, "setting", 0x1, False, "load"),),
            ),
            Register("damaged", 0x604, "Frames without a result.", (Field("value", 31, 0, "status", 0x0),)),
        ),
    ),
    Group(
        "cop4",
        "Four electrodes",
        True,
        True,
        (
            Register(
                "rail", 0x700, "Twice the supply V0, in codes.", (Field("value", 16, 0, "setting", 0xFFFF),)
            ),
            Register("kx", 0x704, "Mantissa of Cx.", (Field("value", 16, 0, "setting", 0x0),)),
            Register("shift_x", 0x708, "Exponent of Cx.", (Field("value", 3, 0, "setting", 0x0),)),
            Register("ky", 0x70C, "Mantissa of Cy.", (Field("value", 16, 0, "setting", 0x0),)),
            Register("shift_y", 0x710, "Exponent of Cy.", (Field("value", 3, 0, "setting", 0x0),)),
            Register("kf", 0x714, "Mantissa of Kf.", (Field("value", 16, 0, "setting", 0x0),)),
            Register("shift_load", 0x718, "Exponent of Kf.", (Field("value", 3, 0, "setting", 0x0),)),
            Register(
                "p0",
                0x71C,
                "Coefficient 0 of the load's correction, signed.",
                (Field("value", 17, 0, "setting", 0x0, True, ""),),
            ),
            Register(
                "p1",
                0x720,
                "Coefficient 1 of the load's correction, signed.",
                (Field("value", 17, 0, "setting", 0x0, True, ""),),
            ),
            Register(
                "p2",
                0x724,
                "Coefficient 2 of the load's correction, signed.",
                (Field("value", 17, 0, "setting", 0x0, True, ""),),
            ),
            Register(
                "p3",
                0x728,
                "Coefficient 3 of the load's correction, signed.",
                (Field("value", 17, 0, "setting", 0x0, True, ""),),
            ),
            Register(
                "p4",
                0x72C,
                "Coefficient 4 of the load's correction, signed.",
                (Field("value", 17, 0, "setting", 0x0, True, ""),),
            ),
            Register(
                "p5",
                0x730,
                "Coefficient 5 of the load's correction, signed.",
                (Field("value", 17, 0, "setting", 0x0, True, ""),),
            ),
            Register(
                "min_load",
                0x734,
                "Pressed from this load on, in its LSBs.",
                (Field("value", 15, 0, "setting", 0x1),),
            ),
            Register(
                "top",
                0x738,
                "Largest code of the converter; the lowest is its negative less one.",
                (Field("value", 15, 0, "setting", 0xFFFF),),
            ),
            Register(
                "idle",
                0x73C,
                "Code of an electrode without current, signed.",
                (Field("value", 16, 0, "setting", 0xFFFF, True, ""),),
            ),
            Register(
                "busy",
                0x740,
                "Code up to which an electrode has some, signed.",
                (Field("value", 16, 0, "setting", 0xFFFF, True, ""),),
            ),
            Register(
                "imbalance",
                0x744,
                "Largest difference of the two expressions of the current, in codes.",
                (Field("value", 17, 0, "setting", 0x3FFFF),),
            ),
        ),
    ),
    Group(
        "cop_slip",
        "Slip from the load of four electrodes",
        True,
        True,
        (
            Register(
                "drop",
                0x800,
                "Drop of the load over the lag, in 256ths.",
                (Field("value", 7, 0, "setting", 0x80),),
            ),
            Register(
                "move",
                0x804,
                "Least move of the centre over the lag, Q2.14.",
                (Field("value", 15, 0, "setting", 0x0),),
            ),
            Register(
                "min_load", 0x808, "Least load before the drop.", (Field("value", 15, 0, "setting", 0x0),)
            ),
            Register(
                "hold",
                0x80C,
                "Samples that the flag outlasts its cause.",
                (Field("value", 15, 0, "setting", 0x0),),
            ),
            Register(
                "refractory", 0x810, "Samples deaf after a flag.", (Field("value", 15, 0, "setting", 0x0),)
            ),
        ),
    ),
    Group(
        "link",
        "Packets",
        True,
        False,
        (
            Register("images", 0x900, "1: images are sent.", (Field("value", 0, 0, "setting", 0x1),)),
            Register("packets", 0x904, "Packets begun.", (Field("value", 31, 0, "status", 0x0),)),
            Register(
                "cop_dropped",
                0x908,
                "CoP frames that a newer one replaced.",
                (Field("value", 31, 0, "status", 0x0),),
            ),
            Register(
                "image_dropped",
                0x90C,
                "Images that a newer one replaced.",
                (Field("value", 31, 0, "status", 0x0),),
            ),
            Register("rejected", 0x910, "Commands that were none.", (Field("value", 31, 0, "status", 0x0),)),
        ),
    ),
)
