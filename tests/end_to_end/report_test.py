#!/usr/bin/env python3
"""mbk measure --report: one file that needs nothing else, and what is refused. How it looks and reads: tests/web."""

import json
import re
import shutil

import schemas
from command import BAD_DATA, FINE, NOT_USABLE, WRONG_USAGE, Case, copy, main, make_log, run

DATA = re.compile(r'<script type="application/json" id="report-data">(.*?)</script>', re.DOTALL)


def document_of(path):
    """What a report holds for machines."""
    document = json.loads(DATA.search(path.read_text(encoding="utf-8")).group(1))
    schemas.check(document)
    return document


class Report(Case):
    def setUp(self):
        super().setUp()
        self.path = self.folder / "report.html"
        if "MBK_WEB" in run("measure", "nothing.mat", "--report", self.path).err:
            self.skipTest("this mbk was built without the page")

    def test_it_holds_the_result_that_json_prints(self):
        ran = self.fine("measure", "--json", make_log().path, "--report", self.path)
        document = document_of(self.path)
        self.assertEqual(document["schema"], "mbk.report/1")
        self.assertEqual(document["result"], ran.json)
        self.assertEqual(len(document["trials"]), 1)

    def test_several_files_give_one_report(self):
        logs = [make_log().path, make_log("underdamped").path]
        ran = self.fine("measure", "--json", "--quiet", *logs, "--report", self.path)
        document = document_of(self.path)
        self.assertEqual(document["result"], ran.json)
        self.assertEqual([len(trial["recordings"]) for trial in document["trials"]], [1, 1])
        self.fine("measure", "--pool", *logs, "--report", self.path, "--overwrite")
        self.assertEqual([len(trial["recordings"]) for trial in document_of(self.path)["trials"]], [2])

    def test_it_does_not_change_what_is_printed(self):
        plain = self.fine("measure", make_log().path).out
        self.assertEqual(self.fine("measure", make_log().path, "--report", self.path).out, plain)

    def test_it_repeats_the_command_so_that_a_shell_takes_it_back(self):
        log = copy(make_log().path, self.folder / "a b's.mat")
        self.fine("measure", log, "--cutoff", "none", "--report", self.path)
        self.assertEqual(document_of(self.path)["command"],
                         f"mbk measure '{self.folder}/a b'\\''s.mat' --cutoff none --report {self.path}")

    def test_a_note_stands_in_it_and_needs_a_report(self):
        note = "Ward 3, </script> 4 May"
        self.fine("measure", make_log().path, "--report", self.path, "--report-note", note)
        self.assertEqual(document_of(self.path)["note"], note)
        self.refused(WRONG_USAGE, "measure", make_log().path, "--report-note", note, says="--report")

    def test_a_simulated_arm_tells_where_it_is_and_the_report_draws_it(self):
        log = self.folder / "arm.mat"
        self.fine("simulate", "relaxed_underdamped", "--out", log, "--blind", "--quiet")
        self.fine("measure", log, "--report", self.path)
        (recording,) = document_of(self.path)["trials"][0]["recordings"]
        self.assertEqual(recording["posture"]["of"], "arm")
        shoulder, _, hand = recording["posture"]["points_m"]
        self.assertEqual(shoulder, [0.3, -0.57])
        self.assertAlmostEqual(hand[0], 0.3, delta=0.005)  # the pulses move it by a few millimetres
        self.assertAlmostEqual(hand[1], -0.05, delta=0.005)

    def test_a_result_that_is_not_usable_is_reported_too(self):
        self.mbk("measure", "--handle-mass", "5", make_log().path, "--report", self.path, code=NOT_USABLE)
        self.assertIs(document_of(self.path)["result"]["usable"], False)

    def test_the_same_command_gives_the_same_bytes(self):
        command = ("measure", make_log().path, "--report", self.path, "--overwrite")
        self.fine(*command)
        first = self.path.read_bytes()
        self.fine(*command)
        self.assertEqual(self.path.read_bytes(), first)

    def test_it_is_not_replaced_unasked(self):
        self.path.write_text("kept")
        self.refused(WRONG_USAGE, "measure", make_log().path, "--report", self.path,
                     says=[str(self.path), "--overwrite"])
        self.assertEqual(self.path.read_text(), "kept")
        self.fine("measure", make_log().path, "--report", self.path, "--overwrite")
        self.assertIn("mbk.report/1", self.path.read_text(encoding="utf-8"))

    def test_it_never_replaces_what_is_read(self):
        log = copy(make_log().path, self.folder / "log.mat")
        self.refused(WRONG_USAGE, "measure", log, "--report", log, "--overwrite", says=[str(log), "--report"])
        self.assertEqual(run("info", log).code, FINE)

    def test_out_and_report_are_two_files(self):
        self.refused(WRONG_USAGE, "measure", make_log().path, "--out", self.path, "--report", self.path,
                     says=["--out", "--report"])

    def test_overwrite_without_anything_to_write(self):
        self.refused(WRONG_USAGE, "measure", make_log().path, "--overwrite", says=["--out", "--report"])

    def test_bad_data_leave_nothing_behind(self):
        bad = self.file("bad.csv", "x,y\n1,2\n")
        self.refused(BAD_DATA, "measure", bad, "--report", self.path)
        self.assertEqual(self.names(), ["bad.csv"])

    def test_a_folder_that_is_not_there(self):
        self.refused(BAD_DATA, "measure", make_log().path, "--report", self.folder / "none" / "r.html", says="none")

    def test_a_name_that_ends_in_pdf_gives_a_pdf(self):
        pdf = self.folder / "report.pdf"
        if any(shutil.which(name) for name in ("chromium", "chromium-browser", "chromium-headless-shell", "google-chrome")):
            self.fine("measure", make_log().path, "--report", pdf)
            self.assertTrue(pdf.read_bytes().startswith(b"%PDF"))
        nowhere = run("measure", make_log().path, "--report", self.folder / "none.pdf", environment={"PATH": "/nonexistent"})
        self.assertEqual(nowhere.code, WRONG_USAGE, nowhere.err)
        self.assertIn("browser", nowhere.err)
        self.assertFalse((self.folder / "none.pdf").exists())

    def test_identify_has_no_report(self):
        self.refused(WRONG_USAGE, "identify", make_log().path, "--report", self.path)


if __name__ == "__main__":
    main()
