"""What the host hears of the channels' states, by docs/link.md: for each channel a plain list of what it is
owed."""

NONE, CONTACT, INCIPIENT, GROSS, RELEASE = range(5)


class ChangesReference:
    """``decision`` takes one and returns (start, late, told, state) of the packet that it makes, or None."""

    def __init__(self, channels, events=0b11111):
        self.events = events
        self.host = [NONE] * channels  # what the host has
        self.state = [NONE] * channels
        self.owed = [[] for _ in range(channels)]  # changes that were not sent, at most one
        self.lost = self.changes = self.sent = 0

    def decision(self, channel, state, raised, room):
        new = state != self.state[channel]
        self.state[channel] = state
        sendable = self.events & 1 << state != 0
        self.changes += new and sendable
        before, self.owed[channel] = self.owed[channel], []
        late = bool(before) and not new
        if new:
            self.lost += len(before)
        if not sendable:
            self.host[channel] = state
            return None
        if not raised and state == self.host[channel]:
            self.lost += new and len(before)  # the host has it already
            return None
        if not raised and not room:
            self.owed[channel] = [state]
            return None
        told, self.host[channel] = self.host[channel], state
        self.sent += 1
        return raised, late, told, state
