"""The words of a report: the meaning of each key of a summary or its tables, and the unit of its value.

A new key needs one line in ``WORDS``. Without it the report shows the key itself and the unit that its
ending names, and tb/physics/test_report.py fails.
"""

from typing import NamedTuple

from meissner import interval


class Words(NamedTuple):
    """``scale``: factor from the value to the shown number; ``none``: the text for a missing value."""

    label: str
    unit: str = ""
    scale: float = 1.0
    none: str = "none"


def _share(label):
    return Words(label, "%", 100.0)


def _ms(label):
    return Words(label, "ms", 1e3)


ENGINES = {
    "float": "float: floating-point reference",
    "fixed": "fixed: integer twins of the core",
    "rtl": "rtl: the core itself, simulated",
    "gate": "gate: the synthesised netlist, simulated",
}

# Keys that are words.
_PLAIN = (
    *("scene", "engine", "modelled", "left_out", "runs", "condition", "seeds", "clocks", "dropped", "frames"),
    *("rows", "columns", "radius", "k1", "n", "constant", "value", "published", "circuit", "shape", "column"),
    "false_alarms",
)
WORDS = {
    **{key: Words(key.replace("_", " ")) for key in _PLAIN},
    # every scene
    "seed": Words("first seed"),
    "files": Words("files of the run"),
    "seconds_simulated": Words("simulated time", "s"),
    "seconds_taken": Words("time taken", "s"),
    "samples_per_second": Words("samples through the engine per second"),
    "twin_mismatches": Words(
        "differences between core and integer twin", none="not compared: this engine does not run the core"
    ),
    "built": Words("modelled of the core"),
    "not_built": Words("left out of the core"),
    # slip; single times are those of the shown run; onset: the first partial slip, or the start of the pull
    "onset_s": Words("onset (truth), shown run", "s"),
    "crossing_s": Words("reference window crosses the threshold, shown run", "s"),
    "flag_s": Words("slip flag rises, shown run", "s"),
    "delay_s": _ms("from onset to flag, shown run"),
    "gross_s": Words("whole contact slips (truth), shown run", "s"),
    "missed": Words("slips missed"),
    "late": Words("of these flagged late, after the whole contact slipped"),
    "false_alarms_masked": Words("false alarms of a core that knows its own motion"),
    "missed_rate": Words("slips missed", none="nothing slips"),
    "false_alarm_rate": Words("runs with a false alarm"),
    "missed_interval": Words("slips missed, 95 % interval", "%"),
    "false_alarm_interval": Words("runs with a false alarm, 95 % interval", "%"),
    "contact_share_of_sliding": _share("share of sliding time in which the state is not slip"),
    "contact_wrong_share": _share("time in which state and truth disagree on contact"),
    "delay_ms_median": Words("delay, median", "ms"),
    "delay_ms_mean": Words("delay, mean", "ms"),
    "delay_ms_max": Words("delay, longest", "ms"),
    "detector_ms_max": Words("detector's part of the delay, longest", "ms"),
    "lead_ms_median": Words("lead before the whole contact slips, median", "ms"),
    "lead_ms_min": Words("lead before the whole contact slips, shortest", "ms"),
    "adc": Words("converter"),
    "clk_khz": Words("clock", "MHz", 1e-3),
    "convert_jitter_clocks": Words("jitter of convert start", "clocks"),
    "decision_clocks": Words("convert start to decision, longest", "clocks"),
    "decision_us": Words("convert start to decision, longest", "µs"),
    "decision_jitter_clocks": Words("jitter of the decision", "clocks"),
    # slip from four wires
    "direction_deg": Words("reported direction of slip, shown run", "°"),
    "direction_error_deg": Words("error of the direction", "°"),
    "direction_error_deg_max": Words("error of the direction, largest", "°"),
    "octants_wrong": Words("directions in the wrong octant"),
    "load_drop": _share("fall of the load output before the object moves"),
    "grip_rise_n": Words("rise of the grip force meanwhile (truth)", "N"),
    "move_v": Words("move of the position output meanwhile", "V"),
    # results of the core's shear estimator
    "estimate_mm_s": Words("speed by the core's estimator, mean", "mm/s"),
    "estimate_error": _share("error of the core's speeds"),
    "estimate_missed": Words("shears for which the core gives no speed"),
    "estimate_beyond": Words("shears above the limit that the core flags"),
    "estimates_outside": Words("windows with a speed where nothing is sheared"),
    # a hand in closed loop
    "dropped_rate": Words("dropped"),
    "dropped_interval": Words("dropped, 95 % interval", "%"),
    "grip_ratio_mean": Words("grip over the least that friction allows, mean of the hold"),
    "grip_ratio_max": Words("grip over the least, largest of all runs"),
    "runs_above_ratio": Words("runs that hold with more than 1.2 times the least grip"),
    "tug_ratio_mean": Words("grip in the second after a tug over the least at its peak, mean"),
    "tug_ratio_min": Words("the same, smallest of all runs"),
    "moved_mm_max": Words("displacement of the object, largest", "mm"),
    "sag_mm_max": Words("elastic sag, largest", "mm"),
    "ring_mm_max": Words("displacement by slipped rings, largest", "mm"),
    "slip_mm_mean": Words("slip, mean", "mm"),
    "slip_mm_max": Words("slip, largest", "mm"),
    "tightenings": Words("cycles with a tightening"),
    "false_tightenings": Words("of these without an event"),
    "cycles_with_fault": Words("cycles with a reported fault"),
    # centre of pressure
    "position_error": _share("error of the position, of the range −1 to 1"),
    "load_error": _share("error of the load"),
    "position_error_maximum": _share("error of the position, largest"),
    "position_error_mean": _share("error of the position, mean"),
    "load_error_maximum": _share("error of the load, largest"),
    "load_error_mean": _share("error of the load, mean"),
    "load_error_without_shear": _share("error of the load, against the load that the sheared rubber shows"),
    "load_error_without_lag": _share("error of the load, without the rubber's lag"),
    "position_error_of_working_cells": _share("error of the position, against the forces on working cells"),
    "load_error_second_order": _share("error of the load, with the second-order term on the host"),
    "load_error_of_working_cells": _share("error of the load, against the forces on working cells"),
    "response_s": _ms("until 95 % of the load is reported"),
    "position_response_s": _ms("until the position settles to within 5 % of its travel"),
    "below_min_load": Words("frames whose load is too small for a position"),
    "over_range": Words("samples above the converter's range"),
    "r_ohm": Words("resistor between taxels", "Ω"),
    "total_n": Words("total load", "N"),
    "position": Words("bound of the position's error, of the range"),
    "load": Words("bound of the load's error, of the load"),
    "centre_x": Words("centre, x"),
    "centre_y": Words("centre, y"),
    "deviation": Words("deviation of the radius"),
    "roundness": _share("out of round"),
    # sheared rubber
    "rest_v": Words("Vc at rest, Vi", "V"),
    "step_v": Words("step of Vc, dV", "V"),
    "deviation_v": Words("deviation of repeated steps", "V", none="one measurement each"),
    "moved_mm": Words("shear", "mm"),
    "speed_mm_s": Words("speed of shear", "mm/s"),
    "back_mm_s": Words("speed that the published line gives for dV", "mm/s"),
    "table_1_v": Words("dV of Table 1", "V"),
    "table_2_v": Words("dV of Table 2", "V"),
    "slope_v_mm": Words("dV over the distance: slope of the straight line", "V/mm"),
    "slope_error_v_mm": Words("standard error of that slope", "V/mm"),
    "k0": Words("k0 of dV = (k0 + k1·Vi)·v^n", "V"),
    "residual": _share("residuals of dV, rms"),
    "off_table_1": _share("dV beside Table 1"),
    "off_table_2": _share("dV beside Table 2"),
    "speed_error": _share("error of the speed of one step"),
    "beyond_found": Words(
        "steps above the limit of 3 mm/s that are found above it", "steps", none="none is above it"
    ),
    "beyond_falsely": Words("steps up to the limit found above it", "steps"),
    "after_v": Words("Vc 5 s after the shear", "V"),
    "restored_after_v": Words("Vc 5 s after the shear, if restored", "V"),
    "converged_after_v": Words("Vc 5 s after the shear, if it converges", "V"),
    "converged_table_1_after_v": Words("the same, of Table 1's lot", "V"),
    "end_v": Words("Vc at the end", "V"),
    "settled_s": Words("until 95 % of the fall after the shear", "s"),
    "published_v": Words("published", "V"),
    "off_v": Words("difference", "V"),
    "change_lead_ms_min": Words("first sharp change of Vc before the slip, shortest lead", "ms"),
    "slope_lead_ms_min": Words("derivative of Vc over its threshold before the slip, shortest lead", "ms"),
    "slope_missed": Words("slips missed by the derivative"),
    "slope_missed_rate": Words("slips missed by the derivative"),
    "slope_quiet_rate": Words("runs in which the derivative crosses at rest or in even shear"),
    "slope_pressing_rate": Words("runs in which the derivative crosses while pressing"),
    "stick_slips": Words("stick-slips of a run"),
    "stick_slips_mean": Words("stick-slips of a run, mean"),
    "stick_slips_found": Words("stick-slips that the derivative detects", "stick-slips"),
    "stick_slips_found_share": _share("stick-slips that the derivative detects"),
    "elsewhere_per_s": Words("false crossings of the derivative, per second of sliding"),
    "rms_before_v_s": Words("derivative before the slip, rms", "V/s"),
    "rms_sliding_v_s": Words("derivative while sliding, rms", "V/s"),
    # cells
    "dead": Words("cells found dead"),
    "dead_found": Words("broken cells found dead", "cells", none="no cell is broken"),
    "dead_falsely": Words("working cells found dead", "cells"),
    "dead_as_injected": Words("dead cells are those injected"),
    "unevenness_before": _share("even press, cell farthest from the mean: before calibration"),
    "unevenness_after": _share("even press, cell farthest from the mean: calibrated"),
    "unevenness_codes_as_they_are": _share("even press, cell farthest from the mean: codes as they are"),
    "unevenness_calibrated_by_probe": _share("even press, cell farthest from the mean: by a probe"),
    "unselected": Words("unselected rows"),
    "ghost": _share("ghost in an unpressed cell, of the largest reading"),
    "pressed_spread": _share("spread of the pressed cells"),
    "load_g": Words("load", "g"),
    "reported_g": Words("reported load", "g"),
    "second_order_g": Words("load with the second-order term", "g"),
    "largest_cell_g": Words("largest cell", "g"),
    "ideal_v": Words("ideal output", "V"),
    "difference_from_eq18_v": Words("largest difference between demodulated output and eq. 18", "mV", 1e3),
    "unselected_pf": Words("unselected cells", "pF"),
    "output_v": Words("output", "V"),
    "low_by": _share("output low by"),
    "low_by_with_lagging_gain": _share("output low by, gain lagging by 90°"),
    "gain_for_10_percent": Words("gain for an output 10 % low"),
    "gain_for_5_percent": Words("gain for an output 5 % low"),
    "gain_for_1_percent": Words("gain for an output 1 % low"),
    "noise_g": Words("noise, rms", "g"),
    "unloading_above_loading_g": Words("unloading reads above loading by", "g"),
    "off_the_line_g": Words("largest departure of the mean cycle from its own straight line", "g"),
    "low_at_full_g": Words("calibrated reading low at the top of the cycles by", "g"),
    "low_settled_g": Words("the same, force settled", "g"),
    "settled_off_g": Words("settled presses, largest error", "g"),
    "settled_off_second_order_g": Words("the same with the second-order term", "g"),
    "low_at_full_second_order_g": Words("low at the top of the cycles with the second-order term", "g"),
    "reads_0_below_g": Words("forces that read 0, below", "g"),
    "sag_of_hold": _share("reading of a held force rises by"),
    "left_after_release_g": Words("reading left at the release, above the reading at rest", "g"),
    "left_after_rest_g": Words("reading left after the rest, above the reading at rest", "g"),
    "calibration_residual_g": Words("residual of the calibration", "g"),
    "press_g": Words("press", "g"),
    "mean_g": Words("mean reading", "g"),
    "off_share": _share("error of the mean reading"),
    "off_share_second_order": _share("the same with the second-order term"),
    "deviation_g": Words("standard deviation", "g"),
    "of_the_mean": _share("standard deviation, of the mean"),
    "peaks_apart_mm": Words("distance between peaks, mean", "mm"),
    "peaks_apart_from_mm": Words("distance between peaks, smallest", "mm"),
    "peaks_apart_to_mm": Words("distance between peaks, largest", "mm"),
    "neighbour_at_a_centre": _share("neighbour's reading with the probe over a cell's centre"),
    "centre_mm": Words("cell's centre", "mm"),
    "peak_mm": Words("peak", "mm"),
    "height_g": Words("height of the peak", "g"),
    "width_at_half_mm": Words("width at half the height", "mm"),
    # a rope in the grip
    "sections": Words("pulls"),
    "pulls": Words("pulls"),
    "quiet_sections": Words("pulls without slip"),
    "slipping_sections": Words("pulls that slip"),
    "errors": Words("of these with an alarm"),
    "apart_steps": Words("first alarm from the load cell's slip, mean", "steps"),
    "apart_ms": Words("first alarm from the load cell's slip, mean", "ms"),
    "apart_ms_deviation": Words("the same, standard deviation", "ms"),
    "trees": Words("trees of the forest"),
    "trained_on": Words("pulls that it was trained on"),
    "below": Words("differences of sensor 1 below −15 codes in a pull, mean"),
    "below_least": Words("the same, fewest"),
    "below_most": Words("the same, most"),
    "below_mean": Words("their mean", "codes"),
    "period_steps": Words("between two of them, median", "steps"),
    "oscillation": Words("differences of sensor 1 while it slips, rms", "codes"),
    "s_8_range": Words("range of sensor 8 in a pull", "codes"),
    "s_3_rises": Words("rise of sensor 3", "codes"),
    "x_moves": Words("move of x in a pull, mean"),
    "x_falls": Words("pulls in which x falls"),
    "y_moves": Words("move of y in a pull, mean"),
    "y_rises": Words("pulls in which y rises"),
    "y_left": Words("move of y from the first rest to the last"),
    "y_follows": _share("move of the reported y, of the rope's"),
    # tactile pins under a finger
    "drive_hz": Words("drive frequency", "Hz"),
    "above_db": Words("from above", "dB re 1 µm"),
    "below_db": Words("from below", "dB re 1 µm"),
    "fit_error_db": Words("from above at 230 Hz, less the published 22.2 dB", "dB"),
    "apart_db": Words("from above less from below, mean", "dB"),
    "correlation": Words("correlation of above and below"),
    "single_low_db": Words("a single peak at 230 Hz can read low by", "dB"),
    "frequency_error_hz": Words("drive frequency off the setting by", "Hz"),
    "conclusion_1": Words("SA-I and FA-I are reached up to 20 Hz, at 30 V and more"),
    "conclusion_2": Words("SA-II is never reached"),
    "conclusion_3": Words("FA-II is above its plotted curve from 120 Hz on, at every voltage"),
    "conclusion_4": Words("FA-II is never reached with the area of the tip"),
    "smallest_reached": Words("FA-II with 0.008 cm², highest voltage: reached at", "Hz"),
    "lowest_hz": Words("least displacement of every voltage at", "Hz", none="not the same frequency"),
    "less_than_free_db": Words("less than the free pin by at least", "dB"),
    "less_slow_db": Words("the same up to 20 Hz, at most", "dB"),
    "less_fast_db": Words("the same from 100 Hz on, at least", "dB"),
    "gained_slow_db": Words(
        "from the lowest to the highest voltage, up to 20 Hz: more than in proportion by", "dB"
    ),
    "gained_fast_db": Words("the same from 100 Hz on", "dB"),
    "spread_db": Words("spread of the pins", "dB"),
    "volts": Words("drive", "V"),
    **{f"at_{hz}_hz_db": Words(f"at {hz} Hz", "dB re 1 µm") for hz in (1, 20, 150, 230)},
    **{name: Words(f"{name} reached at", "Hz") for name in ("SA-I", "SA-II", "FA-I")},
    "FA-II": Words("FA-II reached, plotted curve, at", "Hz"),
    "FA-II smallest": Words("FA-II reached, 0.008 cm², at", "Hz"),
    "FA-II tip": Words("FA-II reached, the tip's area, at", "Hz"),
    "out_um": Words("out in each burst by", "µm"),
    "out_db": Words("out in each burst by", "dB re 1 µm"),
    "back_um": Words("left after each burst", "µm"),
    "ripple_um": Words("230 Hz on top, peak", "µm"),
    "ripple_db": Words("230 Hz on top, peak", "dB re 1 µm"),
    "felt_hz": Words("frequency of the bursts", "Hz"),
    "felt_by": Words("channels that feel it"),
    "ours": Words("ours"),
    "error": Words("ours less published"),
    "pins_on": Words("pins that are on"),
    "pins_wrong": Words("pins that are not as the image has them"),
    "pins_felt": Words("pins at which SA-I responds"),
    "on_felt": _share("responds at pins that are on"),
    "changes_felt": _share("responds at pins that change"),
    "rest_felt": _share("responds at pins that stay off"),
    "pin_on_in_steps": Words("pin of row 3, column 5 is on in steps"),
    "step_ms": Words("step of the letter", "ms"),
    "characters_min": Words("characters a minute"),
    "words_min": Words("words a minute"),
    "summed_pins": Words("pins at once that would reach FA-II if it summed the tips' areas"),
    "image_correlation": Words("correlation of the pins' levels with the forces"),
    "slip_ms": Words("slip flag", "ms", none="no flag"),
    "pin_delay_ms": Words("from the slip flag to the pins", "ms", none="never"),
    "cue_deg": Words("the pins' stripes move to", "°", none="nowhere"),
    "cue_error_deg": Words("off the direction of the pull", "°"),
}
# Headings of columns in at most two words, where the words above are more.
SHORT = {
    **{"missed": "missed", "late": "late", "false_alarms_masked": "masked alarms"},
    **{"missed_interval": "missed interval", "false_alarm_interval": "alarm interval"},
    **{"contact_share_of_sliding": "sliding unseen", "contact_wrong_share": "contact wrong"},
    **{"delay_ms_median": "delay median", "delay_ms_mean": "delay mean", "delay_ms_max": "delay longest"},
    **{
        "detector_ms_max": "detector longest",
        "lead_ms_median": "lead median",
        "lead_ms_min": "lead shortest",
    },
    **{"convert_jitter_clocks": "convert jitter", "decision_clocks": "decision longest"},
    **{"decision_us": "decision longest", "decision_jitter_clocks": "decision jitter"},
    **{
        "direction_error_deg_max": "direction error",
        "octants_wrong": "octants wrong",
        "load_drop": "load drop",
    },
    **{
        "estimate_mm_s": "estimated speed",
        "estimate_error": "estimate error",
        "estimate_missed": "no estimate",
    },
    **{"estimate_beyond": "over limit", "estimates_outside": "false estimates"},
    **{"grip_ratio_mean": "grip mean", "grip_ratio_max": "grip largest", "runs_above_ratio": "above 1.2"},
    **{
        "tug_ratio_mean": "tug mean",
        "tug_ratio_min": "tug smallest",
        "moved_mm_max": "moved",
        "sag_mm_max": "sag",
    },
    **{"ring_mm_max": "ring slip", "slip_mm_mean": "slip mean", "slip_mm_max": "slip largest"},
    **{"tightenings": "tightenings", "false_tightenings": "false ones", "cycles_with_fault": "fault cycles"},
    **{"dropped_interval": "dropped interval", "load_error_without_shear": "load unsheared"},
    **{
        "position_error": "position error",
        "load_error": "load error",
        "load_error_without_lag": "load unlagged",
    },
    **{"position_error_maximum": "position largest", "position_error_mean": "position mean"},
    **{"load_error_maximum": "load largest", "load_error_mean": "load mean", "response_s": "load response"},
    **{"position_response_s": "position response", "below_min_load": "too light", "over_range": "over range"},
    **{"r_ohm": "resistor", "position": "position bound", "load": "load bound", "deviation": "deviation"},
    **{"rest_v": "Vi", "step_v": "dV", "deviation_v": "dV deviation", "speed_mm_s": "speed"},
    **{"back_mm_s": "line's speed", "table_1_v": "Table 1", "table_2_v": "Table 2", "slope_v_mm": "slope"},
    **{"slope_error_v_mm": "slope error", "k0": "k0", "residual": "residual", "off_table_1": "beside 1"},
    **{"off_table_2": "beside 2", "speed_error": "speed error", "beyond_found": "found above"},
    **{"beyond_falsely": "falsely above", "after_v": "Vc after", "restored_after_v": "if restored"},
    **{"converged_after_v": "if converged", "converged_table_1_after_v": "Table 1's", "end_v": "Vc end"},
    **{"settled_s": "settled", "change_lead_ms_min": "change lead", "slope_lead_ms_min": "slope lead"},
    **{
        "slope_missed": "slope missed",
        "slope_missed_rate": "slope missed",
        "slope_quiet_rate": "crosses quiet",
    },
    **{
        "slope_pressing_rate": "crosses pressing",
        "stick_slips": "stick-slips",
        "stick_slips_mean": "stick-slips",
    },
    **{
        "stick_slips_found": "found",
        "stick_slips_found_share": "found",
        "elsewhere_per_s": "false crossings",
    },
    **{"rms_before_v_s": "rms before", "rms_sliding_v_s": "rms sliding", "dead_found": "dead found"},
    **{"dead_falsely": "falsely dead", "ghost": "ghost", "pressed_spread": "pressed spread"},
    **{"second_order_g": "second order", "difference_from_eq18_v": "off eq.18", "low_by": "low by"},
    **{"low_by_with_lagging_gain": "low lagging", "gain_for_10_percent": "gain 10 %"},
    **{"gain_for_5_percent": "gain 5 %", "gain_for_1_percent": "gain 1 %", "noise_g": "noise"},
    **{"unloading_above_loading_g": "hysteresis", "off_the_line_g": "off line", "low_at_full_g": "low full"},
    **{"low_settled_g": "low settled", "settled_off_g": "settled error", "reads_0_below_g": "reads 0"},
    **{"settled_off_second_order_g": "settled 2nd", "low_at_full_second_order_g": "full 2nd"},
    **{
        "sag_of_hold": "hold rises",
        "left_after_release_g": "left released",
        "left_after_rest_g": "left rested",
    },
    **{
        "calibration_residual_g": "residual",
        "mean_g": "mean",
        "off_share": "error",
        "deviation_g": "deviation",
    },
    **{"off_share_second_order": "error 2nd", "of_the_mean": "deviation", "peaks_apart_mm": "peaks apart"},
    **{"peaks_apart_from_mm": "apart least", "peaks_apart_to_mm": "apart most"},
    **{
        "roundness": "roundness",
        "neighbour_at_a_centre": "neighbour",
        "width_at_half_mm": "width",
        "height_g": "height",
    },
    **{"quiet_sections": "quiet pulls", "slipping_sections": "slipping pulls", "errors": "with alarm"},
    **{"apart_steps": "alarm apart", "apart_ms": "alarm apart", "apart_ms_deviation": "apart deviation"},
    **{"trees": "trees", "trained_on": "trained on", "below": "below −15", "below_least": "fewest"},
    **{
        "below_most": "most",
        "below_mean": "their mean",
        "period_steps": "period",
        "oscillation": "oscillation",
    },
    **{"s_8_range": "s8 range", "s_3_rises": "s3 rise", "x_moves": "x moves", "x_falls": "x falls"},
    **{"y_moves": "y moves", "y_rises": "y rises", "y_left": "y left", "y_follows": "y follows"},
    **{"unevenness_before": "before", "unevenness_after": "calibrated"},
    **{"unevenness_codes_as_they_are": "codes uneven", "unevenness_calibrated_by_probe": "probe uneven"},
    **{f"at_{hz}_hz_db": f"{hz} Hz" for hz in (1, 20, 150, 230)},
    **{name: name for name in ("SA-I", "SA-II", "FA-I", "FA-II", "FA-II smallest", "FA-II tip")},
    **{"pins_on": "pins on", "on_felt": "on felt", "changes_felt": "changes felt", "rest_felt": "off felt"},
    "error": "error",
}
# "condition" is a number among the solver's bounds, a name in a slip table.
SOLVER_CONDITION = Words("condition number, at most")

_ENDINGS = {
    **{unit: unit for unit in ("s", "ms", "mm", "g", "clocks")},
    **{"us": "µs", "n": "N", "v": "V", "deg": "°", "pf": "pF", "ohm": "Ω", "hz": "Hz"},
}


# Keys of a row with the ends of a rate's interval.
INTERVALS = ("missed_interval", "false_alarm_interval", "dropped_interval")


def words(key, value=None):
    """The Words of a key; without an entry, the key itself with the unit that its ending names."""
    key = str(key)
    if key == "condition" and isinstance(value, (int, float)):
        return SOLVER_CONDITION
    if key in WORDS:
        return WORDS[key]
    rest, _, ending = key.rpartition("_")
    if rest and ending in _ENDINGS:
        return Words(rest.replace("_", " "), _ENDINGS[ending])
    return Words(key.replace("_", " "))


def number(value):
    """A number to four significant digits; integers and 1000 or more without decimals."""
    if isinstance(value, int) or abs(value) >= 1000:
        return f"{value:,.0f}"
    return f"{value:.4g}"


def cell(key, value):
    """A value without its unit, for a table whose heading has the unit."""
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, (int, float)):
        _, unit, scale, _ = words(key, value)
        if unit == "s":  # instants of one run: readers compare them, so keep four decimals
            return f"{value:,.4f}".rstrip("0").rstrip(".")
        return number(value if scale == 1 else value * scale)
    if key in INTERVALS:
        return interval.ends(*value).replace(" ", "\N{NO-BREAK SPACE}")
    return str(value)


def heading(key, value=None):
    """What a column holds; ``value``: one of its values."""
    label, unit = words(key, value)[:2]
    return f"{label} ({unit})" if unit else label


def column(key, value=None):
    """The heading of a column in at most two words, and its unit."""
    label, unit = words(key, value)[:2]
    label = "condition number" if words(key, value) is SOLVER_CONDITION else SHORT.get(key, label)
    return f"{label} ({unit})" if unit else label


def fact(key, value):
    """A value with its unit, for the list of facts."""
    meaning = words(key, value)
    if value is None:
        return meaning.none
    if isinstance(value, dict) and "low" in value:
        return interval.words(value, meaning.unit or "runs")
    if isinstance(value, dict):
        return f"{fact(key, value['mean'])} in the mean, {fact(key, value['maximum'])} at most"
    if isinstance(value, (list, tuple)) and key != "seeds":
        return ", ".join(map(str, value)) or "nothing"
    if key == "engine":
        return ENGINES.get(value, str(value))
    if key == "seed":
        return str(value)
    if key == "seeds":
        return f"{value[0]} to {value[1]}" if value[0] != value[1] else str(value[0])
    space = "" if meaning.unit == "°" else " "
    return cell(key, value) + (space + meaning.unit if meaning.unit else "")
