#!/usr/bin/env python3
"""Files made to cost time or memory: each is answered within seconds, in little more memory than an honest one takes."""

import gzip
import os
import resource
import struct
import subprocess
import time
import zipfile

from command import BAD_DATA, FINE, Case, main, program

SECONDS = 30  # on a machine that is busy; each takes about one
MEGABYTES = 1500
GIGABYTE = 1 << 30


def gzipped(path, head, zeros):
    with gzip.open(path, "wb", 1) as file:
        file.write(head)
        for _ in range(zeros >> 24):
            file.write(bytes(1 << 24))
    return path


def npy_header(count):
    text = f"{{'descr': '<f8', 'fortran_order': False, 'shape': ({count},), }}".ljust(117) + "\n"
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text.encode()


def npz(path, names, zeros):
    """Each array of so many bytes of zeros."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
        for name in names:
            with archive.open(f"{name}.npy", "w", force_zip64=True) as file:
                file.write(npy_header(zeros // 8))
                for _ in range(zeros >> 24):
                    file.write(bytes(1 << 24))
    return path


def xdf_chunk(tag, content):
    return b"\x04" + struct.pack("<IH", len(content) + 2, tag) + content


def xdf_header(stream):
    return xdf_chunk(2, struct.pack("<I", stream) + (
        f"<?xml version='1.0'?><info><name>same</name><type>EEG</type><channel_count>1</channel_count>"
        f"<nominal_srate>100</nominal_srate><channel_format>float32</channel_format></info>").encode())


BODY = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
XDF = b"XDF:" + xdf_chunk(1, b"<?xml version='1.0'?><info><version>1.0</version></info>")


class Bounded(Case):
    def bounded(self, *words, code=BAD_DATA, says=()):
        """Runs mbk with its memory limited; it must not be the limit that ends it."""
        def limit():
            resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS))

        began = time.monotonic()
        process = subprocess.Popen([program("MBK"), *map(str, words)], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, preexec_fn=limit, cwd=self.folder)
        try:
            out, err = process.communicate(timeout=4 * SECONDS)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
            self.fail(f"{words} does not end")
        self.assertEqual(process.returncode, code, (words, err[-600:]))
        for word in [says] if isinstance(says, str) else says:
            self.assertIn(word, (out + err).decode())
        self.assertLess(time.monotonic() - began, 4 * SECONDS)
        return out.decode(), err.decode()

    def peak(self, *words, **options):
        """The most memory [MB] that a command took."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
        self.bounded(*words, **options)
        after = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
        return max(before, after) / 1024

    def test_gzip_of_three_gigabytes_of_zeros(self):
        plain = gzipped(self.folder / "zeros.gz", b"", 3 * GIGABYTE)
        self.bounded("info", plain, says="gzip")
        bomb = gzipped(self.folder / "bomb.xdfz", XDF, 3 * GIGABYTE)
        self.assertLess(self.peak("info", bomb, says=("gzip", " MB")), MEGABYTES)
        # What the trailer says is not believed.
        lying = bytearray(bomb.read_bytes())
        lying[-4:] = struct.pack("<I", 1000)
        bomb.write_bytes(lying)
        self.assertLess(self.peak("info", bomb, says=("gzip", " MB")), MEGABYTES)

    def test_npz_of_three_gigabytes(self):
        for names, each in ((["x"], 3 * GIGABYTE), ([f"x{k}" for k in range(12)], GIGABYTE // 4)):
            bomb = npz(self.folder / f"{len(names)}.npz", names, each)
            self.assertLess(self.peak("info", bomb, says=" MB"), MEGABYTES)

    def test_an_entry_of_a_kinarm_exam_of_two_and_a_half_gigabytes(self):
        exam = self.folder / "exam.kinarm"
        with zipfile.ZipFile(exam, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
            archive.writestr("raw/common/parameters.bin", struct.pack("<i", 3))
            with archive.open("raw/01_01_01/Right_HandX.kinematics", "w", force_zip64=True) as file:
                for _ in range(5 * GIGABYTE // 2 >> 24):
                    file.write(bytes(1 << 24))
        self.assertLess(self.peak("info", exam, says=" MB"), MEGABYTES)

    def test_xdf_of_fifty_thousand_headers(self):
        same = self.file("same.xdf", XDF + b"".join(xdf_header(1) for _ in range(50_000)))
        self.bounded("info", same)
        sample = bytes([1, 1, 8]) + struct.pack("<df", 1.0, 2.0)
        each = self.file("each.xdf", XDF + b"".join(xdf_header(k + 1) for k in range(50_000)) + b"".join(
            xdf_chunk(3, struct.pack("<I", k + 1) + sample) for k in range(50_000)))
        self.bounded("info", each, code=FINE)
        _, err = self.bounded("measure", each, says="channel")
        self.assertLess(len(err), 5000, "an error names some of them, not all")

    def test_urdf_of_two_hundred_thousand_attributes(self):
        many = " ".join(f'a{k}="1"' for k in range(200_000))
        self.file("robot.toml", '[robot]\nkind = "urdf"\nfile = "robot.urdf"\n')
        for urdf in (f'<robot name="r" {many}><link name="a"/></robot>',
                     f'<robot name="r"><link name="a"/><link name="b" {many}/></robot>'):
            self.file("robot.urdf", urdf)
            self.bounded("robot", "describe", "robot.toml", says="1000 attributes")
        honest = ('<robot name="r"><!-- ' + many + ' --><link name="a"/><link name="b">' + BODY + '</link><joint name="j" type="revolute">'
                  '<parent link="a"/><child link="b"/><axis xyz="0 0 1"/>'
                  '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>')
        self.file("robot.urdf", honest)
        self.bounded("robot", "describe", "robot.toml", code=FINE)

    def test_a_pipe_that_nobody_writes(self):
        pipe = self.folder / "pipe.h5"
        os.mkfifo(pipe)
        study = self.folder / "study"
        self.mbk("study", "init", study)
        log = self.file("log.csv", "time,x,F\n" + "".join(f"{k / 100},{k % 7},{k % 5}\n" for k in range(300)))
        for words in (["info", pipe], ["measure", pipe], ["explore", pipe], ["movement", pipe], ["passivity", pipe],
                      ["convert", pipe, "out.h5"], ["compare", pipe, pipe], ["ellipse", pipe], ["recover", pipe],
                      ["simulate", pipe, "--out", "out.h5"], ["run", pipe], ["teleop", pipe], ["robot", "describe", pipe],
                      ["measure", log, "--force-source", "virtual", "--robot", pipe], ["measure", log, "--sensor", pipe],
                      ["new", "channels", pipe], ["study", "add", pipe, "--participant", 1, "--study", study],
                      ["study", "import", pipe, "--study", study]):
            with self.subTest(words=words):
                self.bounded(*words)


if __name__ == "__main__":
    main()
