#!/usr/bin/env python3
"""Who may read what is computed from a recording: nobody who may not read the recording."""

import os

from command import Case, copy, main, make_log, run

SHARED, LABORATORY, PRIVATE = 0o644, 0o640, 0o600


def mode(path):
    return path.stat().st_mode & 0o777


class DerivedFiles(Case):
    def setUp(self):
        super().setUp()
        self.addCleanup(os.umask, os.umask(0o022))
        self.recording = copy(make_log("sinusoidal").path, self.folder / "trial.mat")
        self.number = 0

    def name(self, extension):
        self.number += 1
        return self.folder / f"out_{self.number}{extension}"

    def written(self, recording):
        """Every kind of file that is computed from one recording."""
        result, page, table, charts = self.name(".json"), self.name(".html"), self.name(".csv"), self.name("")
        pages = [] if "MBK_WEB" in run("measure", recording, "--report", self.name(".html")).err else [page]
        self.fine("measure", recording, "--json", "--out", result, "--summary", table, "--charts", charts,
                  *(["--report", page] if pages else []))
        files = [result, table, *pages, *charts.iterdir()]
        for words in (["info", recording], ["ellipse", result], ["passivity", result],
                      ["explore", recording, "--only", "frequency-response", "--quiet"]):
            files.append(self.name(".txt"))
            self.mbk(*words, "--out", files[-1])
        return files

    def test_have_the_permissions_of_the_recording(self):
        for given in (PRIVATE, LABORATORY, SHARED):
            self.recording.chmod(given)
            files = self.written(self.recording)
            self.assertGreater(len(files), 7)
            self.assertEqual({path.name: mode(path) for path in files}, {path.name: given for path in files})

    def test_are_as_private_as_the_most_private_recording(self):
        other = copy(make_log("sinusoidal", "--seed", "2").path, self.folder / "other.mat")
        other.chmod(SHARED)
        self.recording.chmod(PRIVATE)
        out = self.name(".json")
        self.fine("measure", other, self.recording, "--quiet", "--json", "--out", out)
        self.assertEqual(mode(out), PRIVATE)

    def test_of_a_folder_are_as_private_as_what_is_in_it(self):
        inner = self.folder / "trials"
        inner.mkdir()
        copy(self.recording, inner / "trial.mat").chmod(PRIVATE)
        out = self.name(".json")
        self.fine("measure", inner, "--json", "--out", out)
        self.assertEqual(mode(out), PRIVATE)

    def test_stay_private_where_the_umask_or_the_replaced_file_is(self):
        self.recording.chmod(SHARED)
        out = self.name(".json")
        os.umask(0o077)
        self.fine("measure", self.recording, "--json", "--out", out)
        self.assertEqual(mode(out), PRIVATE)
        os.umask(0o022)
        self.fine("measure", self.recording, "--json", "--out", out, "--overwrite")
        self.assertEqual(mode(out), PRIVATE)

    def test_of_another_group_are_for_their_owner_alone(self):
        others = sorted(set(os.getgroups()) - {os.getegid()}) or ([12345] if os.geteuid() == 0 else [])
        if not others:
            self.skipTest("this user is in one group alone")
        os.chown(self.recording, -1, others[0])
        self.recording.chmod(LABORATORY)
        out = self.name(".json")
        self.fine("measure", self.recording, "--json", "--out", out)
        self.assertEqual(mode(out), PRIVATE)


if __name__ == "__main__":
    main()
