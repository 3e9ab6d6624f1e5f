#!/usr/bin/env python3
"""Files that mbk does not read: every command that reads says what such a file is and how its data can be had."""

import gzip
import io
import lzma
import pickle
import sqlite3
import unittest
import zipfile

from command import Case, main


def zipped(*names):
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        for name in names:
            archive.writestr(name, "0,1\n")
    return packed.getvalue()


class LikelyFormat(Case):
    def test_every_reading_command_says_it(self):
        path = self.file("trial.csv", zipped("[Content_Types].xml", "xl/workbook.xml"))
        says = ("Excel", "CSV")
        for command in ("info", "measure", "identify", "passivity", "explore", "movement"):
            self.bad_data(path, command=command, says=says)
        self.bad_data(path, "--poles", "2", "--zeros", "1", command="tf", says=says)
        self.bad_data(path, self.folder / "out.h5", command="convert", says=says)
        self.assertEqual(self.names(), ["trial.csv"])

    def test_files_as_programs_write_them(self):
        with sqlite3.connect(self.folder / "bag.db3") as database:
            database.execute("create table topics (id integer)")
        for name, content, says in (
                ("a.ods", zipped("mimetypeapplication/vnd.oasis.opendocument.spreadsheet"), "OpenDocument"),
                ("a.zip", zipped("a.txt"), "archive"),
                ("a.csv.gz", gzip.compress(b"time,x\n0,1\n"), "gunzip"),
                ("a.csv.xz", lzma.compress(b"time,x\n0,1\n"), " xz"),
                ("a.pickle", pickle.dumps([1.0, 2.0]), "Python"),
                ("bag.db3", None, "SQLite"),
                ("a.slk", "ID;PWXL;N;E\nP;PGeneral\nC;Y1;X1;K\"t\"\n", "SYLK"),
                ("a.tdms", b"TDSm\x0e\0\0\0" + bytes(40), "nptdms"),
                ("a.pdf", b"%PDF-1.4\n%\xe2\xe3\xcf\xd3\n", "PDF"),
                ("a.json", '{"schema": "mbk.result/2"}', "JSON"),
                ("a.qtm", b"\x01\x02qtm" + bytes(90), "Qualisys")):
            with self.subTest(name):
                path = self.folder / name if content is None else self.file(name, content)
                self.bad_data(path, command="info", says=says)


if __name__ == "__main__":
    main()
