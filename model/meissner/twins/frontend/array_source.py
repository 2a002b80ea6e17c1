"""Twin of rtl/frontend/msn_array_source.sv: the frames that an array gets, and their times."""


class Stream:
    """Replaces ScanAdc or ScanDemod where frames arrive on a stream: nothing is scanned."""

    def __init__(self, rows, columns, lanes=1, sample_bits=17):
        self.rows, self.columns, self.lanes, self.sample_bits = rows, columns, lanes, sample_bits

    def samples(self, frames, now):
        """Each frame, unchanged, with its time: the clock ``now`` of its first beat."""
        return list(zip(frames, now))
