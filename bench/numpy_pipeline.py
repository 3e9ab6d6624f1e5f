#!/usr/bin/env python3
"""The published procedure (Dyck 2013, appendix C, sinusoidal protocol) with NumPy and SciPy.

What a skilled user would write for the same job as `mbk measure --mode reference`: an array for each quantity, one
library call for each step, no loops. Prints M, B, K, x0 and the VAF as JSON, and the seconds spent after the imports.

usage: numpy_pipeline.py LOG.mat

The Savitzky-Golay weights come from a fit on an abscissa scaled to [-1, 1]. scipy.signal.savgol_filter fits on the sample
numbers -50 ... 50, whose powers up to the sixth span ten orders of magnitude, so its weights of the second derivative do
not quite add up to zero, and the remainder of the position goes into K (5.5e-5 of the largest element).
"""

import json
import math
import sys
import time

import numpy as np
from scipy.io import loadmat
from scipy.ndimage import convolve1d
from scipy.signal import butter, sosfiltfilt

RATE = 1000.0  # [Hz]
BEGIN, END = 11999, 62000  # samples of the published window
IDENTIFY = 40000  # samples that make the parameters; the rest is held out
ORDER, WINDOW = 6, 101  # Savitzky-Golay
CUTOFF = 5.0  # [Hz]
ROWS = {"hand": slice(1, 3), "force": slice(9, 11), "reference": slice(11, 13)}


def savitzky_golay(signal, derivative):
    """The derivative at the centre of each window; the first and last half window are not to be used."""
    half = (WINDOW - 1) // 2
    t = np.arange(-half, half + 1) / half
    fit = np.linalg.pinv(np.vander(t, ORDER + 1, increasing=True))  # row d: weights of the coefficient of t**d
    weights = fit[derivative] * math.factorial(derivative) * (RATE / half) ** derivative
    return convolve1d(signal, weights[::-1])


def signals_of(path, names):
    """The window of pairs of signals, 2 x N each."""
    logs = loadmat(path, variable_names=["logs"])["logs"][:, BEGIN:END]
    return [logs[ROWS[name]] for name in names]


def measure(path):
    smooth = savitzky_golay
    position, force = signals_of(path, ("hand", "force"))

    signals = np.vstack([smooth(position, 2), smooth(position, 1), smooth(position, 0), smooth(force, 0)])
    lost = (WINDOW - 1) // 2 + 1
    signals = signals[:, lost:-lost]
    lowpass = butter(5, CUTOFF, fs=RATE, output="sos")
    signals = sosfiltfilt(lowpass, signals, padlen=15)

    Z = np.vstack([signals[:6], np.ones(signals.shape[1])]).T
    Y = -signals[6:].T
    P = np.linalg.lstsq(Z[:IDENTIFY], Y[:IDENTIFY], rcond=None)[0]
    residual = Y[IDENTIFY:] - Z[IDENTIFY:] @ P
    vaf = 100.0 * (1.0 - residual.var(axis=0, ddof=1) / Y[IDENTIFY:].var(axis=0, ddof=1))
    M, B, K = P[0:2].T, P[2:4].T, P[4:6].T
    return {
        "M": M.tolist(),
        "B": B.tolist(),
        "K": K.tolist(),
        "x0": (-np.linalg.solve(K, P[6])).tolist(),
        "VAF": vaf.tolist(),
    }


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: numpy_pipeline.py LOG.mat")
    cpu = time.process_time()
    model = measure(sys.argv[1])
    model["cpu_seconds_after_imports"] = time.process_time() - cpu
    print(json.dumps(model))


if __name__ == "__main__":
    main()
