#!/usr/bin/env bash
# Your own trial without a robot: edit a scenario, check it, simulate it, measure it, compare with the true values.
#   usage: run.sh [FOLDER]    output folder (default: a new temporary folder)
set -euo pipefail
mbk=${MBK:-mbk}                            # the program: from PATH, or set by MBK
out=${1:-$(mktemp --directory)}
mkdir -p "$out"

# 1. Start from a built-in scenario: a text file in which every key contains its unit.
"$mbk" simulate --show relaxed_underdamped > "$out/mine.toml"

# 2. Make it yours: participant 4 of the thesis instead of 1.
sed -i 's/^number = 1$/number = 4/' "$out/mine.toml"

# 3. Check the demands of the perturbation: peaks [mm, mm/s, mm/s²], band [Hz], duration [s]. Nothing moves yet.
"$mbk" simulate "$out/mine.toml" --facts

# 4. Two trials with different noise and pulse order. The same seed always gives the same bytes.
"$mbk" simulate "$out/mine.toml" --seeds 2 --overwrite --out "$out/trial.h5"

# 5. The true values are in the metadata of the recording. The measurement does not read them.
"$mbk" info "$out/trial_seed1.h5" | grep truth_

# 6. Each trial separately, and their mean; then both in one fit, which is more precise.
"$mbk" measure --handle-mass 0.194 "$out/trial_seed1.h5" "$out/trial_seed2.h5" | grep -E '^ *(inertia M|damping B|stiffness K) '
echo "both in one fit, in kg, N·s/m and N/m:"
"$mbk" measure --handle-mass 0.194 --pool "$out/trial_seed1.h5" "$out/trial_seed2.h5" |
  grep -E '^ *(xx  |inertia M|damping B|stiffness K) '
"$mbk" measure --handle-mass 0.194 --pool --json --overwrite --quiet --out "$out/pooled.json" \
  "$out/trial_seed1.h5" "$out/trial_seed2.h5"
echo "recordings and result: $out"
