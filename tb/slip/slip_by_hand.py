"""msn_slip against the hand-made cases of tb/reference/slip_cases.py and the loop of tb/reference/slip.py.

Run by test_slip.py, with timers of four bits.
"""

import itertools
import random
from types import SimpleNamespace

import cocotb

import bench
from reference.slip import NUMBERS, SlipReference
from reference.slip_cases import CASES, FALLS, RISES, SIZES

FIELDS = ["state", "raised", "over", "p2p", "id", "last", "end"]


async def begin(dut):
    given = {port._name: 0 for port in dut if port._name.startswith("cfg_")}
    await bench.start(dut, **given, actuator_moving_i=0)


async def apply(dut, settings):
    for name, value in ({"keep_threshold": -1} | settings).items():  # -1: no keep threshold
        port = getattr(dut, f"cfg_{name}_i")
        port.value = int(value) & ((1 << len(port)) - 1)
    await bench.reset(dut)


async def decisions(dut, details, gap=0):
    """Send (p2p, level, moving, masked) of [detail][channel]; return the decisions in their order."""
    channels, got = dut.Channels.value.to_unsigned(), []
    dut.out_ready_i.value = 1

    def note():
        if dut.out_valid_o.value == 1:
            got.append({field: bench.read(getattr(dut, f"out_{field}_o")) for field in FIELDS})

    for number, row in enumerate(details):
        for channel, (p2p, level, moving, masked) in enumerate(row):
            beat = {"p2p": p2p, "total": level, "id": channel, "last": channel == channels - 1}
            bench.offer(dut, beat | {"restart": number == 0, "mask": masked, "end": number % 3 == 2})
            dut.in_valid_i.value, dut.actuator_moving_i.value = 1, int(moving)
            await bench.ReadOnly()
            note()
            await bench.RisingEdge(dut.clk_i)
            for _ in range(gap):  # nothing of these clocks may be taken
                dut.in_valid_i.value, dut.actuator_moving_i.value = 0, int(not moving)
                await bench.ReadOnly()
                note()
                await bench.RisingEdge(dut.clk_i)
    dut.in_valid_i.value = 0
    for _ in range(4):
        await bench.ReadOnly()
        note()
        await bench.RisingEdge(dut.clk_i)
    return got


def expected_of(states, over, details):
    """Decisions, rows of FIELDS, for states and over flags of [detail][channel]."""
    rows, before = [], "n" * len(states[0])
    for number, now in enumerate(states):
        for channel, state in enumerate(now):
            row = {"state": NUMBERS[state], "raised": int(state in "ig" and before[channel] not in "ig")}
            row |= {"over": int(over[number][channel]), "p2p": details[number][channel][0]}
            rows.append(
                row | {"id": channel, "last": int(channel == len(now) - 1), "end": int(number % 3 == 2)}
            )
        before = now
    return rows


@cocotb.test(timeout_time=10, timeout_unit="ms")
@cocotb.parametrize(rises=[True, False])
async def does_what_the_hand_found(dut, rises):
    """Every channel runs the same case, each starting one detail after the channel before it."""
    channels = dut.Channels.value.to_unsigned()
    await begin(dut)
    for case in CASES:
        if "x" in case.masked and not dut.Mask.value.to_unsigned():
            continue
        await apply(dut, case.settings(rises))
        story = case.details(rises)
        count = len(story)
        idle = (0, 100 if rises else 2300, False, False)  # a level far from contact
        details = [
            [story[n - c] if 0 <= n - c < count else idle for c in range(channels)]
            for n in range(count + channels - 1)
        ]
        got = await decisions(dut, details, gap=case.blanked % 2)
        for number, letter in enumerate(case.states):
            for channel in range(channels):
                row = got[(number + channel) * channels + channel]
                p2p, _, _, masked = story[number]
                before = case.states[number - 1] if number else "n"
                raised = letter in "ig" and before not in "ig"
                expected = {
                    "state": NUMBERS[letter],
                    "raised": raised,
                    "over": p2p > 40 and not masked,
                    "p2p": p2p,
                }
                assert expected.items() <= row.items(), f"{case.name}, detail {number} of channel {channel}"
        assert bench.read(dut.blanked_o) == case.blanked * channels, case.name


# Three channels in which a time ends in detail 8: a blank of 2 ends and a slip is raised; a slip's hold of 3
# ends; a release's hold ends. Levels, p2p, states and the number of blanked details.
ENDS = [
    ("pppppPPPPPP", "ooooooooooo", "nnnnnccciii", 2),
    ("PPPPPPPPPPP", "0000o......", "cccciiiiccc", 0),
    ("PPPPLpppppp", "0000ooooooo", "ccccrrrrnnn", 0),
]


@cocotb.test(timeout_time=10, timeout_unit="ms")
@cocotb.parametrize(rises=[True, False])
async def blank_and_holds_end_in_one_detail(dut, rises):
    """Each pair of them in neighbouring channels, ending in the same detail, one before or one after it."""
    channels, levels = dut.Channels.value.to_unsigned(), RISES if rises else FALLS
    await begin(dut)
    far = (0, levels["l"], False, False)
    for first, second, late in itertools.product(range(3), range(3), range(3)):
        await apply(dut, CASES[0].settings(rises) | {"hold": 3, "refractory": 1, "blank": 2})
        chosen = [ENDS[(first, second)[channel % 2]] for channel in range(channels)]
        details = [[far] * channels for _ in range(13)]
        for channel, (level, p2p, _, _) in enumerate(chosen):
            for number, (letter, size) in enumerate(zip(level, p2p)):
                shift = late if channel % 2 else 1
                details[number + shift][channel] = (SIZES[size], levels[letter], False, False)
        got = await decisions(dut, details)
        for channel, (_, _, states, _) in enumerate(chosen):
            shift = late if channel % 2 else 1
            seen = [got[(number + shift) * channels + channel]["state"] for number in range(11)]
            assert seen == [NUMBERS[state] for state in states], (first, second, late, channel)
        assert bench.read(dut.blanked_o) == sum(blanked for *_, blanked in chosen)


@cocotb.test(timeout_time=20, timeout_unit="ms")
@cocotb.parametrize(rises=[True, False])
async def does_what_the_loop_does(dut, rises):
    """Walks over the sizes and levels of the cases; each timer at 0, 1, its longest time and between."""
    channels, draw = dut.Channels.value.to_unsigned(), random.Random(bench.SEED)
    await begin(dut)
    for hold, refractory, blank, keep in ((0, 1, 15, None), (1, 15, 0, 39), (15, 0, 1, 0), (2, 4, 3, 41)):
        settings = CASES[0].settings(rises) | {"hold": hold, "refractory": refractory, "blank": blank}
        settings |= {"keep_threshold": keep} if keep is not None else {}
        await apply(dut, settings)
        loops = [SlipReference(SimpleNamespace(**settings)) for _ in range(channels)]
        details = walk(draw, channels, 400, rises, bool(dut.Mask.value.to_unsigned()))
        states = [[loop.detail(*one) for loop, one in zip(loops, row)] for row in details]
        over = [[p2p > 40 and not masked for p2p, _, _, masked in row] for row in details]
        assert await decisions(dut, details) == expected_of(states, over, details), settings
        assert bench.read(dut.blanked_o) == sum(loop.blanked for loop in loops) > 0


def walk(draw, channels, length, rises, mask):
    """Details [length][channels] with levels and p2p at and around the limits of the cases."""
    levels, rows, level = RISES if rises else FALLS, [], ["l"] * channels
    for _ in range(length):
        moving = draw.random() < 0.1
        level = [draw.choice("QPpmRL") if draw.random() < 0.1 else old for old in level]
        sizes = [draw.choice("0.oGg" if draw.random() < 0.5 else "0.") for _ in level]
        rows.append(
            [
                (SIZES[size], levels[letter], moving, mask and draw.random() < 0.02)
                for size, letter in zip(sizes, level)
            ]
        )
    return rows
