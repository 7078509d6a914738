"""Faults that are put into a channel of a data set, and which remarks count as having found them."""
import h5py
import numpy as np

KINDS = ("dropout", "spike", "stuck", "clipping", "displaced", "time_jump", "odd_cycle", "unit_57", "unit_1000", "sign", "axis",
         "lag", "lag_grid", "drift", "two_feet")
# What a remark on each may be called: the same event can be seen in several ways.
NAMES = {"dropout": {"dropout", "spike", "displaced", "odd_cycle", "stuck"}, "spike": {"spike", "dropout", "displaced"},
         "stuck": {"stuck", "dropout", "displaced", "odd_cycle"}, "clipping": {"clipping", "stuck", "displaced"},
         "displaced": {"displaced", "spike", "odd_cycle"}, "time_jump": {"time_jump"}, "odd_cycle": {"odd_cycle", "odd_trial", "displaced"},
         "unit_57": {"unit", "axis", "odd_trial"}, "unit_1000": {"unit", "axis", "odd_trial"}, "sign": {"sign", "axis", "odd_trial"},
         "axis": {"axis", "odd_trial"}, "lag": {"lag"}, "lag_grid": {"lag"}, "drift": {"drift"}, "two_feet": {"two_feet"}}
AXES = ("_x", "_y", "_z")


def text(value):
    return value.decode() if isinstance(value, bytes) else str(value)


class Fault:
    """One fault in one open file; `make` returns False if the channel cannot have it.

    where: trial, grid, channel. window: the times [s] of the trial that are fitted; a fault of a part of a trial is put there.
    swing: duration of a cycle [s], or None."""

    def __init__(self, kind, rng, file, where, window=None, swing=None):
        self.kind, self.rng, self.file, self.swing = kind, rng, file, swing
        self.trial, self.grid, self.channel = where
        self.group = file[f"trials/{self.trial}/{self.grid}"]
        self.time = self.group["time"][()]
        self.data = self.group[f"channels/{self.channel}"]
        self.x = self.data[()].astype(float)
        from_s, to_s = window or (self.time[0], self.time[-1])
        self.first = max(5, int(np.searchsorted(self.time, from_s)))
        self.last = min(len(self.x) - 6, int(np.searchsorted(self.time, to_s)))
        self.channels = {self.channel}
        self.span = None
        self.parts = None  # [s] of a fault in several parts
        self.size = None

    def make(self):
        finite = self.x[np.isfinite(self.x)]
        if len(finite) < 60 or np.ptp(finite) == 0 or self.last - self.first < 30:
            return False
        low, high = np.quantile(finite, (0.02, 0.98))
        return high > low and getattr(self, self.kind)(self.x, high - low, low, high)

    @property
    def is_marker(self):
        return self.grid == "markers"

    def place(self, length):
        return int(self.rng.integers(self.first, max(self.first + 1, self.last - length)))

    def share(self, low, high):
        """Samples: a share of what is fitted."""
        return int(self.rng.uniform(low, high) * (self.last - self.first))

    def moving(self, samples):
        """Where a stretch of so many samples covers at least 40 % of the range: elsewhere a fault changes nothing."""
        low, high = np.nanquantile(self.x, (0.02, 0.98))
        for _ in range(200):
            first = self.place(samples)
            part = self.x[first:first + samples]
            if np.all(np.isfinite(part)) and np.ptp(part) > 0.4 * (high - low):
                return first
        return None

    def stretch(self, first, last):
        self.span = (float(self.time[first]), float(self.time[last]))

    def write(self, x, size=None):
        self.data[...] = x
        self.size = size
        return True

    def dropout(self, x, spread, low, high):
        for _ in range(100):
            length = max(2, self.share(0.005, 0.05))
            first = self.place(length)
            part = x[first - 1:first + length + 1]
            if np.all(np.abs(part) > 0.5 * spread):
                x[first:first + length] = 0
                self.stretch(first, first + length - 1)
                return self.write(x, length)
        return False

    def spike(self, x, spread, low, high):
        i = self.place(1)
        if not np.all(np.isfinite(x[i - 3:i + 4])):
            return False
        size = self.rng.uniform(1, 3)
        x[i] += self.rng.choice((-1, 1)) * size * spread
        self.stretch(i, i)
        return self.write(x, size)

    def stuck(self, x, spread, low, high):
        length = max(10, self.share(0.03, 0.15))
        first = self.moving(length)
        if first is None or abs(x[first + length] - x[first]) < 0.3 * spread:
            return False
        x[first:first + length] = x[first]
        self.stretch(first, first + length - 1)
        return self.write(x, length)

    def clipping(self, x, spread, low, high):
        if text(self.data.attrs["kind"]) == "input" and not self.is_marker:
            return False
        top = self.rng.random() < 0.5
        size = self.rng.uniform(0.1, 0.3)
        level = high - size * spread if top else low + size * spread
        clipped = np.minimum(x, level) if top else np.maximum(x, level)
        # A level that the signal rests at anyway cuts nothing off.
        if np.nansum(clipped != x) < 0.01 * len(x) or level == 0:
            return False
        away = np.flatnonzero(clipped != x)
        self.parts = [self.time[[part[0], part[-1]]] for part in np.split(away, np.flatnonzero(np.diff(away) > 1) + 1)]
        return self.write(clipped, size)

    def displaced(self, x, spread, low, high):
        length = max(8, self.share(0.02, 0.1))
        first = self.place(length)
        if not np.all(np.isfinite(x[first - 3:first + length + 3])):
            return False
        size = self.rng.uniform(0.7, 2)
        x[first:first + length] += self.rng.choice((-1, 1)) * size * spread
        self.stretch(first, first + length - 1)
        return self.write(x, size)

    def time_jump(self, x, spread, low, high):
        t = self.time
        size = self.rng.uniform(0.03, 0.2)
        t[self.place(1):] += size * (t[-1] - t[0])
        self.group["time"][...] = t
        self.channels = {""}
        self.size = size
        return True

    def odd_cycle(self, x, spread, low, high):
        if not self.swing:
            return False
        duration = self.rng.uniform(0.2, 0.4) * self.swing
        from_s = self.time[self.place(1)]
        p = (self.time - from_s) / duration
        inside = (p > 0) & (p < 1)
        if inside.sum() < 5:
            return False
        size = self.rng.uniform(0.5, 1)
        x[inside] += self.rng.choice((-1, 1)) * size * spread * np.sin(np.pi * p[inside]) ** 2
        self.stretch(*np.flatnonzero(inside)[[0, -1]])
        return self.write(x, size)

    def scaled(self, x, factor):
        if self.is_marker or "_force_" in self.channel:
            self.channels |= {self.channel[:-2] + axis for axis in AXES}
        factor = factor if self.rng.random() < 0.5 else 1 / factor
        return self.write(x * factor, factor)

    def unit_57(self, x, spread, low, high):
        return text(self.data.attrs["unit"]).startswith("rad") and self.scaled(x, 180 / np.pi)

    def unit_1000(self, x, spread, low, high):
        return text(self.data.attrs["unit"]) in ("m", "N", "N*m", "V") and self.scaled(x, 1000)

    def sign(self, x, spread, low, high):
        return self.write(-x)

    def axis(self, x, spread, low, high):
        """Two axes of a force or a marker are exchanged."""
        if self.channel[-2:] not in AXES or not (self.is_marker or "_force_" in self.channel or self.channel.startswith("position_")):
            return False
        name = self.channel[:-2] + self.rng.choice([a for a in AXES if a != self.channel[-2:]])
        other = self.group[f"channels/{name}"]
        y = other[()]
        if np.nanmax(np.abs(x - y)) == 0:
            return False
        other[...] = x
        self.channels |= {self.channel[:-2] + axis for axis in AXES}
        return self.write(y)

    def delayed(self, x):
        """Later by `size` s. Before its beginning the signal is continued point-symmetrically: a constant would be a fault of its own."""
        t = self.time - self.size
        early = t < self.time[0]
        late = np.interp(t, self.time, x)
        late[early] = 2 * x[0] - np.interp(2 * self.time[0] - t[early], self.time, x)
        return late

    def delay(self):
        """Draws a delay of at least three samples; False if the recording is too short for it."""
        step = np.median(np.diff(self.time))
        self.size = max(3 * step, self.rng.uniform(0.05, 0.25))
        return self.size < 0.25 * (self.time[-1] - self.time[0])

    def lag(self, x, spread, low, high):
        """A channel is late; of a marker all its coordinates."""
        if not self.delay():
            return False
        if self.is_marker:
            self.channels = {self.channel[:-2] + axis for axis in AXES}
            for name in self.channels:
                values = self.group[f"channels/{name}"]
                values[...] = self.delayed(values[()])
            return True
        return self.write(self.delayed(x), self.size)

    def lag_grid(self, x, spread, low, high):
        """A recording device is late: all channels of a grid."""
        others = [grid for grid in self.file[f"trials/{self.trial}"].values() if isinstance(grid, h5py.Group) and "channels" in grid]
        if not self.delay() or len(others) < 2 or len(self.group["channels"]) < 2:
            return False
        self.channels = set(self.group["channels"])
        self.group["time"][...] = self.time + self.size
        return True

    def drift(self, x, spread, low, high):
        if text(self.data.attrs["unit"]) not in ("N", "N*m", "V") or "_moment_" in self.channel or not (
                self.swing or self.channel.endswith("force_y")):
            return False
        size = self.rng.uniform(0.1, 0.3)
        return self.write(x + self.rng.choice((-1, 1)) * size * spread * np.linspace(0, 1, len(x)), size)

    def two_feet(self, x, spread, low, high):
        """The other foot comes down on this plate: its force and centre of pressure are added to this plate's."""
        n = len(x)
        if not self.channel.endswith("_force_y"):
            return False
        plate = self.channel[:-len("_force_y")]
        others = [c[:-len("_force_y")] for c in self.group["channels"] if c.endswith("_force_y") and c != self.channel]
        if not others:
            return False
        other = others[0]
        get = lambda name: self.group[f"channels/{name}"][()].astype(float)  # noqa: E731
        f = get(f"{other}_force_y")
        inside = (np.arange(n) >= self.first) & (np.arange(n) <= self.last)
        loaded = np.flatnonzero((f > 0.1 * f.max()) & (x > 0.1 * x.max()) & inside)
        if len(loaded) == 0:
            return False
        at = int(self.rng.choice(loaded))
        first = at
        while first > 0 and f[first] > 0.02 * f.max():
            first -= 1
        last = at
        while last < n - 1 and f[last] > 0.02 * f.max():
            last += 1
        if first == 0 or last == n - 1:
            return False
        part = slice(first, last)
        total = x[part] + f[part]
        for axis in "xz":
            mine, theirs = get(f"{plate}_cop_{axis}"), get(f"{other}_cop_{axis}")
            mine[part] = (x[part] * mine[part] + f[part] * theirs[part]) / np.maximum(total, 1)
            self.group[f"channels/{plate}_cop_{axis}"][...] = mine
        x[part] = total
        self.group[f"channels/{other}_force_y"][...] = np.where((np.arange(n) >= first) & (np.arange(n) < last), 0, f)
        self.stretch(first, last)
        return self.write(x)

    def found(self, remarks, trials=(), renamed=None):
        """True if one of the remarks is about this fault. trials: also the names of the trials that were cut out of this one."""
        of = {self.trial, *trials}
        channels = self.channels | {(renamed or {}).get(c, c) for c in self.channels}
        for remark in remarks:
            if remark["kind"] not in NAMES[self.kind] | {"inconsistent"}:
                continue
            # A quaternion, all four of whose channels are named.
            four = remark["kind"] == "inconsistent" and self.channel[:-2] == remark["channel"][:-2]
            # A device, all of whose channels are.
            device = self.kind == "lag_grid" and remark["channel"] == "" and remark["grid"] == self.grid
            named = channels & {remark["channel"], remark["other"]} or four or device
            if not named and not (self.kind == "time_jump" and remark["grid"] == self.grid):
                continue
            if remark["trial"] not in of and not any(t in remark["other"] for t in of):
                continue
            parts = self.parts if self.parts else [self.span] if self.span else []
            if parts and not any(s["from_s"] <= part[1] + 0.05 and s["to_s"] >= part[0] - 0.05 for s in remark["spans"] for part in parts):
                continue
            return True
        return False
