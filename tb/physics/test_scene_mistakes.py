"""Mistakes in scenes: each is refused with one sentence that names the scene's file and the key.

A line is a table of the scene (".": its top) with keys and their bad values, separated by "|"; a key after
"-" is left out. The word that the sentence must hold, where it is not the key, follows in brackets.
"""

import re
import tomllib

import pytest

from meissner import scenes

MISTAKES = {
    "walk_25x5": """
        .: -sensor; sensor = "mesh" (array); world = 5; features = ["slip"]; rate_hz = 0; slip = {}
        .: -converter; -world
        array: rows = 1025; min_load = -1; colums = 5
        converter: bits = 17; full_scale_n = 0
        world: kind = "dance"; seconds = 1e-09; patches = []
        world.patches.0: path = "hop"; profile = "soft"; force_n = -1.0; from = [0, 2]; from = [0]
    """,
    "cop_load": """
        world: kind = "patches"; steps = 0
        mesh: r_ohm = [0] | [nan]; r_ohm = []; V0_v = -15 | 15000; rows = 0
        mesh: R0_ohm = 0 | 1; k_n_ohm = nan | 0.5
        converter: bits = 25; noise_v = -1e-06; gain = 0.4
        .: -converter
        load: min_n = 0; correction = "palm"
        world.points.0: force_n = [0, nan] | [-1, 1]; at = [0.1, 0]
    """,
    "dense_64": "world.patches.2: radius = 1.5",
    "plantar_step": """
        world: trial = 60; dataset = "Feet"
        .: converter = {}
    """,
    "cop_circle": "world: radius = 1.5; steps = 2; force_n = -5.0; cover_radius = inf",
    "cop_six_random": 'world: split = "half"; count = 2000',
    "cop_impulse": "world: pulse_s = 1.0 (pulse); rest_n = -0.1",
    "capacitive_cell": """
        .: features = ["slip"]
        readout: gain = 0; samples_per_period = 5; form = "square"; periods = 65; bits = 18; noise = 1
        world: kind = "dance"; force_g = 200; steps_g = []; presses = 1
    """,
    "capacitive_crosstalk": "world: gains = [0]",
    "capacitive_select": """
        world: cells = 9
        .: -world
    """,
    "capacitive_shapes": 'world: shapes = ["spoon"]; shapes = [] (shape)',
    "fsr_3x3": """
        array: material = "felt"; rows = 0
        readout: circuit = "bridge"; unselected = "open"; load_ohm = 0
        converter: bits = 17
        world: patches = []; seconds = 1e-09
    """,
    "fingertip_cop": """
        .: seeds = 0; -scan; rate_hz = -1; rate_hz = 1 (pull_s)
        array: rows = 4 (rows); material = "felt"
        world: kind = "dance"; pull_s = 0.4; free_s = 0; calibrate_n = 0; trees = 0; pattern = "F"
        conditions.0: rope = "h"; mode = "pull"; values = []; values = [3] (values); values = [3, 4, 5, -1]
        conditions.1: shape = "L"; shore = 99; position = "left"; name = 3
    """,
    "fsr_64x64": """
        faults.0: kind = "lost"; row = 64; column = 1
        faults.1: -column
        .: faults = []
    """,
    "cop_slip": """
        .: seeds = 0; features = ["slip"]; build = "nothing.toml" | "slip1" | 5; -build
        .: mesh = {} (build); converter = {} (build); load = {} (build); cop_slip = {}; rate_hz = 9 (build)
        world: wire_n_mm = 0.0; cover_pitches = -1.0; pulls = []; grips = 5
        world.pulls.0: grip_n = -2.0 | nan; speed_mm_s = 0.0; direction_deg = 400.0; material = "ice"
        world.grips.0: to_n = [-1.0]; to_n = []; ramp_s = 0.0
    """,
    "optacon_free": """
        .: features = ["slip"]; -display
        display: rows = []; rows = [0]; columns = 65; amplitude_bits = 7 | 4 (amplitude_bits); clk_khz = 0
        world: kind = "bound"; volts = 0.0 | 201.0; hz = [0.5]; hz = []; hz = [401.0]
    """,
    "optacon_contact": "world: volts = []; pins = 0; tip_cm2 = 0.0",
    "optacon_burst": "world: burst_s = 0.01; bursts = 0; hz = nan; hz = 9.0 (burst_s)",
    "optacon_letter": """
        display: columns = 6; rows = [6]
        world: words_min = 0.5; hz = 50.0 (words_min)
    """,
    "touch_to_touch": """
        world: pad = "capacitive_cell"; pad = "fsr_3x3"; grip = "acrylic_slip"; shape = "spoon"
        world: pull = "backwards"; frame_ms = 0.1; cue_frames = 0; floor_g = 0.0; step_g = -1.0
        world: press_s = 0.01
    """,
    "acrylic_slip": """
        .: sensors = "rubber"; sensor = "skin"; adc = "MCP"; rate_hz = "fast"; seeds = 0
        .: features = ["slip", "taste"] (taste); -title
        slip: treshold_p2p_v = 0.02; window = 48; threshold_p2p_v = -1.0; contact_level_v = 4.9
        slip: hold_ms = true | 0.1; gross_threshold_p2p_v = 7.07; release_level_v = 5.2
        slip: contact_level_v = -0.1
        world: kind = "twist"; press = 1.0; stage_start_s = 0.4; slide_s = nan; conditions = []
        world.conditions.0: normal_n = -2.0; material = "ice"; mass = 1.0
    """,
    "grip_slip": """
        world.conditions.0: first_event = 0.95; recovers = 1.5; burst = 0.5; hum_v = -1.0; follow = 1.2
        world.conditions.0: hum = 1.0
    """,
    "normal_force": "world.conditions.0: first_event = 0.5",
    "grip_release": """
        .: rate_hz = 12345
        slip: window = 63; threshold_p2p_share = 1.5
        grip: rule = "loudest"; step_mm = 7.0 (step); decay_mm_s = 0.002; least_mm = 6.5 (minimum)
        world.conditions.2: count_mm = 0.0001 (decay_mm_s); count_mm = 0.0002
        world: material = "glass"; grip_ratio = [0.9, 1.2]; tugs = [[1.0, 2.0]]; hold_from_s = 300.0
        world.conditions.0: cycle_ms = 3; first_event = 0.95; heal = 0.1
    """,
    "grip_disturb": """
        grip: decay_mm_s = 0.003; calm_decay_share = 1.1; boost = 8 | 2.0; step_share = 0.2
        grip: calm_share = -0.1; guard_s = 2000.0
    """,
    "shear_speed": """
        world: kind = "press"; -held_s; slope_s = 0.1; speed_mm_s = [0.0] | [] | [300.0]; normal_n = [0.2]
        world: moved_mm = [0.009]; shear_start_s = 0.9
        .: seeds = 0; adc = "X"; features = ["cop"]
    """,
    "shear_recover": """
        world: -ways; ways = [{name = "x", recovers = 1.5, lot = 1, published_v = 2}] (recovers)
        world: ways = [{name = "x", recovers = 0.5, lot = 1, published_v = 2, material = "wood"}] (material)
    """,
    "stick_slip": """
        world: near_s = 0.0; ways = [{name = "x", material = "ice", first_event = 0.5}] (material)
        world: ways = [{name = "x", material = "wood", first_event = 1.0}] (first_event)
    """,
}


def mistaken(name, path, value):
    """The scene's table with another value of one key, or without it if the value is empty."""
    table = at = tomllib.loads(scenes.source(name))
    *path, last = (int(key) if key.isdigit() else key for key in path.removeprefix("..").split("."))
    for key in path:
        at = at[key]
    if value:
        at[last] = tomllib.loads(f"value = {value}")["value"]
    else:
        del at[last]
    return table


@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistyped_scene_gets_one_sentence(name):
    for line in MISTAKES[name].strip().splitlines():
        of, keys = line.strip().split(": ", 1)
        for given in keys.split("; "):
            key, values, word = re.fullmatch(r"-?(\w+)(?: = (.*?))?(?: \((\w+)\))?", given).groups()
            for value in values.split(" | ") if values else [""]:
                with pytest.raises(ValueError) as caught:
                    scenes.build("mine", mistaken(name, f"{of}.{key}", value))
                said = str(caught.value)
                assert re.search(rf"\b{word or key}\b", said), (line, said)
                assert "\n" not in said and said.startswith("scene mine"), said
