#!/usr/bin/env python3
"""numpy_pipeline.py on many recordings, several at a time, by joblib: what a skilled user would write for a study. With
--measure numpy_measure.py, which does the parts of `mbk measure`.

The workers are started, have imported NumPy and SciPy and have measured one file before the clock runs. Prints, as
JSON, the models in the order of the files, the wall time of all of them and the processor time of the workers.

usage: joblib_pipeline.py [--measure] --workers 2 LOG.mat ...
"""

import argparse
import json
import time

from joblib import Parallel, delayed

import numpy_measure
import numpy_pipeline


def measured(path, everything):
    """The model of one file, and the processor time that it took this worker."""
    start = time.process_time()
    if everything:
        model = numpy_measure.measure(path)
    else:
        model = numpy_pipeline.measure(path, numpy_pipeline.savitzky_golay)
    return model, time.process_time() - start


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--measure", action="store_true", help="all parts of mbk measure, not M, B and K alone")
    parser.add_argument("--workers", type=int, default=2, help="processes (2)")
    parser.add_argument("files", nargs="+", metavar="LOG.mat")
    arguments = parser.parse_args()
    with Parallel(n_jobs=arguments.workers) as parallel:
        parallel(delayed(measured)(arguments.files[0], arguments.measure) for _ in range(4 * arguments.workers))
        start = time.perf_counter()
        results = parallel(delayed(measured)(file, arguments.measure) for file in arguments.files)
        wall = time.perf_counter() - start
    print(
        json.dumps(
            {"models": [model for model, _ in results], "wall_s": wall, "cpu_s": sum(cpu for _, cpu in results)}
        )
    )


if __name__ == "__main__":
    main()
