"""``meissner process``: one part of the core over recorded samples."""

import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from meissner import calibration, engines, files, pool
from meissner.terminal import plain

PIECE = 1 << 19  # samples of frames or electrodes that a thread takes at a time


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


def slip(arguments):
    """``meissner process slip``."""
    from meissner.twins.slip.config import SlipConfig

    if not 0 < arguments.rate < float("inf"):
        raise ValueError(f"rate = {arguments.rate:g} must be a number of samples per second above 0")
    config = SlipConfig(
        window=arguments.window,
        hop=arguments.window if arguments.hop is None else arguments.hop,
        level=arguments.level,
        threshold=arguments.threshold,
    )
    x = engines.check_samples(files.read_array(arguments.input))
    engines.load(arguments.engine)
    run = lambda x: engines.process_slip(x, config, arguments.engine)
    result, taken = _timed(arguments, run, x, 1, x[:1, : config.window], ["window_end"])
    channels, windows = result["slip"].shape
    fired = result["fired_at"][result["slip"]]
    first = f"first at {int(fired.min()) / arguments.rate:.4f} s" if len(fired) else "none"
    print(
        f"{channels} channel{'s' * (channels > 1)}, {windows} windows, {int(result['slip'].sum())} slips "
        f"({first}); {x.size / taken:.3g} samples/s on engine {arguments.engine}; {plain(arguments.out)}"
    )


def cop(arguments):
    """``meissner process cop``."""
    if arguments.min_load < 0:
        raise ValueError(f"min-load = {arguments.min_load} must not be negative")
    lines = None
    if arguments.calibration is not None:
        lines = calibration.load(arguments.calibration)
        engines.load(arguments.engine)
        forces = calibration.check_codes(files.read_array(arguments.input), lines.offset.shape)
    else:
        forces = engines.check_forces(files.read_array(arguments.input))

    def run(x):
        found = engines.process_cop(x, arguments.engine, arguments.min_load, lines)
        return found if lines is None else found | {"load_n": lines.load_n(x, found["sum"])}

    result, taken = _timed(arguments, run, forces, max(1, PIECE // forces[0].size), forces[:1])
    frames, rows, columns = forces.shape
    print(
        f"{frames} frame{'s' * (frames > 1)} of {rows}×{columns}, {int(result['valid'].sum())} with a load; "
        f"{'' if lines is None else f'sum in units of {lines.force_lsb_n:g} N; '}"
        f"{forces.size / taken:.3g} samples/s on engine {arguments.engine}; {plain(arguments.out)}"
    )


def cop4(arguments):
    """``meissner process cop4``."""
    from meissner.builds import cop4_file
    from meissner.twins.cop.cop4 import faults

    engines.load(arguments.engine)
    config = cop4_file.load(arguments.config)
    codes = files.read_array(arguments.input)
    if arguments.input.lower().endswith(".csv"):
        codes = codes.T  # a column per electrode
    codes = engines.check_electrodes(codes, config.adc.bits)
    run = lambda x: engines.process_cop4(x, config, arguments.engine)
    result, taken = _timed(arguments, run, codes, PIECE // 4, codes[:1])
    saturated, imbalance, opened = (int((flag > 0).sum()) for flag in faults(codes, config.registers))
    print(
        f"{len(codes)} sample{'s' * (len(codes) > 1)}, {int(result['valid'].sum())} with a load; faults: "
        f"{saturated} saturated, {opened} open, {imbalance} out of balance; "
        f"load in units of {config.load_lsb_n:g} N; "
        f"{len(codes) / taken:.3g} samples/s on engine {arguments.engine}; {plain(arguments.out)}"
    )
