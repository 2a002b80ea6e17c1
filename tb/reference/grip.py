"""The grip reflex by docs/grip.md, clock by clock, with lists of all inputs since the last cycle."""

LATENCY = 4  # from a decision in the clock that ends a cycle to its command
SPEED_DELAY = 3  # from a speed to the first window that it applies to


class GripLoop:
    """``clock`` takes the inputs of one clock and returns the cycle that ends in it, else None. A change of
    the mode takes that clock: it is one of reset."""

    def __init__(self, fingers, bits, shift, **settings):
        self.fingers, self.top, self.shift = range(fingers), 2**bits - 1, shift
        self.settings, self.now = dict(settings), 0
        self.reset()

    def reset(self):
        self.in_period, self.period_done, self.last_cycle = 0, False, self.now - 2
        self.speeds, self.due = dict.fromkeys(self.fingers, 0), []
        self.faulty = set()  # of the cycle that has just ended
        self.open_windows_over = set()
        self.verdicts = dict.fromkeys(self.fingers, "")  # of a finger's ended windows: "1" over, "0" not
        self.boost_before = self.boost  # one clock ago
        self.unheard = dict.fromkeys(self.fingers, 0)
        self.command, self.armed = 0, False
        self.was_mode = self.mode
        self.since_last()

    def since_last(self):
        self.windows, self.heard, self.over, self.unwell = [], set(), set(), set()

    def __getattr__(self, name):
        return self.settings[name]

    def clock(self, decision=None, speed=None, healthy=None):
        if self.mode != self.was_mode:  # a clock of reset
            self.now += 1
            return self.reset()
        for finger, value in [report for at, report in self.due if at == self.now]:
            self.speeds[finger] = value
        self.due = [each for each in self.due if each[0] > self.now]
        for finger in self.faulty:  # of a cycle that ended with the last clock
            self.speeds[finger] = 0
        self.faulty = set()

        if speed is not None and speed[0] in self.fingers:
            finger, ok, value = speed
            term = min(self.top, self.speed_gain * value // 2**self.shift) if ok else 0
            self.due.append((self.now + SPEED_DELAY, (finger, term)))
        self.unwell |= {f for f in self.fingers if healthy is not None and not healthy[f]}
        if decision is not None and decision[0] in self.fingers:
            finger, over, end = decision
            self.heard.add(finger)
            if over:
                self.over.add(finger)
                if finger not in self.open_windows_over:
                    in_a_row = len(self.verdicts[finger]) - len(self.verdicts[finger].rstrip("1"))
                    steps = self.step * 2 ** min(in_a_row, self.boost_before)
                    self.windows.append((finger, steps + self.speeds[finger]))
                self.open_windows_over.add(finger)
            if end:
                self.verdicts[finger] += "1" if finger in self.open_windows_over else "0"
                self.open_windows_over.discard(finger)

        self.boost_before = self.boost
        ended = None
        self.in_period += 1
        if self.in_period >= max(16, self.period):
            if not self.period_done:
                ended = self.cycle()
            self.in_period, self.period_done = 0, False
        elif (
            self.immediate
            and not self.period_done
            and self.last_cycle != self.now - 1
            and {finger for finger, _ in self.windows} - self.unwell
        ):
            ended, self.period_done = self.cycle(), True
        self.now += 1
        return ended

    def cycle(self):
        self.last_cycle = self.now
        for finger in self.fingers:
            self.unheard[finger] = 0 if finger in self.heard else self.unheard[finger] + 1
        silent = {f for f in self.fingers if self.unheard[f] >= max(1, self.watchdog)}
        faulty = silent | self.unwell
        wishes = []
        for finger in self.fingers:
            if finger not in faulty:
                wishes.append(min(self.top, sum(w for of, w in self.windows if of == finger)))
        wishes.sort()
        wish = 0 if not wishes else wishes[0] if self.rule else wishes[-1]
        slips, all_heard = self.over - faulty, self.heard == set(self.fingers)
        quiet = all_heard and not self.over and not faulty
        unhealthy = bool(self.unwell)
        self.faulty = faulty
        self.since_last()

        old, valid = self.command, True
        if self.armed:
            goal = old
            if self.override:
                goal = self.override_value
            elif slips:
                goal = min(self.top, old + wish)
            elif quiet:
                goal = max(0, old - self.decay)
            if goal < self.minimum:
                goal = self.minimum
            if goal > self.maximum:
                goal = self.maximum
            if goal > old + self.rate:
                goal = old + self.rate
            if goal < old - self.rate:
                goal = old - self.rate
            self.command = goal
            increment = goal - old
        else:
            increment = 0
            if self.mode == 0 or self.override:
                goal = self.override_value if self.mode else self.minimum
                self.command = sorted((self.minimum, goal, self.maximum))[1]
                if self.minimum > self.maximum:
                    self.command = self.maximum
                self.armed = True
            else:
                valid = False
        fault = [bool(silent), unhealthy, valid and self.command >= self.maximum]
        fault += [self.minimum > self.maximum, not valid]
        word = self.command if self.mode else increment
        return {
            "valid": valid,
            "word": word,
            "increment": increment,
            "command": self.command,
            "fault": sum(bit << n for n, bit in enumerate(fault)),
            "faulty": sum(1 << finger for finger in faulty),
        }
