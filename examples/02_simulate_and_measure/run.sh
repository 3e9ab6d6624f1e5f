#!/usr/bin/env bash
# A trial of your own without a robot: change a scenario, look at it, simulate it, measure it, compare with the truth.
#   usage: run.sh [FOLDER]    where the files go; without it a new temporary folder
set -euo pipefail
mbk=${MBK:-mbk}                            # the program: from PATH, or named by MBK
out=${1:-$(mktemp --directory)}
mkdir -p "$out"

# 1. A ready scenario is where to begin: a text file in which every key carries its unit.
"$mbk" simulate --show relaxed_underdamped > "$out/mine.toml"

# 2. Make it yours: participant 4 of the thesis in place of 1.
sed -i 's/^number = 1$/number = 4/' "$out/mine.toml"

# 3. What will the perturbation demand? Peaks [mm, mm/s, mm/s²], band [Hz], duration [s]; nothing moves yet.
"$mbk" simulate "$out/mine.toml" --facts

# 4. Two trials with different noise and order of pulses. The same seed gives the same bytes on any day.
"$mbk" simulate "$out/mine.toml" --seeds 2 --overwrite --out "$out/trial.h5"

# 5. The truth lies in the recording's metadata. Nothing that measures reads it.
"$mbk" info "$out/trial_seed1.h5" | grep truth_

# 6. Each trial by itself, and their mean; then both in one fit, which is surer.
"$mbk" measure --handle-mass 0.194 "$out/trial_seed1.h5" "$out/trial_seed2.h5" | grep -E '^ *(inertia M|damping B|stiffness K) '
echo "both in one fit, in kg, N·s/m and N/m:"
"$mbk" measure --handle-mass 0.194 --pool "$out/trial_seed1.h5" "$out/trial_seed2.h5" |
  grep -E '^ *(xx  |inertia M|damping B|stiffness K) '
"$mbk" measure --handle-mass 0.194 --pool --json --overwrite --quiet --out "$out/pooled.json" \
  "$out/trial_seed1.h5" "$out/trial_seed2.h5"
echo "recordings and result: $out"
