"""The interval of a share."""
import math


def wilson(hits, count):
    """95 % interval of a share (Wilson 1927). @param hits, count: may be fractions, as effective counts are."""
    if count <= 0:
        return 0.0, 1.0
    z, p = 1.959964, hits / count
    middle = (p + z * z / (2 * count)) / (1 + z * z / count)
    half = z / (1 + z * z / count) * math.sqrt(p * (1 - p) / count + z * z / (4 * count * count))
    return max(0.0, middle - half), min(1.0, middle + half)
