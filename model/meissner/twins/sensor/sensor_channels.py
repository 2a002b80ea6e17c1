"""Twin of rtl/sensor/msn_sensor_channels.sv: samples of a converter or of a stream, in whole frames."""


def sensor_channels(acquire, codes):
    """Samples [frames, channels] of ``codes`` of that shape: the gate changes when they come, not what.

    ``acquire``: meissner.twins.frontend.acquire.Acquire.
    """
    samples, _ = acquire.samples(codes)
    return samples
