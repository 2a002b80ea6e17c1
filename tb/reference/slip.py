"""Slip of one channel by docs/slip.md, a sample at a time: written from that page, not from the twins."""

NONE, CONTACT, INCIPIENT, GROSS, RELEASE = "ncigr"
NUMBERS = {NONE: 0, CONTACT: 1, INCIPIENT: 2, GROSS: 3, RELEASE: 4}  # msn_pkg::slip_state_e


class SlipReference:
    """The states. ``detail`` takes one detail's p2p and level and returns the state that follows it.

    ``settings``: attributes threshold, gross_threshold, contact_level, release_level, contact_rises, hold,
    refractory, blank, and keep_threshold (may be None). ``quiet``, ``in_contact`` and ``calm`` count details
    since the last that kept the slip, since the onset, and since the last slip.
    """

    def __init__(self, settings):
        self.settings = settings
        self.state, self.blanked = NONE, 0
        self.quiet = self.in_contact = self.calm = self.released = 0
        self.slipped = False  # in this contact

    def restart(self):
        self.state = NONE

    def over(self, p2p):
        return p2p > self.settings.threshold

    def keeps(self, p2p):
        """Whether p2p keeps a raised slip: it exceeds the threshold, or the keep threshold if there is
        one."""
        lower = getattr(self.settings, "keep_threshold", None)
        return self.over(p2p) or (lower is not None and p2p > lower)

    def detail(self, p2p, level, moving=False, masked=False):
        given = self.settings
        if given.contact_rises:
            pressed, lifted = level >= given.contact_level, level < given.release_level
        else:
            pressed, lifted = level <= given.contact_level, level > given.release_level
        if masked:
            self.state = NONE
        elif self.state == NONE and pressed:
            self._touch()
        elif self.state == RELEASE:
            self.released += 1
            if pressed:
                self._touch()
            elif self.released > given.hold:
                self.state = NONE
        elif self.state in (CONTACT, INCIPIENT, GROSS):
            self._contact(p2p, lifted, moving)
        return self.state

    def _touch(self):
        self.state, self.in_contact, self.slipped = CONTACT, 0, False

    def _contact(self, p2p, lifted, moving):
        given, over = self.settings, self.over(p2p)
        self.in_contact += 1
        if lifted:
            self.state, self.released = RELEASE, 0
        elif self.state == CONTACT:
            self.calm += 1
            if self.slipped:
                blanked, deaf = False, self.calm <= given.refractory
            else:
                blanked, deaf = self.in_contact <= given.blank, False
            if over and (blanked or moving):
                self.blanked += 1
            elif over and not deaf:
                self.state = GROSS if p2p > given.gross_threshold else INCIPIENT
                self.quiet, self.slipped = 0, True
        else:
            if over and moving:
                self.blanked += 1
            if self.keeps(p2p) and not moving:
                self.quiet = 0
                if over and p2p > given.gross_threshold:
                    self.state = GROSS
            else:
                self.quiet += 1
                if self.quiet > given.hold:
                    self.state, self.calm = CONTACT, 0


class SlipPathReference:
    """One channel's samples to decisions; ``sample`` returns None or a detail's (state, raised, over, p2p,
    end)."""

    def __init__(self, settings):
        self.settings, self.slip = settings, SlipReference(settings)
        self.span = settings.window >> settings.level
        self.hop = settings.hop >> settings.level
        self.restart()

    def restart(self):
        self.slip.restart()
        self.group, self.spoilt = [], False
        self.details = []  # None where masked

    def sample(self, x, moving=False, masked=False):
        self.group.append(x)
        self.spoilt |= masked
        if len(self.group) < 1 << self.settings.level:
            return None
        half = len(self.group) // 2
        first, second = sum(self.group[:half]), sum(self.group[half:])
        spoilt, self.group, self.spoilt = self.spoilt, [], False
        self.details.append(None if spoilt else first - second)

        at = len(self.details) - 1
        if self.hop == self.span:
            begin = at // self.span * self.span
        elif self.hop == self.span // 2:
            begin = max(at // self.hop - 1, 0) * self.hop
        else:
            begin = max(at - self.span + 1, 0)
        window = [detail for detail in self.details[begin:] if detail is not None]
        p2p = max(window) - min(window) if window else 0
        full = at - self.span + 1  # where the window that ends here begins
        end = full >= 0 and full % self.hop == 0

        before = self.slip.state
        state = self.slip.detail(p2p, 0 if spoilt else first + second, moving, spoilt)
        raised = state in (INCIPIENT, GROSS) and before not in (INCIPIENT, GROSS)
        return state, raised, self.slip.over(p2p) and not spoilt, p2p, end
