#!/usr/bin/env bash
# From a laboratory's table of numbers to M, B, K and x0 with intervals.
#   usage: run.sh [FOLDER]    output folder (default: a new temporary folder)
set -euo pipefail
mbk=${MBK:-mbk}                            # the program: from PATH, or set by MBK
out=${1:-$(mktemp --directory)}
mkdir -p "$out"

# A simulated robot and arm replace yours here. --blind omits the true values, so the file looks like any recording.
"$mbk" simulate relaxed_sinusoidal --blind --overwrite --quiet --out "$out/session.csv"

# Many laboratories have unnamed columns. These are time [s], hand x, y [mm], force x, y [N], reference x, y [mm].
# The signs are those of mbk: F is the force that the hand exerts on the robot.
awk -F, '/^#/ { next }
  !named { for (i = 1; i <= NF; i++) column[$i] = i; named = 1; next }
  { print $column["time_s"] "," 1e3 * $column["hand_x_m"] "," 1e3 * $column["hand_y_m"] "," $column["force_x_N"] "," \
      $column["force_y_N"] "," 1e3 * $column["reference_x_m"] "," 1e3 * $column["reference_y_m"] }' \
  CONVFMT=%.9g "$out/session.csv" > "$out/mine.csv"
channels=time=1,x=2:mm,y=3:mm,Fx=4,Fy=5,xr=6:mm,yr=7:mm

# 1. Inspect the file before you measure: rate, gaps, ranges and problems, in SI units.
"$mbk" info --channels "$channels" "$out/mine.csv"

# 2. Measure: M [kg], B [N·s/m], K [N/m], x0 [mm], each with its 95 % interval. The handle between sensor and hand has
#    0.194 kg, which is subtracted. If a result must not be used, mbk reports it and exits with 4.
"$mbk" measure --channels "$channels" --handle-mass 0.194 "$out/mine.csv"

# 3. The same result as JSON (SI units, every digit) and as one HTML report.
"$mbk" measure --channels "$channels" --handle-mass 0.194 --json --overwrite --quiet --out "$out/result.json" \
  --report "$out/report.html" "$out/mine.csv"

# 4. The published procedure, sample by sample, for comparison with the literature.
echo "as Dyck (2013) did it:"
"$mbk" measure --mode reference --channels "$channels" --handle-mass 0.194 "$out/mine.csv" |
  grep -E '^ *(xx|inertia M|damping B|stiffness K)'
echo "result and report: $out"
