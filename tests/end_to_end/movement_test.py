#!/usr/bin/env python3
"""mbk movement: reaches of a recording and their quality."""

import math

from command import BAD_DATA, WRONG_USAGE, Case, main


def minimum_jerk(t):
    t = min(max(t, 0.0), 1.0)
    return t ** 3 * (10 - 15 * t + 6 * t * t)


def write_reaches(path, columns=("x", "y", "Fx", "Fy"), move=1.0):
    """Two reaches of 0.2 m, there and back, in 6 s at 500 Hz, against 3 N along x."""
    lines = ["time," + ",".join(columns)]
    for i in range(3000):
        t = 0.002 * i
        way = 0.2 * move * (minimum_jerk(t - 1) - minimum_jerk(t - 3))
        values = {"x": 0.6 * way, "y": 0.8 * way, "Fx": -3.0, "Fy": 0.01 * math.sin(i)}
        lines.append(f"{t:.3f}," + ",".join(f"{values[name]:.9f}" for name in columns))
    path.write_text("\n".join(lines) + "\n")
    return path


class Reaches(Case):
    def test_are_found_and_measured(self):
        file = write_reaches(self.folder / "reaches.csv")
        found = self.fine("movement", "--json", file).json
        self.assertEqual(found["schema"], "mbk.movement/1")
        there, back = found["recordings"][0]["reaches"]
        for reach, work in ((there, 0.36), (back, -0.36)):
            self.assertEqual(reach["peaks"], 1)
            self.assertAlmostEqual(reach["peak_speed"], 0.375, delta=0.003)
            self.assertAlmostEqual(reach["path_ratio"], 1.0, delta=1e-3)
            self.assertAlmostEqual(reach["robot_work_J"], work, delta=0.01)
            self.assertAlmostEqual(reach["sparc"], -1.4, delta=0.05)
            self.assertIsNone(reach["endpoint_error"])
        self.assertAlmostEqual(there["begin_s"], 1.0, delta=0.1)
        self.assertAlmostEqual(there["end_s"], 2.0, delta=0.1)
        text = self.fine("movement", file).out
        self.assert_lines_fit(text)
        for words in ("2 reaches", "SPARC", "LDLJ", "median"):
            self.assertIn(words, text)

    def test_need_no_force(self):
        file = write_reaches(self.folder / "alone.csv", ("x", "y"))
        reach = self.fine("movement", "--json", file).json["recordings"][0]["reaches"][0]
        self.assertIsNone(reach["robot_work_J"])
        self.assertIsNone(reach["force_angle_deg"])


class Mistakes(Case):
    def test_are_refused_in_one_line(self):
        still = write_reaches(self.folder / "still.csv", move=0.0)
        self.refused(BAD_DATA, "movement", still, says=str(still))
        file = write_reaches(self.folder / "reaches.csv")
        self.refused(BAD_DATA, "movement", file, "--from", "1.3", "--to", "1.7", says="rest")
        self.refused(WRONG_USAGE, "movement", file, "--cutoff", "400", says="cutoff")
        self.refused(WRONG_USAGE, "movement", file, "--from", "5", "--to", "3", says="--from")


if __name__ == "__main__":
    main()
