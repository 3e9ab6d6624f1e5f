#!/usr/bin/env python3
"""How much memory a measurement takes, and what happens where it would not fit."""

import array
import math
import resource
import struct
import subprocess
import sys
import zlib

from command import BAD_DATA, Case, Ran, main, program

ROWS = 19
MIB = 1 << 20
LARGEST = 64e6  # [bytes]


def element(kind, data):
    return struct.pack("<II", kind, len(data)) + data + b"\0" * (-len(data) % 8)


def matrix(columns, data):
    """A variable `logs` of 19 rows, MAT v5."""
    body = element(6, struct.pack("<II", 6, 0)) + element(5, struct.pack("<ii", ROWS, columns)) + element(1, b"logs")
    return struct.pack("<II", 14, len(body) + 8 + len(data)) + body + struct.pack("<II", 9, len(data)) + data


def packed(data):
    return struct.pack("<II", 15, len(data)) + data


def header():
    return b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<H2s", 0x0100, b"IM")


def log(columns):
    """A motion of two axes against springs, with noise that does not shrink when it is packed."""
    values = array.array("d", bytes(8 * ROWS * columns))
    state = 1
    for i in range(columns):
        t = i / 1000.0
        x, y = 0.01 * math.sin(7.0 * t) + 0.004 * math.sin(17.0 * t), 0.01 * math.sin(5.0 * t + 1.0)
        state = (state * 6364136223846793005 + 1442695040888963407) % (1 << 64)
        noise = state / (1 << 64) - 0.5
        row = ROWS * i
        values[row], values[row + 1], values[row + 2] = t, x + 1e-7 * noise, y - 1e-7 * noise
        values[row + 9], values[row + 10] = -100.0 * x + 0.01 * noise, -80.0 * y + 0.01 * noise
        values[row + 11], values[row + 12] = x, y
    return values.tobytes()


# A process counts the pages of the one that started it until its program begins: start it from a small one.
STARTER = """
import resource, subprocess, sys
code = subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL).returncode
print(code, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024)
"""


def run_and_weigh(*command):
    """Exit code and the most memory [bytes] that a command took."""
    ran = subprocess.run([sys.executable, "-c", STARTER, *command], capture_output=True, text=True, check=True)
    return (int(value) for value in ran.stdout.split())


def table(minutes):
    """The same motion as a table of seven columns at 1 kHz, whole periods of 10 s one after the other."""
    period = []
    for i in range(10_000):
        angle = 2.0 * math.pi * i / 10_000
        x, y = 0.01 * math.sin(3.0 * angle) + 0.004 * math.sin(11.0 * angle), 0.01 * math.sin(5.0 * angle + 1.0)
        noise = math.sin(1e4 * math.sin(1e4 * i))
        period.append(f",{x + 1e-7 * noise:.9f},{y - 1e-7 * noise:.9f},{-100.0 * x + 0.01 * noise:.6f},"
                      f"{-80.0 * y + 0.01 * noise:.6f},{x:.9f},{y:.9f}\n")
    yield "time,hand_x,hand_y,force_x,force_y,reference_x,reference_y\n"
    for k in range(6 * minutes):
        yield "".join(f"{10 * k + i // 1000}.{i % 1000:03}{line}" for i, line in enumerate(period))


class Memory(Case):
    def test_of_a_long_table_it_grows_by_less_than_twice_the_numbers(self):
        columns, peaks = 7, []
        for minutes in (10, 20):
            path = self.folder / f"{minutes}.csv"
            with path.open("w", encoding="utf-8") as file:
                file.writelines(table(minutes))
            code, peak = run_and_weigh(program("MBK"), "measure", path, "--json")
            self.assertIn(code, (0, 4))
            peaks.append(peak)
        numbers = 10 * 60_000 * columns * 8
        self.assertLessEqual(peaks[1] - peaks[0], 2 * numbers, peaks)
        self.assertLessEqual(peaks[1], 2 * numbers * 2 + 64 * MIB, peaks)

    def test_of_many_files_it_is_that_of_those_measured_at_a_time(self):
        data = log(60_000)
        first = self.file("0.mat", header() + matrix(60_000, data))
        paths = [first, *(self.folder / f"{k}.mat" for k in range(1, 40))]
        for path in paths[1:]:
            path.hardlink_to(first)
        (_, little), (_, much) = (run_and_weigh(program("MBK"), "measure", *some, "--json", "--quiet",
                                                "--threads", "2") for some in (paths[:4], paths))
        # Results stay until the last file is measured, some 0.2 MB each.
        self.assertLessEqual(much - little, 2 * len(data), "36 files more take less than two of them")

    def test_of_a_minute_it_is_64_MB_at_most(self):
        """62 s of nineteen rows at 1 kHz, packed into 4 MB."""
        log = self.folder / "log.mat"
        subprocess.run([program("MAKE_LOG"), "--protocol", "sinusoidal", "--seed", "1", "--out", log], check=True,
                       stdout=subprocess.DEVNULL)
        for command in ("identify", "measure"):
            code, peak = run_and_weigh(program("MBK"), command, log, "--json")
            self.assertEqual(code, 0)
            self.assertLessEqual(peak, LARGEST, command)

    def test_at_most_three_times_the_numbers_and_32_MiB(self):
        data = log(200_000)
        for name, content in (("plain.mat", matrix(200_000, data)),
                              ("packed.mat", packed(zlib.compress(matrix(200_000, data), 1)))):
            path = self.file(name, header() + content)
            code, peak = run_and_weigh(program("MBK"), "measure", path, "--json")
            self.assertIn(code, (0, 4))
            self.assertLessEqual(peak, 3 * len(data) + 32 * MIB, name)

    def test_what_would_not_fit_is_refused_with_what_it_needs(self):
        columns = 4_000_000  # 0.57 GiB, packed into some hundred kilobytes
        packer = zlib.compressobj(1)
        size = 8 * ROWS * columns
        start = matrix(columns, b"\0" * 8)[:-8]
        start = start[:4] + struct.pack("<I", len(start) - 8 + size) + start[8:-4] + struct.pack("<I", size)
        content = packer.compress(start) + b"".join(packer.compress(b"\0" * MIB) for _ in range(size // MIB))
        content += packer.compress(b"\0" * (size % MIB)) + packer.flush()
        path = self.file("large.mat", header() + packed(content))

        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (700 * MIB, 700 * MIB))

        process = subprocess.run([program("MBK"), "info", path], capture_output=True, preexec_fn=limit, check=False)
        ran = Ran(process, "mbk info large.mat")
        self.assertEqual(ran.code, BAD_DATA, ran)
        self.assertRegex(ran.err, r"\Ambk: .*large\.mat.*: [^\n]*1\.13 GiB[^\n]*0\.\d\d GiB[^\n]*; [^\n]+\n\Z", ran)


if __name__ == "__main__":
    if sys.platform != "linux":
        sys.exit(77)
    main()
