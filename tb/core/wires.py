"""Wires and glue between the blocks inside msn_core, as tb/core/test_core.py checks them. An end is
"<block>.<port>", with the test's short name of the block, or a port of the core itself; "[high:low]" selects
bits. "cfg.<setting>" and "status.<name>" are members of the structs that the registers give and get."""

from cocotb.handle import HierarchyArrayObject, HierarchyObject

import bench
import members
from meissner.twins.link.registers import settings

# Modules below the core whose ports tests see, and one signal: bench.run makes them visible.
SEEN = """acquire adc_spi bridge cobs cop4 cop_accumulate cop_slip electrodes frame_filter frame_gate
classify.written classify.label classify.best
classify.decisions classify.changes classify.missed classify.absent classify.late classify.broken
frame_owed frame_owed.owed grip actuate.commands actuate.tightenings shear_speeds.last shear_speeds.pairs
shear_speeds.windows health.dead_count health.railed_count health.blinking_count image_store link packet
packet_slip registers scan.lost scan_buffer scan_plan sensor_array sensor_channels skid slip
slip_chain.offered slip_changes slip_flags slip_path slip_serial sync *.cfg_*i tare.tared_count
tare.refused_count tare.swallowed_count time_stamp uart_tx"""
SEEN = tuple(f"msn_{name}" for name in SEEN.split())

# The struct of each of these ends, and where it is.
STRUCTS = {
    **{"cfg": ("cfg", "registers.cfg_o"), "status": ("status", "registers.status_i")},
    **{"sensed": ("status", "array.status_o"), "told": ("link_status", "link.status_o")},
    "change": ("change", "sender.in_i"),
    **{"decision": ("decision", "link.decision_i"), "cop": ("cop", "link.cop_i")},
}

# The state that a decision of msn_cop_slip stands for.
COP_STATE = lambda v: 2 if v("cop_slip.out_slip_o") else v("cop_slip.out_pressed_o")

# By the block that needs the wires: from, to, and the names that replace {} in both. "~": sign-extended.
WIRES = {
    "array": [
        ("registers.cfg_o", "array.cfg_i"),
        ("sensed.scan_{}", "status.scan_{}", "dropped overrun held lost"),
        ("sensed.health_{}", "status.health_{}", "dead railed blinking"),
        (
            "sensed.tare_{}",
            "status.tare_{}",
            "tared refused swallowed state_pressed state_taring state_loading",
        ),
        ("sensed.calibrate_swapping", "status.calibrate_swapping"),
        ("sensed.cop_damaged", "status.cop_damaged"),
        ("array.health_{}_o", "link.health_{}_i", "valid"),
        ("array.health_o", "link.health_i"),
        ("link.health_ready_o", "array.health_ready_i"),
        ("array.cop_valid_o", "link.cop_valid_i"),
        ("array.cop_o", "link.cop_i"),
        ("array.sample_data_o[15:0]", "link.image_data_i"),
        ("array.sample_last_o", "link.image_last_i"),
        ("array.sample_valid_o", "skid.in_valid_i"),
        ("array.sample_data_o", "skid.in_data_i[23:7]"),
        ("array.sample_id_o", "skid.in_data_i[6:2]"),
        ("array.sample_last_o", "skid.in_data_i[1:1]"),
        ("array.sample_mask_o", "skid.in_data_i[0:0]"),
        ("skid.in_ready_o", "array.sample_ready_i"),
        ("skid.out_valid_o", "slip.in_valid_i"),
        ("skid.out_data_o[23:7]", "slip.in_data_i"),
        ("skid.out_data_o[6:2]", "slip.in_id_i"),
        ("skid.out_data_o[1:1]", "slip.in_last_i"),
        ("skid.out_data_o[0:0]", "slip.in_mask_i"),
        ("slip.in_ready_o", "skid.out_ready_i"),
        ("array.time_o", "link.time_i"),
        ("now", "array.now_i"),
        ("array.commit_o", "registers.commit_i"),
        ("array.adc_{}_o", "adc_{}_o", "cs_n sclk mosi convst reset"),
        ("array.{}_o", "{}_o", "row group"),
    ],
    "acquire": [
        ("acquire.{}_o", "status.adc_{}", "dropped overrun timeout mistagged over_range"),
        ("acquire.adc_{}_o", "adc_{}_o", "cs_n sclk mosi convst reset"),
    ],
    "gate": [
        ("acquire.out_{}_o", "gate.in_{}_i", "valid last"),
        ("acquire.out_{}_o", "time.{}_i", "valid last"),
        ("gate.in_ready_o", "acquire.out_ready_i"),
        ("gate.in_ready_o", "time.ready_i"),
        ("acquire.{}_o", "time.{}_i", "convert read"),
        ("now", "time.now_i"),
        ("time.time_o", "link.time_i"),
    ],
    "electrodes": [
        ("gate.out_valid_o", "electrodes.in_valid_i"),
        ("electrodes.in_ready_o", "gate.out_ready_i"),
        ("acquire.out_{}_o", "electrodes.in_{}_i", "data id last"),
        ("electrodes.out_{}_o", "cop4.in_{}_i", "valid e1 e2 e3 e4"),
        ("cop4.in_ready_o", "electrodes.out_ready_i"),
        ("cop4.out_{}_o", "cop_slip.in_{}_i", "valid x y load pressed"),
        ("cop_slip.in_ready_o", "cop4.out_ready_i"),
        ("~cop4.out_{}_o", "cop.{}", "x y"),
        ("cop4.out_{}_o", "cop.{}", "load pressed"),
        ("cop_slip.out_octant_o", "decision.p2p"),
        ("cop_slip.out_valid_o", "link.decision_valid_i"),
        ("cop_slip.out_raised_o", "decision.raised"),
        ("link.decision_ready_o", "cop_slip.out_ready_i"),
        ("gate.commit_o", "registers.commit_i"),
        ("gate.out_first_o", "owed.first_i"),
        ("owed.busy_o", "gate.busy_i"),
    ],
    "slip": [
        ("slip.{}_o", "status.slip_{}", "damaged blanked"),
        ("slip.out_{}_o", "flags.in_{}_i", "state last"),
        ("actuator_moving_i", "moving.in_data_i"),
        ("moving.out_data_o", "slip.actuator_moving_i"),
    ],
    "channels": [
        ("gate.out_valid_o", "slip.in_valid_i"),
        ("slip.in_ready_o", "gate.out_ready_i"),
        ("acquire.out_{}_o", "slip.in_{}_i", "data id last"),
        ("gate.commit_o", "registers.commit_i"),
    ],
    "events": [
        ("slip.out_{}_o", "decision.{}", "raised last id state p2p"),
        ("slip.out_valid_o", "link.decision_valid_i"),
        ("link.decision_ready_o", "slip.out_ready_i"),
    ],
    "link": [
        ("link.bus_{}_o", "registers.bus_{}_i", "valid write address wdata strobe"),
        ("registers.bus_{}_o", "link.bus_{}_i", "done error rdata"),
        ("told.{}", "status.link_{}", "packets cop_dropped image_dropped rejected changes_lost"),
        ("link.now_o", "now"),
        ("bus_{}_i", "link.host_{}_i", "valid write address wdata strobe"),
        ("link.host_{}_o", "bus_{}_o", "done error rdata"),
        ("out_ready_i", "link.out_ready_i"),
        ("link.out_{}_o", "out_{}_o", "valid data last"),
        ("rx_i", "link.rx_i"),
        ("link.tx_o", "tx_o"),
    ],
    "flags": [("flags.{}_o", "{}_o", "slip gross touched")],
    "sender": [
        ("acquire.out_valid_o", "slip.in_valid_i"),
        ("slip.in_ready_o", "acquire.out_ready_i"),
        ("acquire.out_{}_o", "slip.in_{}_i", "data id last"),
        ("acquire.convert_o", "sender.convert_i"),
        ("slip.out_valid_o", "changes.in_valid_i"),
        ("changes.in_ready_o", "slip.out_ready_i"),
        ("changes.out_valid_o", "sender.in_valid_i"),
        ("changes.out_o", "sender.in_i"),
        ("sender.in_ready_o", "changes.out_ready_i"),
        ("sender.room_o", "changes.room_i"),
        ("slip.out_raised_o", "change.start"),
        ("slip.out_{}_o", "change.{}", "state p2p"),
        ("sender.out_{}_o", "cobs.in_{}_i", "begin valid data last"),
        ("cobs.in_ready_o", "sender.out_ready_i"),
        ("cobs.out_{}_o", "uart.in_{}_i", "valid data"),
        ("uart.in_ready_o", "cobs.out_ready_i"),
        ("uart.tx_o", "tx_o"),
    ],
}


# Logic rather than wires, for one lane, 3 rows and 7 columns: each input, and its function of the values
# ``v`` of other ends.
GLUE = {
    "array": {
        "array.pending_i": lambda v: v("registers.pending_o"),
        "array.busy_i": lambda v: v("skid.out_valid_o") or v("slip.busy_o"),
        "link.image_valid_i": lambda v: (
            v("cfg.link_images") and v("array.sample_valid_o") and v("skid.in_ready_o")
        ),
    },
    "gate": {"gate.pending_i": lambda v: v("gate.out_valid_o") or v("registers.pending_o")},
    "channels": {"gate.busy_i": lambda v: v("slip.in_valid_i") or v("slip.busy_o")},
    "electrodes": {
        "owed.taken_i": lambda v: v("gate.out_valid_o") and v("gate.out_ready_i"),
        "owed.quiet_i": lambda v: (
            not (v("electrodes.out_valid_o") or v("cop4.out_valid_o") or v("cop_slip.out_valid_o"))
        ),
        "owed.drop_i": lambda v: 0,
        "decision.state": COP_STATE,
        "decision.id": lambda v: 0xFFFF,
        "link.cop_valid_i": lambda v: v("cop4.out_valid_o") and v("cop_slip.in_ready_o"),
        "flags.in_valid_i": lambda v: v("cop_slip.out_valid_o") and not v("chain.offered"),
        "flags.in_state_i": COP_STATE,
        "flags.in_last_i": lambda v: 1,
    },
    "slip": {"flags.in_valid_i": lambda v: v("slip.out_valid_o") and not v("chain.offered")},
}

# The group of an instance with a port cfg_<setting>_i, or with the struct cfg_i of its group; "core": of all.
INSTANCES = {
    "core": "u_registers u_sensor u_channels u_forces",
    "adc": "u_acquire u_adc_spi",
    "slip": "u_slip u_slip_path",
    "scan": "u_scan_adc u_scan u_plan",
    "health": "u_health u_taxel",
    "tare": "u_tare",
    "calibrate": "u_calibrate u_table",
    "cop": "u_cop u_divide",
    "cop4": "u_cop4",
    "cop_slip": "u_cop_slip",
    "grip": "u_actuate u_grip u_finger_health u_pwm",
    "shear_speed": "u_shear_speeds u_shear_speed",
    "forest": "u_classify",
    "display": "u_display u_render u_pins u_phase u_limits",
    "link": "u_link",
}
GROUP_OF = {instance: group for group, instances in INSTANCES.items() for instance in instances.split()}
# Ports with another name than their setting.
NAMED = {f"u_{one}.cfg_scale_i": f"cop4.{k}.value" for one, k in (("x", "kx"), ("y", "ky"), ("load", "kf"))}
NAMED["u_changes.cfg_events_i"] = [
    f"link.events.{state}" for state in ("none", "contact", "incipient", "gross", "release")
]
NAMED["u_cop4.cfg_p_i"] = [f"cop4.p{n}.value" for n in range(6)]  # p0 lowest
# Blocks that use the struct's members themselves, and settings that glue uses: other tests show their effect.
READERS = ("u_health", "u_tare", "u_calibrate", "u_classify")
OF_GLUE = ["core.scratch.value", "core.hold.value", "link.images.value", "grip.enable.value"]
OF_GLUE += [f"shear_speed.{name}.value" for name in ("enable", "hold", "hold_cycles", "select")]
OF_GLUE += [f"display.{name}.value" for name in ("source", "octant", "health")]
OF_GLUE += [f"display.levels.{name}" for name in ("next", "last")]


def below(handle, path=()):
    """(names of the instances above, port) of every visible port cfg_... below ``handle``."""
    for child in handle:
        if isinstance(child, HierarchyObject | HierarchyArrayObject):
            yield from below(child, (*path, child._name))
        elif child._name.startswith("cfg_"):
            yield path, child


def consumers(dut):
    """[(port, lowest bit, bits, setting, whether it is used there)] of every place in the core where a
    setting arrives, "group.register.field"; AssertionError for a port that none of the tables above knows."""
    found = []
    for path, port in below(dut):
        names = [name for name in path if name.startswith("u_")]
        if "u_scan_adc" in names and names[-1] == "u_adc_spi":
            continue  # driven by the scan
        if names[-1] == "u_limits" and port._name == "cfg_top_i":
            continue  # msn_pin_display holds it to the highest level
        end = f"{names[-1]}.{port._name}"
        assert end in NAMED or names[-1] in GROUP_OF, f"{end} is in no table of core/wires.py"
        group = GROUP_OF.get(names[-1])
        if port._name in ("cfg_i", "cfg_o"):
            every = group == "core"
            places = members.PLACES["cfg" if every else f"{group}_cfg"]
            assert len(port) == sum(bits for _, bits in places.values()), end
            for of, register, field in settings():
                if every or group == of.name:
                    name = f"{of.name}_" * every + members.member(register.name, field.name)
                    setting = f"{of.name}.{register.name}.{field.name}"
                    found.append((port, *places[name], setting, names[-1] in READERS))
        else:
            listed = NAMED.get(end, f"{group}.{port._name[4:-2]}.value")
            listed = [listed] if isinstance(listed, str) else listed
            bits = len(port) // len(listed)
            found += [(port, place * bits, bits, name, True) for place, name in enumerate(listed)]
    return found


def joins(parts):
    """(source, sink, sign-extended) of every wire of a core with ``parts``."""
    for part in parts:
        for source, sink, *names in WIRES.get(part, ()):
            for name in names[0].split() if names else [""]:
                yield source.format(name).lstrip("~"), sink.format(name), source[0] == "~"


class Ends:
    """The values at the ends of wires in ``dut``. ``inside``: short name of a block -> its path."""

    def __init__(self, dut, inside, parts):
        self.dut, self.inside, self.handles, self.places = dut, inside, {}, {}
        self.levels = None  # within a check {id of a signal: its number}, so that a wide struct is read once
        self.wires = list(joins(parts))
        self.glue = [pair for part in parts for pair in GLUE.get(part, {}).items()]

    def knows(self, end):
        """Whether this core has the end."""
        block = end.partition(".")[0]
        return any(block in (a.partition(".")[0], b.partition(".")[0]) for a, b, _ in self.wires)

    def handle(self, end):
        """The signal of an end, without its bit range; for a setting or a status the entire struct."""
        if end not in self.handles:
            kind = end.partition(".")[0]
            block, _, port = STRUCTS.get(kind, (kind, end))[1].rpartition(".")
            found = self.dut
            for name in [*(self.inside[block].split(".") if block else ()), port]:
                found = getattr(found, name)
            self.handles[end] = found
        return self.handles[end]

    def place(self, end):
        """(lowest bit, bits) of an end in its signal."""
        name, _, bits = end.partition("[")
        kind, _, member = name.partition(".")
        low, width = (
            members.PLACES[STRUCTS[kind][0]][member] if kind in STRUCTS else (0, len(self.handle(name)))
        )
        if bits:
            high, lowest = map(int, bits[:-1].split(":"))
            low, width = low + lowest, high - lowest + 1
        return low, width

    def placed(self, end):
        """(signal, lowest bit, bits) of an end."""
        if end not in self.places:
            self.places[end] = self.handle(end.partition("[")[0]), *self.place(end)
        return self.places[end]

    def width(self, end):
        return self.placed(end)[2]

    def __call__(self, end):
        """The value of an end, unsigned."""
        signal, low, width = self.placed(end)
        if self.levels is None:
            number = bench.read(signal)
        else:
            number = self.levels.get(id(signal))
            if number is None:
                number = self.levels[id(signal)] = bench.read(signal)
        return number >> low & (1 << width) - 1

    def check(self):
        """All ends agree now. Of a setting only the block's bits are compared: registers saturate it to
        these."""
        self.levels = {}
        for source, sink, widened in self.wires:
            sent, got = self(source), self(sink)
            if widened:
                top = 1 << self.width(source) - 1
                sent = (sent ^ top) - top
            if widened or source.startswith("cfg."):
                sent &= (1 << self.width(sink)) - 1
            assert got == sent, f"{sink} is {got:x}, but {source} {sent:x}"
        for sink, of in self.glue:
            assert self(sink) == of(self), f"{sink} is {self(sink):x}, not {of(self):x}"
        self.levels = None
