#!/usr/bin/env bash
# From a table of numbers, as a laboratory has it, to M, B, K and x0 with intervals.
#   usage: run.sh [FOLDER]    where the files go; without it a new temporary folder
set -euo pipefail
mbk=${MBK:-mbk}                            # the program: from PATH, or named by MBK
out=${1:-$(mktemp --directory)}
mkdir -p "$out"

# Here a simulated robot and arm stand for yours. --blind leaves the truth out of the file: it looks like any recording.
"$mbk" simulate relaxed_sinusoidal --blind --overwrite --quiet --out "$out/session.csv"

# Most laboratories have columns without names. These are time [s], hand x, y [mm], force x, y [N], reference x, y [mm].
# The robot and the force have mbk's signs: F is what the hand exerts on the robot.
awk -F, '/^#/ { next }
  !named { for (i = 1; i <= NF; i++) column[$i] = i; named = 1; next }
  { print $column["time_s"] "," 1e3 * $column["hand_x_m"] "," 1e3 * $column["hand_y_m"] "," $column["force_x_N"] "," \
      $column["force_y_N"] "," 1e3 * $column["reference_x_m"] "," 1e3 * $column["reference_y_m"] }' \
  CONVFMT=%.9g "$out/session.csv" > "$out/mine.csv"
channels=time=1,x=2:mm,y=3:mm,Fx=4,Fy=5,xr=6:mm,yr=7:mm

# 1. Look before you measure: rate, gaps, ranges, and what is wrong with the file, in SI units.
"$mbk" info --channels "$channels" "$out/mine.csv"

# 2. Measure: M [kg], B [N·s/m], K [N/m], x0 [mm], each with its 95 % interval. The handle between sensor and hand has
#    0.194 kg, which is not the arm's. mbk says so where a result must not be used, and exits with 4.
"$mbk" measure --channels "$channels" --handle-mass 0.194 "$out/mine.csv"

# 3. The same for machines (SI units, every digit), and for people, as one HTML file.
"$mbk" measure --channels "$channels" --handle-mass 0.194 --json --overwrite --quiet --out "$out/result.json" \
  --report "$out/report.html" "$out/mine.csv"

# 4. The published procedure, sample for sample, to compare with the literature.
echo "as Dyck (2013) did it:"
"$mbk" measure --mode reference --channels "$channels" --handle-mass 0.194 "$out/mine.csv" |
  grep -E '^ *(xx|inertia M|damping B|stiffness K)'
echo "result and report: $out"
