"""Extremes of rtl/actuate: commands at their limits, sums of wishes beyond the word, pulses of all widths."""

from extremes.rows import row
from meissner.twins.actuate import grip

TOP = 65535


def step(command, given, wishes, heard, over, faulty, override):
    """The next command after one cycle, by the table of docs/grip.md."""
    working = [wish for wish, bad in zip(wishes, faulty) if not bad]
    wish = (max if given["rule"] == "any" else min)(working, default=0)
    if override is not None:
        goal = override
    elif any(o and not bad for o, bad in zip(over, faulty)):
        goal = min(command + wish, TOP)
    elif all(heard) and not any(over) and not any(faulty):
        goal = max(command - given["decay"], 0)
    else:
        goal = command
    goal = min(max(goal, given["minimum"]), given["maximum"])
    return max(command - given["rate"], min(command + given["rate"], goal))


def in_a_row(given, streak, windows):
    """What ``windows`` windows over add, without their speeds, after ``streak`` others in a row."""
    return sum(given["step"] * 2 ** min(streak + n, given["boost"]) for n in range(windows))


@row("grip", {"": "0"})
def grip_(see):
    axes = {
        "step": [0, 1, TOP],
        "speed_gain": [0, 256, TOP],
        "boost": [0, 1, 7],
        "decay": [0, 1, TOP],
        "minimum": [0, 1, TOP],
        "maximum": [0, TOP - 1, TOP],
        "rate": [0, 1, TOP],
        "watchdog": [1, 2, TOP],
        "rule": ["any", "weakest"],
        "mode": ["position", "force"],
        "period": [16, 2**24 - 1],
    }
    sizes = see.covering(lambda minimum, maximum, **_: minimum <= maximum, fingers=[1, 2, 8], **axes)
    for one in see.some(sizes, 2):
        given = {name: value for name, value in one.items() if name != "fingers"}
        fingers, draw = range(one["fingers"]), see.random
        twin = grip.Grip(grip.GripConfig(**given), len(fingers))
        command, armed = 0, False
        terms, quiet, streaks = ([0] * len(fingers) for _ in range(3))
        for cycle in range(60):
            over = [draw.choice((0, 0, 1, 2, 40)) for _ in fingers] if cycle % 9 else [0 for _ in fingers]
            seen = [max(n, draw.choice((0, 1, 1, 3))) for n in over]
            speeds = [draw.choice((None, 0, 1, 255, 256, TOP)) for _ in fingers]
            well = [draw.random() > 0.05 for _ in fingers]
            override = draw.choice((0, 1, TOP, 30_000)) if cycle % 13 == 5 or not armed else None
            got = twin.next(over, well, seen, speeds, override)
            terms = [0 if v is None else min(given["speed_gain"] * v // 2**8, TOP) for v in speeds]
            steps = [in_a_row(given, streak, n) for n, streak in zip(over, streaks)]
            wishes = [min(added + n * term, TOP) for added, n, term in zip(steps, over, terms)]
            streaks = [0 if some > n else streak + n for some, n, streak in zip(seen, over, streaks)]
            quiet = [0 if n else min(q + 1, TOP) for n, q in zip(seen, quiet)]
            faulty = [q >= given["watchdog"] or not ok for q, ok in zip(quiet, well)]
            before = command
            if armed:
                command = step(
                    command, given, wishes, [n > 0 for n in seen], [n > 0 for n in over], faulty, override
                )
            else:
                goal = given["minimum"] if given["mode"] == "position" else override
                command, before = min(max(goal, given["minimum"]), given["maximum"]), None
            armed = True
            place = f"{one}, cycle {cycle}"
            see.near(got.command, command, place)
            see.near(got.increment, 0 if before is None else command - before, place)
            see.near(bool(got.fault & grip.LIMIT), command >= given["maximum"], place)
            see.same(0 <= got.command <= TOP, True, place)
    sums_of_wishes(see)
    silent(see)
    for name, outside in (
        ("step", TOP + 1),
        ("decay", -1),
        ("rate", TOP + 1),
        ("watchdog", 0),
        ("period", 15),
        ("period", 2**24),
        ("speed_gain", TOP + 1),
        ("boost", 8),
        ("boost", -1),
        ("maximum", 1023),
    ):
        see.refused(grip.GripConfig, **{name: outside})
    for fingers in (0, 9):
        see.refused(grip.Grip, None, fingers)
    see.refused(grip.Grip().report, 0, TOP + 1)


def sums_of_wishes(see):
    """Windows whose wishes sum to just below, exactly and beyond the word's limit, from a command of 0."""
    for by in (1, 32767, 32768, 30_000, TOP):
        for windows in (1, 2, 3, 4, 255):
            for rule in ("any", "weakest"):
                given = grip.GripConfig(step=by, minimum=0, maximum=TOP, rate=TOP, rule=rule)
                got = grip.Grip(given, 2, start=0).next([windows, windows])
                see.near(got.command, min(by * windows, TOP), (by, windows, rule))
    for by, boost, windows in ((1, 7, 8), (1, 7, 255), (257, 7, 8), (258, 7, 8), (TOP, 7, 255)):
        given = grip.GripConfig(step=by, boost=boost, minimum=0, maximum=TOP, rate=TOP)
        wanted = min(by * (255 + 128 * (windows - 8)), TOP)  # 1 + 2 + 4 .. + 128, then 128 each time
        see.near(grip.Grip(given, 1, start=0).next([windows]).command, wanted, (by, boost, windows))
    for speed, gain in ((TOP, TOP), (TOP, 256), (256, TOP), (257, 65281)):
        twin = grip.Grip(
            grip.GripConfig(step=1, speed_gain=gain, minimum=0, maximum=TOP, rate=TOP), 1, start=0
        )
        wanted = min(1 + min(gain * speed // 256, TOP), TOP)
        see.near(twin.next([1], speed=[speed]).command, wanted, (speed, gain))


def silent(see):
    """A finger without decisions: its count stops at 65535, after 1e9 cycles as after 65535; the state is set
    directly.
    """
    twin = grip.Grip(grip.GripConfig(watchdog=TOP, minimum=0), 1, start=500)
    for count in (TOP - 2, TOP - 1, TOP):
        twin._quiet = [count]
        got = twin.cycle()
        see.near(bool(got.fault & grip.SILENT), count + 1 >= TOP, f"{count} cycles before")
        see.near(got.command, 500, f"{count} cycles before")
    for _ in range(3):
        see.near(bool(twin.cycle().fault & grip.SILENT), True, "ever after")
        see.near(twin._quiet[0], TOP, "ever after")
