#!/usr/bin/env python3
"""STOP while the console is flooded, and the page for its token's holder: each flood of floods.py, a few stops.

MBK_STOPS sets how many stops there are during each (2); what is told of times is not judged.
"""

import os
import pathlib
import resource
import sys

import floods
from command import Case, main, program

STOPS = int(os.environ.get("MBK_STOPS", "2"))
MOST_LOGGED = 8000.0  # bytes a second; six lines of each kind in ten seconds, and the page's holder refused nowhere


def has_console():
    with floods.tempfile.TemporaryDirectory() as folder:
        try:
            floods.Run(program("MBK"), pathlib.Path(folder)).end()
            return True
        except floods.Refused as error:
            if "MBK_WEB" in str(error):
                return False
            raise


class Floods(Case):
    def flooded(self, flood):
        measured = floods.measure(program("MBK"), flood, STOPS)
        print(floods.HEADER, file=sys.stderr)
        print(measured.line(flood.__name__ if flood else "none"), file=sys.stderr)
        self.assertEqual(measured.failures, [])
        self.assertEqual((measured.asked, measured.obeyed), (STOPS, STOPS))
        self.assertEqual(measured.loaded, measured.loads)
        self.assertLess(measured.log_bytes_per_s, MOST_LOGGED)

    def test_out_of_descriptors_it_still_stops(self):
        """With few descriptors, which half-open connections take."""
        before = resource.getrlimit(resource.RLIMIT_NOFILE)
        with floods.tempfile.TemporaryDirectory() as folder:
            run = floods.Run(program("MBK"), pathlib.Path(folder),
                             preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (64, before[1])))
            held = []
            try:
                operator = floods.Operator(run.port, run.token)
                operator.wait("the question", lambda state: state["question"] == "begin")
                held = [floods.connected(run.port) for _ in range(200)]
                operator.tell("start")
                floods.Measured().stop(run, operator, floods.random.Random(1))
            finally:
                for one in held:
                    one.close()
                run.end()


for each in [None, *floods.FLOODS]:
    name = each.__name__ if each else "no_flood"
    setattr(Floods, f"test_{name}", lambda self, flood=each: self.flooded(flood))


if __name__ == "__main__":
    if sys.platform != "linux" or not has_console():
        sys.exit(77)
    main()
