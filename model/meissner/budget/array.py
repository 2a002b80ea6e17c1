"""The latency of a scanned array, term by term: clock counts of the twins, measured in
tb/sensor/test_array_pins.py.
"""

from contextlib import suppress

from meissner.budget.terms import table
from meissner.builds.settling import Settling
from meissner.physics.front import SOURCE_OHM
from meissner.twins.frontend.adc_spi import PARTS
from meissner.twins.frontend.health import Limits
from meissner.twins.frontend.scan_adc import ScanAdc
from meissner.twins.frontend.scan_demod import ScanDemod
from meissner.twins.sensor.sensors import Array
from meissner.twins.shared import LANES

BUDGET_S = 1e-3
INPUTS = range(1, 9)  # of a converter
NAMES = {
    "scan": "first to last convert start of a frame, as fast as the converters are",
    "settle": "longer waits between them, until a row has settled",
    "burst": "carrier samples at the last place, after the first one",
    "convert": "the last conversion, at its longest",
    "transfer": "transfer of its words over the pins",
    "demod": "amplitude of the last taxel",
    "buffer": "into row-major order",
    "health": "mask of taxels that cannot be trusted",
    "tare": "zero of each taxel",
    "calibrate, cop": "force, sums and division",
}


def part_of(name):
    """The converter of that name; ValueError lists the known ones."""
    parts = {part.name: part for part in PARTS.values()}
    if name.lower() not in parts:
        raise ValueError(f"adc = '{name}' must be one of: {', '.join(parts)}")
    return parts[name.lower()]


def lanes_of(part, channels):
    """Data lines of a converter: two if it has them and each is used. With more the samples come earlier, but
    a slot that waits for the inputs to settle is no shorter."""
    return 2 if part.max_lanes > 1 and channels > 4 else 1


def scan_of(
    rows,
    columns,
    part,
    clk_khz,
    converters,
    channels=None,
    sclk_khz=None,
    carrier=None,
    adc_lanes=None,
    read_during=False,
):
    """The scan of such an array; ``carrier``: arguments of ScanDemod, or None for taxels read without a
    carrier, through ``channels`` inputs of each converter on ``adc_lanes`` lines, None: as ``lanes_of``;
    ``read_during``: the next conversion."""
    if read_during and not part.has_busy:
        raise ValueError(f"read = during must be after for the {part.name}, which has no BUSY")
    if carrier is not None:
        if adc_lanes not in (None, 1):
            raise ValueError(f"adc-lanes = {adc_lanes} must be 1 with a carrier")
        return ScanDemod(rows, columns, converters, part, clk_khz, sclk_khz, **carrier)
    adc_lanes = lanes_of(part, channels) if adc_lanes is None else adc_lanes
    return ScanAdc(
        rows, columns, converters, part, channels, adc_lanes, clk_khz, sclk_khz, read_during=read_during
    )


def terms(array, settle, **given):
    """({name: clocks} that add up to ``total``, the steps of array.latency(), which have the same total)."""
    steps = array.latency(settle, **given)
    places = steps["frame"] // steps["slot"]
    waits = (places - 1) * (steps["slot"] - array.scan.scan.slot(0))
    found = {"scan": steps["last_convert"] - waits, "settle": waits}
    if "burst" in steps:
        last = steps["last_beat"] - steps["last_convert"] - steps["burst"] - steps["transfer"] - steps["out"]
        found |= {"burst": steps["burst"], "transfer": steps["transfer"], "demod": last}
    else:
        last = steps["last_beat"] - steps["last_convert"] - steps["convert"] - steps["out"]
        found |= {"convert": steps["convert"], "transfer": last}
    found |= {"buffer": steps["out"], "health": steps["health"], "tare": steps["tare"]}
    return found | {"calibrate, cop": steps["cop"]}, steps


def budget(
    rows,
    columns,
    clock_hz,
    part,
    converters=None,
    settle_us=None,
    channels=None,
    sclk_khz=None,
    carrier=None,
    health=True,
    tare=True,
    bits_per_clock=2,
    adc_lanes=None,
    settle_share=None,
    volts=None,
    source_ohm=SOURCE_OHM,
    read_during=False,
):
    """The latency of the array as a dict. ``converters`` None: the fewest with which a frame meets BUDGET_S,
    else 8; ``channels`` None: the number of inputs of each that takes the least time, the fewest on a tie.
    ``settle_us`` None: as long as it takes until no more than ``settle_share`` (None: half a code) of the old
    row remains at converters of ``volts`` full scale (None: any), 1 us at least; with a carrier 1 us.

    ValueError if it cannot be built.
    """
    if not 1e6 <= clock_hz <= 2e8 or clock_hz % 1e3:
        raise ValueError(f"clock = {clock_hz:g} must be whole kilohertz from 1e6 to 2e8 Hz")
    if converters is not None and converters not in LANES:
        raise ValueError(f"converters = {converters} must lie in 1 .. {LANES[-1]}")
    if settle_us is not None and not 0 <= settle_us <= 1000:
        raise ValueError(f"settle-us = {settle_us:g} must lie in 0 .. 1000")

    def found(lanes):
        if channels is not None or carrier is not None:
            return found_with(lanes, channels)
        # An input without a column still costs its conversion; some numbers cannot be built.
        every, why = [], None
        for count in INPUTS:
            try:
                every.append(found_with(lanes, count))
            except ValueError as problem:
                why = problem
        if not every:
            raise why
        return min(every, key=lambda found: found["total_clocks"])

    def found_with(lanes, channels):
        sizes = rows, columns, part, round(clock_hz / 1e3), lanes, channels, sclk_khz
        scan = scan_of(*sizes, carrier, adc_lanes, read_during)
        array = Array(scan, Limits() if health else None, {} if tare else None, bits_per_clock=bits_per_clock)
        settling = Settling(scan, volts, settle_share, source_ohm)
        settle = settling.clocks(1.0 if carrier is not None and settle_us is None else settle_us)
        if settle > 65535:
            us = settle / clock_hz * 1e6
            raise ValueError(f"settle-us = {us:g} is {settle} clocks, more than the 65535 of its register")
        return measured(array, settling, settle, clock_hz, lanes, channels)

    if converters is not None:
        return found(converters) | {"converters_needed": needed(found)}
    best = needed(found)
    return found(best or LANES[-1]) | {"converters_needed": best}


def measured(array, settling, settle, clock_hz, converters, channels):
    """The latency of ``array``, whose rows settle for ``settle`` clocks; ``settling``: what they need."""
    clocks, steps = terms(array, settle)
    total, part = sum(clocks.values()), array.scan.part
    assert total == steps["total"]
    left_of = zip(settling.paths, settling.left(settle))
    return {
        "rows": array.rows,
        "columns": array.columns,
        "adc": part.name,
        "converters": converters,
        "read_during": getattr(array.scan, "read_during", False),
        "channels": channels,
        "clock_hz": clock_hz,
        "settle_clocks": settle,
        "terms_clocks": clocks,
        "compute_clocks": steps["compute"],
        "total_clocks": total,
        "total_s": total / clock_hz,
        "slot_clocks": steps["slot"],
        "frame_clocks": steps["frame"],
        "frames_per_second": clock_hz / steps["frame"],
        "within_1_ms": total / clock_hz <= BUDGET_S,
        "old_row": [{"path": path.about, "left": left} for path, left in left_of],
        "settled": not settling.short(settle),
        "settling": settling.told(settle),
    }


def of_config(config):
    """The budget of a build of an array: meissner.builds.build.Config."""
    adc, clock_hz = config.adc, 1e3 * config.clk_khz
    limits, zeros = Limits() if config.health else None, {} if config.tare else None
    bits = {"bits_per_clock": config.cop_bits}
    array = Array(config.scan, limits, zeros, row_column=config.array.gains == "row_column", **bits)
    found = measured(array, config.settling, config.settle_clocks, clock_hz, adc.converters, adc.channels)
    names = "settle_us channels sclk_khz settle_share volts source_ohm"
    given = {name: getattr(adc, name) for name in names.split()}
    given |= {"health": config.array.health, "tare": config.array.tare, "adc_lanes": adc.lanes} | bits
    least = budget(*config.shape, clock_hz, config.part, **given, read_during=config.scan.read_during)
    return found | {"config": config.name, "converters_needed": least["converters_needed"]}


def of_parts(rows, columns, clock_hz, **given):
    """{part: its budget with the fewest converters that reach 1 ms, else with the most}; those that cannot be
    built, and why, in place of a budget."""
    found = {}
    for part in PARTS.values():
        try:
            found[part.name] = budget(rows, columns, clock_hz, part, **given)
        except ValueError as problem:
            found[part.name] = str(problem)
    return found


def tell_parts(found):
    """A line for each part: settle time, converters, latency and frame rate."""
    lines = [f"{'part':12} {'settle us':>9} {'converters':>10} {'inputs':>6} {'total us':>9} {'frames/s':>8}"]
    for name, one in found.items():
        if isinstance(one, str):
            lines.append(f"{name.upper():12} {one}")
            continue
        settle_us, total_us = 1e6 * one["settle_clocks"] / one["clock_hz"], 1e6 * one["total_s"]
        lines.append(
            f"{name.upper():12} {settle_us:9.2f} {one['converters']:10} {one['channels'] or '':>6} "
            f"{total_us:9.1f} {one['frames_per_second']:8.1f}"
            + ("" if one["within_1_ms"] else "  above 1 ms")
            + ("" if one["settled"] else "  not settled: of the digital side only")
        )
    return lines


def needed(found):
    """The fewest converters with which ``found`` meets the budget, or None; some numbers cannot be built."""
    for lanes in LANES:
        with suppress(ValueError):
            if found(lanes)["within_1_ms"]:
                return lanes
    return None


def tell(found):
    """The lines to print, the verdict first."""
    clock_us = 1e6 / found["clock_hz"]
    kind = f"{found['converters']} {found['adc'].upper()}" + ("s" if found["converters"] > 1 else "")
    if found["channels"] is not None:
        kind += f" with {found['channels']} input{'s' * (found['channels'] > 1)} used"
    kind += ", read during the next conversion" * found["read_during"]
    total, needs = found["total_clocks"], found["converters_needed"]
    verdict = f"from first convert to CoP {total * clock_us:.3f} us, "
    verdict += "within 1 ms" if found["within_1_ms"] else "above 1 ms"
    if needs is None:
        verdict += "; no number of these converters reaches 1 ms: "
        verdict += "scan a smaller array or take a faster part"
    elif needs != found["converters"]:
        verdict += f"; 1 ms needs {needs} of these converters"
    told = found["settling"]
    if not found["settled"]:
        verdict += "; of the digital side only"
        told = f"warning: {told}"
    return [
        verdict,
        f"{found['rows']}×{found['columns']} taxels, {kind}, {found['clock_hz'] / 1e6:g} MHz, "
        f"settle {found['settle_clocks']} clocks",
        told,
        "",
        *table(found, NAMES, "from first convert to CoP"),
        "",
        f"{found['frames_per_second']:.1f} frames/s, {found['slot_clocks']} clocks a place; computed within "
        f"{found['compute_clocks']} clocks of the last sample, the same in every frame",
    ]
