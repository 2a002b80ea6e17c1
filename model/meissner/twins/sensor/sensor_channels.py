"""Twin of rtl/sensor/msn_sensor_channels.sv: samples of a converter or of a stream, in complete frames."""


def sensor_channels(acquire, codes):
    """Samples [frames, channels] of ``codes`` of that shape: the gate changes their timing, not their values.

    ``acquire``: meissner.twins.frontend.acquire.Acquire.
    """
    samples, _ = acquire.samples(codes)
    return samples
