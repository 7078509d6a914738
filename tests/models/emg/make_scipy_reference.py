"""Writes scipy_reference.txt: filtered signals as scipy computes them. Not part of the tests, which read the file.

    /usr/bin/python3 make_scipy_reference.py > scipy_reference.txt     (Debian 12: python3-scipy)
"""
import numpy as np
import scipy
from scipy.signal import butter, sosfilt, sosfilt_zi, sosfiltfilt

SAMPLES = 2000
# kind, order of one pass, cut-off(s) [Hz], rate [Hz]
CASES = [("lowpass", order, (cut_off,), rate) for order in (1, 2, 3, 4) for cut_off, rate in ((6, 2048), (8, 1000))]
CASES += [("highpass", order, (cut_off,), rate) for order in (1, 2, 3, 4)
          for cut_off, rate in ((30, 2048), (300, 2048), (30, 1000))]
CASES += [("bandpass", order, (20, 450), 2048) for order in (1, 2, 3, 4)]
CASES += [("lowpass", 8, (50,), 2048), ("highpass", 7, (900,), 2048), ("bandpass", 2, (1, 1000), 2048)]


def signal():
    """Noise that swells and fades on an offset; the same to the last bit in every language."""
    state, values = 1, []
    for k in range(SAMPLES):
        state = (1103515245 * state + 12345) % 2**31
        values.append(0.3 + (state / 2**31 - 0.5) * (0.1 + abs(k % 700 - 350) / 350))
    return np.array(values)


def main():
    x = signal()
    print(f"# scipy {scipy.__version__}, numpy {np.__version__}; made by make_scipy_reference.py")
    print("# way kind order low_Hz high_Hz rate_Hz sample value; way: zero_lag = sosfiltfilt, settled = sosfilt from")
    print("# sosfilt_zi times the first value, rest = sosfilt from 0, envelope = butter(order, high) and butter(order, low)")
    kept = [*range(4), *range(137, SAMPLES - 4, 251), *range(SAMPLES - 4, SAMPLES)]
    results = []
    for kind, order, cut_offs, rate in CASES:
        sos = butter(order, cut_offs if len(cut_offs) > 1 else cut_offs[0], kind, fs=rate, output="sos")
        words = f"{kind} {order} {cut_offs[0]} {cut_offs[-1]} {rate}"
        results.append((f"zero_lag {words}", sosfiltfilt(sos, x)))
        if order in (2, 3):
            results.append((f"settled {words}", sosfilt(sos, x, zi=sosfilt_zi(sos) * x[0])[0]))
            results.append((f"rest {words}", sosfilt(sos, x)))
    for order in (1, 2, 4):
        rectified = np.abs(sosfiltfilt(butter(order, 30, "highpass", fs=2048, output="sos"), x))
        envelope = sosfiltfilt(butter(order, 6, fs=2048, output="sos"), rectified)
        results.append((f"envelope - {order} 6 30 2048", np.maximum(envelope, 0)))
    for words, values in results:
        for k in kept:
            print(words, k, repr(float(values[k])))


if __name__ == "__main__":
    main()
