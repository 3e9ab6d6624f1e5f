#!/usr/bin/env python3
"""A robot behind UDP that misbehaves: by hand, and as `mbk validate faults --link udp` runs it; and the page of it."""

import json
import pathlib
import subprocess

import schemas
from command import FALLS_SHORT, NOT_SHOWN, WRONG_USAGE, Case, main, program, run

ROOT = pathlib.Path(__file__).resolve().parents[2]
KINDS = ("latched-frozen-answer", "answer-frozen", "stays-on", "states-lost", "fault-code", "foreign-robot")


def robot(*arguments, **options):
    path = pathlib.Path(program("MBK")).parent / "mbk_misbehaving_robot"
    return subprocess.run([path, *arguments], capture_output=True, text=True, timeout=60, **options)


class MisbehavingRobot(Case):
    def test_says_what_it_can_do(self):
        lines = robot("--list").stdout.splitlines()
        self.assertGreaterEqual(len(lines), 40)
        for kind in KINDS:
            self.assertTrue(any(line.startswith(kind + " ") for line in lines), kind)

    def test_refuses_what_it_does_not_know(self):
        for arguments, words in ((("relaxed_sinusoidal", "--fault", "nonsense"), "nonsense"),
                                 (("no_such_scenario",), "no_such_scenario"), ((), "SCENARIO"),
                                 (("relaxed_sinusoidal", "--at", "-1"), "-1")):
            ran = robot(*arguments, "--port", "0")
            self.assertNotEqual(ran.returncode, 0)
            self.assertIn(words, ran.stderr + ran.stdout)

    def test_ends_by_itself(self):
        ran = robot("relaxed_sinusoidal", "--port", "0", "--for", "1")
        self.assertEqual(ran.returncode, 0)
        events = [json.loads(line) for line in ran.stdout.splitlines()]
        for event in events:
            schemas.check(event, "robot_event")
        self.assertEqual([event["event"] for event in events], ["listening", "end"])


class Study(Case):
    def test_a_few_kinds_in_real_time(self):
        faults = [word for kind in KINDS for word in ("--fault", kind)]
        # One moment shows no share of 99 %: it may fall short where a process was late, and is never met.
        ran = run("validate", "faults", "--link", "udp", "--runs", "1", "--quiet", "--json", *faults)
        self.assertIn(ran.code, (FALLS_SHORT, NOT_SHOWN), ran)
        rows = {row["what"]: row for row in ran.json["rows"]}
        self.assertEqual(rows["silently wrong about the motors"]["value"], 0, ran.out)
        self.assertEqual(rows["not recognised"]["value"], 0, ran.out)
        shares = [what for what in rows if what.startswith("recognised within the documented ticks")]
        self.assertEqual(len(shares), 1, ran.out)
        self.assertIn(rows[shares[0]]["verdict"], ("falls short", "not shown"))

    def test_belongs_to_faults_alone(self):
        self.refused(WRONG_USAGE, "validate", "springs", "--link", "udp", says="--link")
        self.refused(WRONG_USAGE, "validate", "faults", "--fault", "dies", says="--link")
        self.refused(WRONG_USAGE, "validate", "faults", "--link", "udp", "--fault", "nonsense", says="nonsense")
        self.refused(WRONG_USAGE, "validate", "springs", "--page", says="--page")

    def test_the_page_of_the_guide_is_that_of_the_tables(self):
        page = self.fine("validate", "faults", "--page").out
        self.assertEqual(page, (ROOT / "docs/guide/safety.md").read_text(),
                         "mbk validate faults --page > docs/guide/safety.md")


if __name__ == "__main__":
    main()
