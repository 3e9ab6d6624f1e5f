#!/usr/bin/env python3
"""mbk recover on journals that were damaged, and sessions whose journal somebody takes away."""

import csv
import math
import os
import pathlib
import random
import signal
import subprocess
import time

import journal_file
from command import BAD_DATA, FINE, Case, main, program, run

SAFETY_STOP = 5
DAMAGED = int(os.environ.get("MBK_DAMAGED", "24"))
SEED = 3

EXPERIMENT = """
[recording]
readable_by = "{readers}"
[session]
soft_start_s = 0.3
shortest_move_s = 0.3
settle_s = 0.1
[control]
kind = "position"
[perturbation]
kind = "multisine"
peak_deg = 2
duration_s = 4
moving_in_s = 1
[participant]
kind = "arm"
number = 1
"""


def mode(path):
    return path.stat().st_mode & 0o777


class Recover(Case):
    def journal(self, data, name="trial"):
        path = self.folder / f"{name}.h5.journal"
        path.write_bytes(data)
        return path

    def rows(self, recording):
        """The recording as mbk convert writes it: column → numbers."""
        table = self.folder / "table.csv"
        self.mbk("convert", recording, table, "--overwrite")
        with open(table, encoding="utf-8") as lines:
            rows = csv.reader(line for line in lines if not line.startswith("#"))
            names = next(rows)
            return dict(zip(names, zip(*([float(number) for number in row] for row in rows))))

    def check_rows(self, recording, ticks, count):
        """Every row is its tick to the bit, or NaN."""
        table = self.rows(recording)
        self.assertEqual(len(table["time_s"]), count)
        for number in range(count):
            row = [table[name][number] for name in ("joint_1_rad", "joint_2_rad", "force_x_N", "force_y_N")]
            if number in ticks:
                self.assertEqual(row, list(ticks[number][4:8]))
                self.assertEqual(table["time_s"][number], ticks[number][1])
            else:
                self.assertTrue(all(math.isnan(values[number]) for name, values in table.items() if name != "time_s"))
                self.assertAlmostEqual(table["time_s"][number], 1e-3 * number, places=9)

    def test_a_whole_journal_becomes_a_recording_and_goes(self):
        for second in (True, False):
            pieces = journal_file.pieces(8, second=second)
            journal = self.journal(b"".join(pieces))
            ran = self.fine("recover", journal)
            self.assertRegex(ran.out, r"400 samples, 0\.399 s; completed\n\Z")
            self.assertFalse(journal.exists())
            recording = self.folder / "trial.h5"
            self.assertEqual(mode(recording), 0o600)
            ticks = {n: one for piece in pieces for n, one in journal_file.ticks_of(piece).items()}
            self.check_rows(recording, ticks, 400)
            recording.unlink()

    def test_one_flipped_bit_costs_one_block_and_is_said_everywhere(self):
        for second in (True, False):
            pieces = journal_file.pieces(40, second=second)
            data = bytearray(b"".join(pieces))
            data[sum(map(len, pieces[:12])) + 3000] ^= 4
            journal = self.journal(data)
            recording = self.folder / "trial.h5"
            shown = self.fine("info", journal)
            for fact in ("50 ticks", "500 to 549", "50 samples", "sample 501", "0.500 s"):
                self.assertIn(fact, " ".join(shown.out.split()))
            ran = self.mbk("recover", journal, code=BAD_DATA)
            for words in ("2000 samples", "completed, but 50 of 2000 ticks were lost", "50 ticks are missing: 500 to 549",
                          "the journal is kept"):
                self.assertIn(words, " ".join(ran.out.split()))
            self.assertRegex(ran.err, r"\Ambk: [^\n]+50 of 2000 ticks were lost; [^\n]+\n\Z")
            self.assert_lines_fit(ran.out)
            self.assertEqual(journal.read_bytes(), data)
            facts = self.fine("info", "--json", recording).json
            self.assertEqual(facts["metadata"]["ended"], "completed, but 50 of 2000 ticks were lost")
            self.assertEqual(facts["metadata"]["ticks_lost"], "50")
            self.assertEqual(facts["metadata"]["gaps"], "500 to 549")
            self.assertEqual(facts["missing"], [{"first_sample": 501, "count": 50, "time_s": 0.5}])
            self.assertIn("50 samples", self.fine("info", recording).out)
            ticks = {n: one for piece in pieces for n, one in journal_file.ticks_of(piece).items()
                     if not 500 <= n < 550}
            self.check_rows(recording, ticks, 2000)
            before = recording.read_bytes()
            self.mbk("recover", journal, code=BAD_DATA)  # as often as one likes
            self.assertEqual(recording.read_bytes(), before)
            recording.unlink()

    def test_what_was_lost_is_not_measured_across(self):
        pieces = journal_file.pieces(80)
        del pieces[30]
        self.mbk("recover", self.journal(b"".join(pieces)), code=BAD_DATA)
        recording = self.folder / "trial.h5"
        for command in (("measure",), ("identify",), ("passivity",), ("tf", "--poles", 2, "--zeros", 1, "--input", "force_x", "--output", "hand_x"), ("robot", "force"), ("robot", "identify")):
            with self.subTest(command=command):
                ran = self.mbk(*command, recording, code=BAD_DATA)
                self.assertRegex(ran.err, r"\bsample 1401\b", ran)
                self.assertIn("--from", ran.err)
        # a window without the gap is not refused for it
        ran = run("measure", recording, "--from", 1.5, "--protocol", "free")
        self.assertNotIn("sample 1401", ran.err)

    def test_damaged_at_random_every_whole_block_comes_back_and_every_loss_is_said(self):
        lot = random.Random(SEED)
        for k in range(DAMAGED):
            pieces = journal_file.pieces(20, 40, second=k % 3 != 2)
            kept = list(pieces)
            for _ in range(lot.randint(1, 3)):
                where = lot.randrange(len(kept))
                what = lot.choice(("flip", "lose", "double", "swap", "tear", "zero", "noise"))
                if what == "flip":
                    bits = bytearray(kept[where])
                    bits[lot.randrange(len(bits))] ^= 1 << lot.randrange(8)
                    kept[where] = bytes(bits)
                elif what == "lose":
                    del kept[where]
                elif what == "double":
                    kept.insert(lot.randrange(len(kept) + 1), kept[where])
                elif what == "swap":
                    other = lot.randrange(len(kept))
                    kept[where], kept[other] = kept[other], kept[where]
                elif what == "tear":
                    kept[where] = kept[where][:lot.randrange(len(kept[where]))]
                elif what == "zero":
                    kept[where] = bytes(len(kept[where]))
                else:
                    kept.insert(where, lot.randbytes(lot.randint(1, 5000)))
            data = b"".join(kept)
            with self.subTest(k=k):
                journal = self.journal(data, f"trial_{k}")
                whole = [piece for piece in pieces[1:] if piece in data]
                ticks = {n: one for piece in whole for n, one in journal_file.ticks_of(piece).items()}
                header = any(b'"tick_bytes"' in piece for piece in whole)
                ran = run("recover", journal)
                lost = len(ticks) < 800
                self.assertEqual(ran.code, BAD_DATA if lost or not header else FINE, ran)
                if lost:
                    self.assertRegex(ran.out, "ticks were lost|ticks may have been lost|interrupted")
                if data != b"".join(pieces):
                    self.assertTrue(journal.exists(), "a journal that is not as it was written is kept")
                recording = self.folder / f"trial_{k}.h5"
                facts = self.fine("info", "--json", recording).json
                self.assertEqual(facts["samples"] - int(facts["metadata"].get("ticks_lost", 0)), len(ticks))
                self.check_rows(recording, ticks, facts["samples"])

    def test_the_beginning_of_the_file_is_not_needed(self):
        data = bytearray(b"".join(journal_file.pieces(8)))
        data[:4096] = bytes(4096)
        ran = self.mbk("recover", self.journal(data), code=BAD_DATA)
        self.assertIn("completed, but", ran.out)
        self.assertEqual(self.fine("info", "--json", self.folder / "trial.h5").json["metadata"]["participant"], "7")

    def test_without_any_header_the_ticks_are_saved(self):
        pieces = journal_file.pieces(8, second=False)
        del pieces[1]
        ran = self.mbk("recover", self.journal(b"".join(pieces)), code=BAD_DATA)
        self.assertIn("header", ran.out)
        table = self.rows(self.folder / "trial.h5")
        self.assertEqual(len(table["joint_1_rad"]), 400)
        self.assertFalse([name for name in table if name.startswith(("hand", "reference"))])

    def test_who_may_read_it(self):
        for option, expected in ((None, 0o600), ("group", 0o640), ("all", 0o644)):
            journal = self.journal(b"".join(journal_file.pieces(2)))
            self.fine("recover", journal, *(("--readable-by", option) if option else ()))
            recording, copy = self.folder / "trial.h5", self.folder / "copy.csv"
            self.assertEqual(mode(recording), expected)
            self.fine("convert", recording, copy)
            self.assertEqual(mode(copy), 0o600)
            recording.unlink()
            copy.unlink()

    def session(self, *options, readers="owner"):
        experiment = self.file("experiment.toml", EXPERIMENT.format(readers=readers))
        target = self.folder / "session.h5"
        process = subprocess.Popen([program("MBK"), "run", experiment, "--out", target, "--no-measure", *options],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        journal = pathlib.Path(f"{target}.journal")
        until = time.monotonic() + 60
        while not (journal.exists() and journal.stat().st_size > 50_000) and time.monotonic() < until:
            time.sleep(0.01)
        return process, target, journal

    def test_a_session_writes_what_is_described(self):
        process, target, journal = self.session(readers="group")
        self.assertEqual(mode(journal), 0o640)
        process.send_signal(signal.SIGKILL)
        process.communicate()
        blocks = list(journal_file.walk(journal.read_bytes()))
        self.assertEqual([number for _, _, number, _ in blocks], list(range(len(blocks))))
        numbers = [n for kind, payload, _, _ in blocks if kind == journal_file.TICKS
                   for n in (journal_file.TICK.unpack_from(payload, at)[0] for at in range(0, len(payload), 144))]
        self.assertEqual(numbers, list(range(len(numbers))))
        ran = self.mbk("recover", journal)
        self.assertIn(f"{len(numbers)} samples", ran.out)
        self.assertEqual(mode(target), 0o640)

    def test_a_journal_that_is_taken_away_stops_the_robot_and_nothing_is_lost(self):
        for replaced in (False, True):
            process, target, journal = self.session("--quiet")
            if replaced:
                other = self.file("other", "another file")
                other.rename(journal)
            else:
                journal.unlink()
            out, err = process.communicate(timeout=60)
            self.assertEqual(process.returncode, SAFETY_STOP, out + err)
            self.assertIn(str(journal), out)
            facts = self.fine("info", "--json", target).json
            self.assertEqual(facts["metadata"]["ended"], "safety stop")
            self.assertRegex(out, rf"\b{facts['samples']} ticks, 0 dropped")
            self.assertEqual(facts["missing"], [])
            expected = ["experiment.toml", "session.h5"] + ([journal.name] if replaced else [])
            self.assertEqual(self.names(), expected)
            target.unlink()
            if replaced:
                self.assertEqual(journal.read_text(), "another file")
                journal.unlink()

    def test_a_journal_that_is_damaged_while_it_is_written_is_no_completed_trial(self):
        process, target, journal = self.session("--quiet")
        with open(journal, "r+b") as stream:
            stream.seek(20_000)
            stream.write(bytes(100))
        out, err = process.communicate(timeout=60)
        self.assertEqual(process.returncode, BAD_DATA, out + err)
        self.assertRegex(out, r"completed, but \d+ of \d+ ticks were lost")
        self.assertIn("ticks were lost", err)
        self.assertTrue(journal.exists())
        facts = self.fine("info", "--json", target).json
        self.assertRegex(facts["metadata"]["ended"], "completed, but ")
        self.assertEqual(sum(gap["count"] for gap in facts["missing"]), int(facts["metadata"]["ticks_lost"]))


if __name__ == "__main__":
    main()
