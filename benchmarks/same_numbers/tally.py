"""What a comparison has found, and how numbers and words are held against each other."""
import numpy as np


class Tally:
    """What was found in one command, or in all."""

    def __init__(self):
        self.numbers = self.words = self.differ = self.texts = 0
        self.largest = 0.0
        self.places, self.missing, self.extra = [], [], []

    def add(self, other):
        self.numbers += other.numbers
        self.words += other.words
        self.differ += other.differ
        self.texts += other.texts
        self.largest = max(self.largest, other.largest)
        self.missing += other.missing
        self.extra += other.extra

    def different(self, place, count, what):
        self.differ += count
        if count > 0:
            self.places.append(f"{place}: {count} {what}")

    @property
    def failed(self):
        return self.differ > 0 or bool(self.missing)

    def line(self, name):
        text = (f"{name:34} {self.numbers:9} numbers {self.words:6} words   {self.differ:7} differ, by at most {self.largest:8.2g}"
                f"   texts {self.texts:3}")
        for words, places in (("missing", self.missing), ("only after", self.extra)):
            text += f"   {words} {len(places)}" if places else ""
        return text


def relative_differences(a, b):
    """Of each number; infinite if one of both is not finite."""
    a, b = a.astype(np.float64), b.astype(np.float64)
    with np.errstate(all="ignore"):
        found = np.abs(a - b) / np.maximum(np.abs(a), np.abs(b))
    found[(a == 0) & (b == 0)] = 0  # of either sign
    found[~np.isfinite(found)] = np.inf
    return found


def same_bits(a, b):
    if a.dtype.kind != "f":
        return a == b
    bits = f"u{a.dtype.itemsize}"
    return (a.view(bits) == b.view(bits)) | (np.isnan(a) & np.isnan(b))


def compare_numbers(place, a, b, relative, tally):
    tally.numbers += a.size
    if a.shape != b.shape or a.dtype != b.dtype:
        tally.largest = float("inf")
        tally.different(place, max(a.size, 1), f"{a.dtype} {a.shape} became {b.dtype} {b.shape}")
        return
    other = ~same_bits(a, b)
    if not other.any():
        return
    far = relative_differences(a[other], b[other])
    tally.largest = max(tally.largest, float(far.max()))
    first = int(far.argmax())
    tally.different(place, int((far > relative).sum()) if relative > 0 else far.size,
                    f"of {a.size}, such as {a[other][first]!r} became {b[other][first]!r}")


def count_different(a, b):
    return abs(len(a) - len(b)) + sum(x != y for x, y in zip(a, b))


def compare_words(place, a, b, tally):
    tally.words += len(a)
    x, y = next(((x, y) for x, y in zip(a, b) if x != y), (f"{len(a)} words", f"{len(b)} words"))
    tally.different(place, count_different(a, b), f"words, such as {x[:60]!r} became {y[:60]!r}")
