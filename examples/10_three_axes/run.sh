#!/usr/bin/env bash
# Three axes: the impedance of a hand in space from the log of a Franka robot.
#   usage: run.sh [FOLDER]    output folder (default: a new temporary folder)
set -euo pipefail
mbk=${MBK:-mbk}                            # the program: from PATH, or set by MBK
out=${1:-$(mktemp --directory)}
mkdir -p "$out"
here=$(dirname "${BASH_SOURCE[0]}")

# 1. A synthetic log instead of yours, with the columns of libfranka: time [ms], O_T_EE, O_F_ext_hat_K.
python3 "$here/franka_log.py" "$out/log.csv"

# 2. What mbk reads: x, y, z [m] and the force of the hand on the robot [N], which is -O_F_ext_hat_K.
"$mbk" info --axes 3 "$out/log.csv"

# 3. M [kg], B [N·s/m] and K [N/m] as 3×3 matrices, x0 [mm], each with its 95 % interval.
"$mbk" measure "$out/log.csv" --axes 3
"$mbk" measure "$out/log.csv" --axes 3 --json --overwrite --quiet --out "$out/result.json"
echo "log and result: $out"
