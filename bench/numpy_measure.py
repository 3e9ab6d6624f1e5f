#!/usr/bin/env python3
"""What `mbk measure` finds, with NumPy and SciPy: for whole_command.py.

The parts are those of the command, each as a skilled user would write it, with arrays and library calls and without
loops over samples: least squares and instrumental variables with covariances for correlated residuals (Newey & West),
strength of the instruments, fit on what was held out, tests of what the model takes for granted (simultaneity, linear
and constant stiffness, no dry friction), tremor, the nearest positive semidefinite M, B and K, ellipses, coherence of
force and motion, the energy that the limb absorbs with an interval from its blocks, and the passivity of the model over
frequency. Prints M, B, K and the rest as JSON, and the seconds spent after the imports.

usage: numpy_measure.py LOG.mat
"""

import json
import sys
import time

import numpy as np
from scipy.signal import butter, coherence, sosfiltfilt, welch

import numpy_pipeline
from numpy_pipeline import CUTOFF, IDENTIFY, RATE, WINDOW

LAGS = 250  # of the residuals' covariance [samples]
EVERY = 77  # rows of the tests: 2.6 for each period of the cutoff


def filtered(position, force, reference):
    smooth = numpy_pipeline.savitzky_golay
    signals = np.vstack([smooth(position, 2), smooth(position, 1), smooth(position, 0), smooth(force, 0),
                         smooth(reference, 2), smooth(reference, 1), smooth(reference, 0)])
    lost = (WINDOW - 1) // 2 + 1
    return sosfiltfilt(butter(5, CUTOFF, fs=RATE, output="sos"), signals[:, lost:-lost], padlen=15)


def long_run(scores):
    """Newey & West by sums over a moving window; scores are N x k."""
    padded = np.vstack([np.zeros((LAGS + 1, scores.shape[1])), scores, np.zeros((LAGS, scores.shape[1]))])
    running = np.cumsum(padded, axis=0)
    sums = running[LAGS + 1:] - running[:-LAGS - 1]
    return sums.T @ sums / (LAGS + 1)


def fit(Z, R, Y):
    """Coefficients by the instruments R, which are Z for least squares, and the covariance of all of them."""
    bread = np.linalg.inv(R.T @ Z)
    P = bread @ (R.T @ Y)
    residual = Y - Z @ P
    scores = np.hstack([R * residual[:, [j]] for j in range(Y.shape[1])])
    A = np.kron(np.eye(Y.shape[1]), bread)
    return P, residual, A @ long_run(scores) @ A.T, scores, A


def strength(Z, R):
    """Conditional first-stage F of each regressor but the constant."""
    found = []
    for j in range(Z.shape[1] - 1):
        others = np.delete(Z, j, axis=1)
        predicted = R @ np.linalg.lstsq(R, others, rcond=None)[0]
        left = Z[:, j] - others @ np.linalg.lstsq(predicted, Z[:, j], rcond=None)[0]
        slope = np.linalg.lstsq(R, left, rcond=None)[0]
        inverse = np.linalg.inv(R.T @ R)
        V = inverse @ long_run(R * (left - R @ slope)[:, None]) @ inverse
        found.append(float(slope[:-1] @ np.linalg.pinv(V[:-1, :-1]) @ slope[:-1]))
    return found


def assumptions(Z, Y, K):
    """Wald statistics of what each assumption excludes, on decimated rows."""
    at = np.arange(1, len(Z) - 1, EVERY)
    jerk = (Z[at + 1, :2] - Z[at - 1, :2]) * RATE / 2
    A, y = Z[at], Y[at]
    x = A[:, 4:6] - A[:, 4:6].mean(axis=0)
    v = A[:, 2:4]
    speed = np.linalg.norm(v, axis=1)
    waves = np.cos(np.pi * np.outer(np.arange(len(at)) + 0.5, np.arange(1, 13)) / len(at))
    found = {}
    for name, columns in (("simultaneous", lambda k: jerk),
                          ("linear_stiffness", lambda k: (x**2).sum(axis=1)[:, None] * x),
                          ("no_dry_friction", lambda k: v / np.sqrt(speed**2 + (0.3 * speed.mean()) ** 2)[:, None]),
                          ("constant_stiffness", lambda k: (x @ K[k])[:, None] * waves)):
        values = []
        for k in range(2):
            more = columns(k)
            B = np.hstack([A, more])
            B = B / np.linalg.norm(B, axis=0)
            b = np.linalg.lstsq(B, y[:, k], rcond=None)[0]
            e = y[:, k] - B @ b
            inverse = np.linalg.inv(B.T @ B)
            V = inverse @ ((B * e[:, None]).T @ (B * e[:, None])) @ inverse
            last = more.shape[1]
            values.append(float(b[-last:] @ np.linalg.solve(V[-last:, -last:], b[-last:]) / last))
        found[name] = values
    return found


def nearest_semidefinite(matrix):
    values, vectors = np.linalg.eigh((matrix + matrix.T) / 2)
    return vectors @ np.diag(np.maximum(values, 0)) @ vectors.T


def ellipse(matrix):
    values, vectors = np.linalg.eigh((matrix + matrix.T) / 2)
    return {"axes": values.tolist(), "angle": float(np.arctan2(vectors[1, 1], vectors[0, 1])),
            "shape": float(values[0] / values[1]), "area": float(np.pi * values[0] * values[1])}


def energy(position, force, random):
    """Absorbed energy, and its 95 % interval from blocks of one second, drawn a thousand times."""
    work = -(0.5 * (force[:, 1:] + force[:, :-1]) * np.diff(position, axis=1)).sum(axis=0)
    velocity = numpy_pipeline.savitzky_golay(position, 1)
    squared = (velocity**2).sum(axis=0)[1:] / RATE
    block = int(RATE)
    count = work.size // block
    of_blocks = work[:count * block].reshape(count, block).sum(axis=1)
    speed_of_blocks = squared[:count * block].reshape(count, block).sum(axis=1)
    drawn = random.integers(0, count, (1000, count))
    shortage = -of_blocks[drawn].sum(axis=1) / speed_of_blocks[drawn].sum(axis=1)
    running, moved = np.cumsum(work), np.cumsum(squared)
    return {"absorbed": float(running[-1]), "interval": np.quantile(shortage, [0.025, 0.975]).tolist(),
            "largest_shortage": float(np.max(-running[block:] / moved[block:])),
            "least": float(np.min(running))}


def measure(path):
    position, force, reference = numpy_pipeline.signals_of(path, ("hand", "force", "reference"))
    signals = filtered(position, force, reference)
    Z = np.vstack([signals[:6], np.ones(signals.shape[1])]).T
    R = np.vstack([signals[8:14], np.ones(signals.shape[1])]).T
    Z[:, 4:6] -= Z[:IDENTIFY, 4:6].mean(axis=0)
    R[:, :6] -= R[:IDENTIFY, :6].mean(axis=0)
    Y = -signals[6:8].T
    own, instruments, target = Z[:IDENTIFY], R[:IDENTIFY], Y[:IDENTIFY]
    P, residual, V, scores, A = fit(own, own, target)
    Pi, residual_i, Vi, scores_i, Ai = fit(own, instruments, target)
    both = long_run(np.hstack([scores_i, scores]))
    bread = np.hstack([Ai, -A])
    difference = np.sqrt(np.diag(bread @ both @ bread.T))
    held_out = Y[IDENTIFY:] - Z[IDENTIFY:] @ P
    vaf = 100.0 * (1.0 - held_out.var(axis=0, ddof=1) / Y[IDENTIFY:].var(axis=0, ddof=1))
    M, B, K = P[0:2].T, P[2:4].T, P[4:6].T

    lagged = np.hstack([instruments[500:]] + [reference.T[500 - lag:IDENTIFY - lag] for lag in range(100, 501, 100)])
    explained = lagged @ np.linalg.lstsq(lagged, residual[500:], rcond=None)[0]
    f, of_force = welch(force, RATE, nperseg=4000)
    _, of_reference = welch(reference, RATE, nperseg=4000)
    tremor = (f > 3) & (f < 14)
    bands = [coherence(force[k], position[k], RATE, nperseg=12500) for k in range(2)]
    w = 2 * np.pi * np.geomspace(0.1, 10, 200)
    damping = [np.linalg.eigvalsh((B + B.T) / 2 + (K - K.T) / 2j / one - (M - M.T) / 2j * one)[0] for one in w]
    scaled = own[:, :6] / own[:, :6].std(axis=0)
    return {
        "M": M.tolist(),
        "B": B.tolist(),
        "K": K.tolist(),
        "x0": (-np.linalg.solve(K, P[6])).tolist(),
        "VAF": vaf.tolist(),
        "standard_errors": np.sqrt(np.diag(V)).tolist(),
        "instrumental": Pi.tolist(),
        "instrumental_errors": np.sqrt(np.diag(Vi)).tolist(),
        "strength": strength(own, instruments),
        "difference_over_its_error": (np.abs((Pi - P).T.ravel()) / difference).tolist(),
        "condition": float(np.linalg.cond(scaled)),
        "coherent_residual": (explained.var(axis=0) / residual[500:].var(axis=0)).tolist(),
        "assumptions": assumptions(own, target, K),
        "tremor": float((of_force[:, tremor] / of_reference[:, tremor].max()).max()),
        "coherence": [float(c[(b > 0.3) & (b < 4)].min()) for b, c in bands],
        "consistent": [nearest_semidefinite(one).tolist() for one in (M, B, K)],
        "ellipses": [ellipse(one) for one in (M, B, K)],
        "energy": energy(position, force, np.random.default_rng(1)),
        "least_damping": float(min(damping)),
    }


def main():
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        print(__doc__.strip())
        sys.exit(0 if sys.argv[1:] in (["-h"], ["--help"]) else 2)
    cpu = time.process_time()
    model = measure(sys.argv[1])
    model["cpu_seconds_after_imports"] = time.process_time() - cpu
    print(json.dumps(model))


if __name__ == "__main__":
    main()
