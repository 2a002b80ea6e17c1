"""The register map. Made by tools/registers.py from rtl/registers.rdl: change that, then `make registers`."""

from meissner.host.register import Field, Group, Register

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
                    Field("minor", 15, 8, "constant", 0x2),
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
        ),
    ),
    Group(
        "adc",
        "ADC master",
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
                "over_range",
                0x114,
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
                (Field("value", 19, 0, "setting", 0xFFFFF),),
            ),
            Register(
                "gross_threshold",
                0x204,
                "Gross slip above this, in codes.",
                (Field("value", 19, 0, "setting", 0xFFFFF),),
            ),
            Register(
                "contact_level",
                0x208,
                "Contact where a group's sum passes this, in codes, signed.",
                (Field("value", 19, 0, "setting", 0x0),),
            ),
            Register(
                "release_level",
                0x20C,
                "Released where it falls back past this, in codes, signed.",
                (Field("value", 19, 0, "setting", 0x0),),
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
                (Field("value", 15, 0, "setting", 0x0),),
            ),
            Register(
                "refractory", 0x218, "Details deaf after a flag.", (Field("value", 15, 0, "setting", 0x0),)
            ),
            Register("blank", 0x21C, "Details deaf after contact.", (Field("value", 15, 0, "setting", 0x0),)),
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
        ),
    ),
)
