"""The points available for a sensor's needs, and each as the tables of a configuration.

A candidate is a row of sweep. Its tables are those of the named configuration nearest to the sensor, with the
settings that the point decides replaced.
"""

import copy
import math
import tomllib

from meissner.budget import array
from meissner.builds import boards, config
from meissner.builds.build import line_bytes
from meissner.builds.keys import PARTS
from meissner.builds.settling import Settling
from meissner.physics.adc import PARTS as RANGES
from meissner.tradeoff import worker
from meissner.tradeoff.axes import cop4, lanes
from meissner.tradeoff.axes.slip import HOPS, PART_MV
from meissner.tradeoff.sweep import figure_of
from meissner.tradeoff.table import named
from meissner.twins.frontend.scan_adc import ScanAdc
from meissner.twins.link import packet

# Converters by their bits over 0 to 5 V; the AD7606 and AD7606C-16 have 16 bits over ±5 V.
OF_BITS = {
    8: ("MAX11123",),
    10: ("MAX11124",),
    12: ("MCP3208", "MAX11125", "MAX11131"),
    15: ("AD7606", "AD7606C-16"),
}
MARGIN = 0.95  # share of the fastest frame rate


def board_of(name):
    """The Board of that name, None for None; ValueError lists the known ones."""
    if name is None:
        return None
    every = boards.BOARDS | {boards.ARTY.name: boards.ARTY}
    if name not in every:
        raise ValueError(f"there is no board '{name}'; the boards are: {', '.join(every)}")
    return every[name]


def part_of(name):
    if name is not None and name.upper() not in PARTS:
        raise ValueError(f"adc = '{name}' must be one of: {', '.join(PARTS)}")
    return name and name.upper()


def base_of(needs):
    """The named configuration that a configuration for these needs starts from."""
    if needs.sensor == "array":
        small = (needs.rows or 64) * (needs.columns or 64) <= 64
        return "fingertip" if small else "array64"
    return {"channels": "slip1", "electrodes": "cop4"}[needs.sensor]


def tables_of(name):
    return tomllib.loads((config.FOLDER / f"{name}.toml").read_text("utf-8"))


def clock_mhz(needs):
    """The board's clock for that kind of configuration, or else the configuration's own."""
    base, board = base_of(needs), board_of(needs.board)
    own = tables_of(base)["clock"]["mhz"]
    return board.changes(base).get("mhz", own) if board else own


def _channels(needs, results):
    for row in results.get("slip", {"points": []})["points"]:
        point = row["point"]
        if point["noise_mv"] == PART_MV and needs.window in (None, point["window"]):
            for part in OF_BITS.get(point["bits"], ()):
                if needs.adc in (None, part):
                    yield row | {"part": part}


def _electrodes(needs, _):
    """Four wires: their converter is symmetric about 0 V; the core takes no amplified differences."""
    axis, rows = named("cop4"), needs.rows or 7
    if rows != (needs.columns or 7):
        raise ValueError("the axis cop4 has only square meshes: rows and columns must be equal")
    if needs.adc not in (None, "AD7606"):
        raise ValueError(
            f"adc = '{needs.adc}' must be AD7606: four wires need a converter symmetric about 0 V"
        )
    bits = RANGES["AD7606"].bits
    for R0_ohm in axis.values["R0_ohm"]:
        point = {"side": rows, "r_ohm": needs.r_ohm or 100.0, "R0_ohm": R0_ohm, "bits": bits}
        point |= {"noise_mv": cop4.PART_MV, "gain": 1}
        if not cop4.legal(point):
            raise ValueError(f"a mesh of {rows}×{rows} with r = {point['r_ohm']:g} ohms cannot be solved")
        yield {"point": point, **worker.measured(axis, point), "part": "AD7606"}


def _array(needs, _):
    axis, base = named("lanes"), tables_of(base_of(needs))
    own = {"settle_share": needs.settle_share, "health": base["array"]["health"]}
    own |= {"bits_per_clock": config.load(base_of(needs)).cop_bits}
    for part in PARTS if needs.adc is None else (needs.adc,):
        own["settle_us"] = _settle_us(needs, base["adc"], PARTS[part])
        for converters in axis.values["converters"]:
            for inputs in range(1, 9):
                point = {"adc": part.lower(), "clock_mhz": clock_mhz(needs), "side": needs.rows or 64}
                point |= {"columns": needs.columns or 64, "converters": converters, "inputs": inputs} | own
                if lanes.legal(point):
                    yield {"point": point, **worker.measured(axis, point), "part": part}


def _settle_us(needs, adc, part):
    """The settle time of the base's table ``adc`` if it is enough for ``part``, else None."""
    scan = ScanAdc(part=part, clk_khz=round(1000 * clock_mhz(needs)))
    settling, given_us = Settling(scan, share=needs.settle_share), adc.get("settle_us")
    return None if given_us is None or settling.short(settling.clocks(given_us)) else given_us


ROWS = {"channels": _channels, "electrodes": _electrodes, "array": _array}
AXIS = {"channels": "slip", "electrodes": "cop4", "array": "lanes"}
# Sort keys of candidates: cost first, then error, then delay. The fewest converters, as in `meissner budget`.
PRICE = {
    "channels": ("kbit_s", "state_bits", "wrong", "delay_ms"),
    "electrodes": ("power_mw", "position"),
    "array": ("converters", "switched", "pins", "us_taxel"),
}
ERROR = {"channels": "wrong", "electrodes": "position", "array": None}
LATENCY = {"channels": ("delay_ms", 1.0), "electrodes": (None, 1.0), "array": ("latency_us", 1e-3)}


def candidates(needs, results):
    """Rows with the key "part", the cheapest first; ValueError if there are none."""
    found = list(ROWS[needs.sensor](needs, results))
    if not found:
        with_adc = f" with adc = {needs.adc}" if needs.adc else ""
        with_adc += f" with a window of {needs.window} samples" if needs.window else ""
        raise ValueError(
            f"there is no measured point for {needs.sensor}{with_adc}; `meissner tradeoff` measures points"
        )
    keys = PRICE[needs.sensor]
    order = lambda row: [float("inf") if (value := figure_of(row, key)) is None else value for key in keys]
    return sorted(found, key=lambda row: (order(row), list(PARTS).index(row["part"])))


def tables(needs, row):
    """{table: {key: value}} of the configuration with the row's point."""
    found, point = copy.deepcopy(tables_of(base_of(needs))), row["point"]
    found["clock"]["mhz"] = float(clock_mhz(needs))
    board = board_of(needs.board)
    if board and "registers" in (own := board.changes(base_of(needs))):
        found["link"]["registers"] = own["registers"]
    adc = found["adc"] | {"part": row["part"]}
    if needs.sensor == "channels":
        count = needs.channels or 1
        step = 1 << point["level"]
        hop = HOPS[point["kind"]](point["window"], step)
        found["sensor"]["channels"] = count
        adc["rate_hz"] = float(point["rate_hz"])
        found["slip"] |= {"window": point["window"], "hop": hop, "level": point["level"]}
        found["slip"]["serial"] = count == 1 and point["kind"] == "tumbling" and point["bits"] <= 12
    elif needs.sensor == "electrodes":
        found["mesh"] |= {"rows": point["side"], "columns": point["side"]}
        found["mesh"] |= {"r_ohm": point["r_ohm"], "R0_ohm": point["R0_ohm"]}
    else:
        found["sensor"] |= {"rows": point["side"], "columns": point["columns"]}
        adc |= {"converters": point["converters"], "channels": point["inputs"]}
        adc |= {key: point[key] for key in ("settle_us", "settle_share")}
        adc = {key: value for key, value in adc.items() if value is not None}
        adc["lanes"] = array.lanes_of(PARTS[row["part"]], point["inputs"])
        line = frames_on_line(found["link"]["baud"], point["side"], point["columns"])
        adc["rate_hz"] = rounded_rate(min(MARGIN * row["error"]["frames_s"], line))
        detail_ms = math.ceil(2000 / adc["rate_hz"])  # a time that is not 0 lasts a detail at least
        times = {key: found["slip"][key] for key in ("hold_ms", "refractory_ms", "blank_ms")}
        found["slip"] |= {key: max(float(detail_ms), ms) for key, ms in times.items()}
    found["adc"] = adc
    found["about"] = f"chosen by meissner choose: {needs.sensor} on {row['part']}"
    return found


def frames_on_line(baud, rows, columns):
    """Centres of pressure a second that a line carries besides one image."""
    image = sum(map(line_bytes, packet.image_chunks(0, [0] * (rows * columns))))
    return (baud / 10 - image) / line_bytes(packet.cop_frame(0, 0, 0, 0))


def rounded_rate(rate):
    """``rate`` rounded down to two significant digits."""
    if rate < 10:
        return math.floor(10 * rate) / 10  # rate // 0.1 is 95 for 9.6
    size = 10 ** (len(str(int(rate))) - 2)
    return float(rate // size * size)
