"""``meissner process``: one part of the core over recorded samples."""

import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np

from meissner import calibration, engines, files, pool, readers
from meissner.terminal import plain, sides

PIECE = 1 << 19  # samples of frames or electrodes that a thread takes at a time
RATE_ERROR = 0.01  # between a recording and its configuration


def _timed(arguments, run, x, piece, first, shared=()):
    """(``run`` of ``x``, written to the output; seconds taken), after it is built and warm by ``first``.

    ``x`` is taken in pieces of ``piece`` along its first axis, whose results do not depend on each other;
    those named in ``shared`` are the same for all. Threads suffice for several cores, because an engine's
    work is outside Python; the pieces, and so the results, do not depend on their number.
    """
    jobs = pool.number(arguments.jobs)
    pieces = [x[start : start + piece] for start in range(0, len(x), piece)]
    with files.results(arguments.out) as save:
        run(first)
        began = time.perf_counter()
        workers = ThreadPoolExecutor(jobs)
        try:
            found = list(workers.map(run, pieces))
        finally:
            workers.shutdown(cancel_futures=True)
        result = {
            name: array if name in shared else np.concatenate([part[name] for part in found])
            for name, array in found[0].items()
        }
        taken = time.perf_counter() - began
        save(result)
    return result, taken


def array_of(arguments):
    """(converter, shape) of the array that --config names, or (None, None)."""
    from meissner.builds import config

    if arguments.config is None:
        return None, None
    build = config.load(arguments.config)
    if build.array is None:
        raise ValueError(f"{arguments.config}: kind = '{build.kind}' is no array")
    if arguments.shape not in (None, build.shape):
        raise ValueError(
            f"--shape is {sides(arguments.shape)} and {arguments.config} has {sides(build.shape)} taxels: "
            "omit --shape"
        )
    return (None if arguments.volts_per_code is not None else build.input), build.shape


def calibrate(arguments):
    """``meissner calibrate``."""
    calibration.command(arguments, *array_of(arguments))


def build_of(name):
    """A build with a slip path, by its name or file."""
    from meissner.builds import config

    found = config.load(name)
    if found.slip is None:
        raise ValueError(f"{name}: kind = '{found.kind}' has no [slip]")
    return found


def rate_of(recording, build, name):
    """Samples per second, of the recording or of the build; ValueError if they are not the same."""
    if recording.rate_hz is None:
        if build is None:
            raise ValueError(f"{recording.said}; its rate is not known: give it with --rate")
        return build.rate_hz, f"; {build.rate_hz:g} Hz by {name}"
    if build is not None and abs(recording.rate_hz - build.rate_hz) > RATE_ERROR * build.rate_hz:
        raise ValueError(
            f"{recording.said}; {name} has {build.rate_hz:g} Hz: windows and times would mean something "
            "else. Change rate_hz, or give --rate if the recording's rate is another"
        )
    return recording.rate_hz, ""


def samples(arguments, path=None, build=None, calibrated=None):
    """(samples [channels, samples] of the slip path, samples per second, what was taken).

    ``build``: its converter turns volts into codes; the slip path of an array takes forces: newtons, whole
    numbers, or codes with ``calibrated``, the Calibration that turns them into forces.
    """
    array = build is not None and build.array is not None
    shape = build.shape if array and calibrated is not None and arguments.shape is None else arguments.shape
    found = readers.of_command(arguments, path, shape=shape)
    count = len(found.values) if found.values.ndim == 2 else 1
    most = None if build is None else build.shape[0] * build.shape[1]
    if most is not None and count > most:
        raise ValueError(
            f"{found.path} has {count} channels, {', '.join(found.names[:8])}, and "
            f"{arguments.config} {most}: choose with --column"
        )
    rate_hz, told = rate_of(found, build, arguments.config)
    per_code = arguments.volts_per_code
    if array and calibrated is None:
        if found.unit == "V":
            raise ValueError(
                f"{found.path} is in volts; the slip path of an array takes forces: give --calibration"
            )
        if found.unit == "N":
            per_code = build.units.newtons_per_code
            found, told = replace(found, unit="V"), f"{told}; newtons to forces of {per_code:g} N"
            codes = found.flat().scaled(per_code)[0]
        else:
            codes, done = found.flat().scaled()
            told += f"; {done.replace('codes', 'forces')}"
    else:
        converter = None if build is None or per_code is not None else build.input
        codes, done = (found if calibrated is not None else found.flat()).scaled(per_code, converter)
        told += f"; {done}"
        if calibrated is not None:
            codes = calibration.check_codes(codes, calibrated.offset.shape)
            codes = engines.calibrate(codes, calibrated, arguments.engine)
            codes, told = codes.reshape(len(codes), -1).T, f"{told}; calibrated to forces"
    return engines.check_samples(codes), rate_hz, plain(f"{found.said}{told}")


def settings(arguments, build, needed=True):
    """The SlipConfig of the build, or of the arguments; ``needed``: without a build there is a threshold."""
    from meissner.twins.slip.config import SlipConfig

    names = ("threshold", "window", "hop", "level")
    given = {name: getattr(arguments, name, None) for name in names}
    given = {name: value for name, value in given.items() if value is not None}
    if build is not None:
        if given:
            raise ValueError(f"{next(iter(given))} is in {arguments.config}: omit --{next(iter(given))}")
        return build.slip
    if needed and "threshold" not in given:
        raise ValueError("there is no threshold: give --threshold, or --config with its [slip]")
    return SlipConfig(**{"hop": given.get("window", SlipConfig.window)} | given)


def slip(arguments):
    """``meissner process slip``."""
    if arguments.rate is not None and not 0 < arguments.rate < float("inf"):
        raise ValueError(f"rate = {arguments.rate:g} must be a number of samples per second above 0")
    build = None if arguments.config is None else build_of(arguments.config)
    config = settings(arguments, build)
    engines.load(arguments.engine)
    calibrated = None
    if arguments.calibration is not None:
        if build is None or build.array is None:
            raise ValueError("--calibration goes with --config of an array, whose slip path takes forces")
        calibrated = calibration.load(arguments.calibration)
    x, rate_hz, said = samples(arguments, build=build, calibrated=calibrated)
    run = lambda x: engines.process_slip(x, config, arguments.engine, states=build is not None)
    result, taken = _timed(arguments, run, x, 1, x[:1, : config.window], ["window_end"])
    channels, windows = result["slip"].shape
    fired = result["fired_at"][result["slip"]]
    first = lambda at: f"first at {int(at.min()) / rate_hz:.4f} s" if len(at) else "none"
    print(said)
    flags = ""
    if build is not None:
        raised = result["raised_at"][result["raised_at"] >= 0]
        flags = (
            f"{len(raised)} flag{'s' * (len(raised) != 1)} raised by the rules of [slip] ({first(raised)}), "
        )
    print(
        f"{channels} channel{'s' * (channels > 1)}, {windows} windows, {flags}{int(result['slip'].sum())} "
        "slips "
        f"({first(fired)}); {x.size / taken:.3g} samples/s on engine {arguments.engine}; "
        f"{plain(arguments.out)}"
    )


def cop(arguments):
    """``meissner process cop``."""
    if arguments.min_load < 0:
        raise ValueError(f"min-load = {arguments.min_load} must not be negative")
    lines = None
    if arguments.calibration is not None:
        lines = calibration.load(arguments.calibration)
        engines.load(arguments.engine)
    converter, shape = array_of(arguments)
    found = readers.of_command(arguments, shape=arguments.shape or shape)
    values, done = found.scaled(arguments.volts_per_code, converter)
    if lines is None:
        forces = engines.check_forces(values)
    else:
        forces = calibration.check_codes(values, lines.offset.shape)

    def run(x):
        found = engines.process_cop(x, arguments.engine, arguments.min_load, lines)
        return found if lines is None else found | {"load_n": lines.load_n(x, found["sum"])}

    result, taken = _timed(arguments, run, forces, max(1, PIECE // forces[0].size), forces[:1])
    frames, rows, columns = forces.shape
    print(plain(f"{found.said}; {done}"))
    print(
        f"{frames} frame{'s' * (frames > 1)} of {rows}×{columns}, {int(result['valid'].sum())} with a load; "
        f"{'' if lines is None else f'sum in units of {lines.force_lsb_n:g} N; '}"
        f"{forces.size / taken:.3g} samples/s on engine {arguments.engine}; {plain(arguments.out)}"
    )


class _Electrodes:
    """The converter behind the amplifiers of E1 to E4, as Recording.scaled takes it."""

    def __init__(self, config):
        self.config, adc = config, config.adc
        self.low_v, self.high_v = adc.low_v / config.gain, adc.high_v / config.gain
        self.min_code, self.max_code = adc.min_code, adc.max_code

    def convert(self, volts):
        return (each.T for each in self.config.converted(volts.T))


def cop4(arguments):
    """``meissner process cop4``."""
    from meissner.builds import cop4_file
    from meissner.twins.cop.cop4 import faults

    engines.load(arguments.engine)
    config = cop4_file.load(arguments.config)
    found = readers.of_command(arguments, samples_first=True)
    if found.values.ndim != 2 or len(found.values) != 4:
        engines.check_electrodes(found.values.T, config.adc.bits)
    codes, done = found.scaled(arguments.volts_per_code, _Electrodes(config))
    codes = engines.check_electrodes(codes.T, config.adc.bits)
    run = lambda x: engines.process_cop4(x, config, arguments.engine)
    result, taken = _timed(arguments, run, codes, PIECE // 4, codes[:1])
    saturated, imbalance, opened = (int((flag > 0).sum()) for flag in faults(codes, config.registers))
    print(plain(f"{found.said}; {done}"))
    print(
        f"{len(codes)} sample{'s' * (len(codes) > 1)}, {int(result['valid'].sum())} with a load; faults: "
        f"{saturated} saturated, {opened} open, {imbalance} out of balance; "
        f"load in units of {config.load_lsb_n:g} N; "
        f"{len(codes) / taken:.3g} samples/s on engine {arguments.engine}; {plain(arguments.out)}"
    )
