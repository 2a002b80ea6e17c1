"""The budget of a four-wire sensor in words and as a picture."""

from meissner.scenes.drawing import BLUE, GREEN, INK, LINES, ORANGE, PURPLE, lighten, new_figure
from meissner.scenes.results import table


def _percent(value):
    return "none" if value is None else f"{100 * value:.3g}"


def _place(row, name):
    """The value of the worse coordinate."""
    return max(row["x"][name], row["y"][name])


def tell(found):
    """The lines to print, the verdict first."""
    f = found
    gain = f["greatest_gain"]
    lines = []
    if f["needed"]:
        needed = ", ".join(f"{n['bits'] or 'more than 24'} bits at gain {n['gain']}" for n in f["needed"])
        half = _percent(f["half_pitch"])
        lines.append(
            f"at {f['load_n']:g} N, a position error below half a taxel's pitch ({half} %) needs: {needed}"
        )
    lines += [
        f"{f['rows']}×{f['columns']}, r = {f['r_ohm']:g} Ω, R0 = {f['R0_ohm']:g} Ω, V0 = ±{f['V0_v']:g} V, "
        f"k = {f['k_n_ohm']:g} N·Ω: Cx = {f['Cx']:.5g}, Cy = {f['Cy']:.5g}, Kf = {f['Kf_n']:.4g} N",
        f"{f['bits']} bits over ±{f['range_v']:g} V at the electrodes, {f['code_v'] * 1e6:.4g} µV a code; "
        f"differential gain {f['gain']:g}, at most {'any' if gain is None else f'{gain:.4g}'}; "
        f"noise of {f['noise_v'] * 1e6:.4g} µV, in the rms errors",
        f"one point, worst of {f['places']} places; errors of x, y in % of the range from -1 to 1, "
        "of the load in % of the load",
        "",
    ]
    rows = []
    for row in f["loads"]:
        cells = {"load N": f"{row['load_n']:g}", "I·R0 V": f"{row['n_v']:.3g}", "D V": f"{row['d_v']:.3g}"}
        for name, kind in (("one code", "step"), ("greatest", "greatest"), ("rms", "rms")):
            cells[f"x {name}"] = _percent(row["x"][kind])
            cells[f"y {name}"] = _percent(row["y"][kind])
            cells[f"load {name}"] = _percent(row["load"][kind])
        rows.append(cells)
    order = [
        *list(rows[0])[:3],
        *(f"{what} {n}" for what in ("x", "y", "load") for n in ("one code", "greatest", "rms")),
    ]
    lines += table([{key: row[key] for key in order} for row in rows])
    lines += [
        "",
        f"greatest error of the position (the worse coordinate) and of the load at {f['load_n']:g} N, %",
    ]
    rows = {}
    for row in f["sweep"]:
        cells = rows.setdefault(row["bits"], {"bits": row["bits"]})
        cells[f"gain {row['gain']}"] = _percent(_place(row, "greatest"))
    for row in f["sweep"]:
        rows[row["bits"]]["load"] = _percent(row["load"]["greatest"])
    lines += table(list(rows.values()))
    return lines


def draw(file, found):
    """Position over bits by gain; position and load over the load; PNG into the open ``file``."""
    f = found
    size = f"{f['rows']}×{f['columns']}, r = {f['r_ohm']:g} Ω, R0 = {f['R0_ohm']:g} Ω, V0 = ±{f['V0_v']:g} V"
    figure = new_figure(13, 4.8, f"{size}: what the converter resolves")
    bits, over, load = figure.subplots(1, 3)
    gains = list(dict.fromkeys(row["gain"] for row in f["sweep"]))
    for gain, colour in zip(gains, LINES):
        rows = [row for row in f["sweep"] if row["gain"] == gain]
        values = [100 * _place(row, "greatest") for row in rows]
        bits.plot([row["bits"] for row in rows], values, "o-", color=colour, ms=4, label=f"gain {gain}")
    for row, colour in zip(f["loads"], LINES):
        force = row["load_n"]
        rows = [r for r in f["load_sweep"] if r["load_n"] == force and r["greatest"] is not None]
        values = [100 * r["greatest"] for r in rows]
        load.plot([r["bits"] for r in rows], values, "s--", color=colour, ms=4, label=f"{force:g} N")
    at = [row["load_n"] for row in f["loads"]]
    for name, colour in (("greatest", BLUE), ("rms", ORANGE), ("step", GREEN)):
        label = "one code" if name == "step" else name
        over.plot(
            at,
            [100 * _place(row, name) for row in f["loads"]],
            "o-",
            color=colour,
            ms=4,
            label=f"position, {label}",
        )
        known = [
            (row["load_n"], 100 * row["load"][name]) for row in f["loads"] if row["load"][name] is not None
        ]
        if known:
            over.plot(*zip(*known), "s--", color=colour, ms=4, label=f"load, {label}")
    for axis in (bits, over):
        if f["half_pitch"]:
            axis.axhline(100 * f["half_pitch"], color=PURPLE, lw=1, ls=":", label="half a taxel's pitch")
        axis.axhline(100 * 2.0**-16, color=INK, lw=1, ls=":", label="half a step of Q2.14")
    for axis in (bits, load):
        axis.set(xlabel="ADC bits", xticks=sorted({row["bits"] for row in f["sweep"]}))
    bits.set(ylabel="greatest error (% of the range)", title=f"position at {f['load_n']:g} N")
    over.set(xlabel="load (N)", ylabel="error (%)", title=f"{f['bits']} bits, gain {f['gain']:g}")
    load.set(ylabel="greatest error (%)", title="load")
    over.set_xscale("log")
    for axis in (bits, over, load):
        axis.set_yscale("log")
        lighten(axis)
        axis.legend(frameon=False, fontsize=9)
    figure.savefig(file, format="png", dpi=110, facecolor="white")
