#!/usr/bin/env bash
# The energy that a limb absorbed in a trial, and what its model predicts for other motions.
#   usage: run.sh [FOLDER]    output folder (default: a new temporary folder)
set -euo pipefail
mbk=${MBK:-mbk}                            # the program: from PATH, or set by MBK
out=${1:-$(mktemp --directory)}
mkdir -p "$out"

# 1. A relaxed arm. mbk tests every condition on the symmetric parts of M, B and K, and on their antisymmetric parts
#    over the band, with its error; it predicts "passive" if all are satisfied with 97.5 % confidence.
"$mbk" simulate relaxed_sinusoidal --overwrite --quiet --out "$out/relaxed.h5"
"$mbk" passivity --handle-mass 0.194 "$out/relaxed.h5" | sed '/energy that the limb absorbed/,$d'

# 2. A rigid arm that corrects its position 150 ms late, under pulses of 2 N. No model explains half of its force,
#    so there is no prediction. The energy shows what happened: E(t) = −∫ F·v dt [J] falls, so the hand delivered energy.
"$mbk" simulate rigid_underdamped_2N --overwrite --quiet --out "$out/small.h5"
"$mbk" passivity --handle-mass 0.194 "$out/small.h5" | sed '/energy that the limb absorbed/,$d'

# 3. The same arm stiffens under pulses of 8 N and absorbs energy. Only the amplitude differs.
"$mbk" simulate rigid_underdamped_8N --overwrite --quiet --out "$out/large.h5"
"$mbk" passivity --handle-mass 0.194 "$out/large.h5" | sed '/energy that the limb absorbed/,$d'

# 4. As JSON: both verdicts, energy [J], excess or shortage of passivity [N·s/m].
for name in relaxed small large; do
  "$mbk" passivity --handle-mass 0.194 --json --overwrite --quiet --out "$out/$name.json" "$out/$name.h5"
done
echo "results: $out"
