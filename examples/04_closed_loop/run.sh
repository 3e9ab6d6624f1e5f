#!/usr/bin/env bash
# In a closed loop least squares gives a wrong arm; instrumental variables give the correct one.
#   usage: run.sh [FOLDER]    output folder (default: a new temporary folder)
set -euo pipefail
mbk=${MBK:-mbk}                            # the program: from PATH, or set by MBK
out=${1:-$(mktemp --directory)}
mkdir -p "$out"

# A person who holds the handle responds to the motion of the robot, and the robot yields to the force of the person:
# a closed loop. Least squares is then biased towards the negative robot impedance. Instrumental variables use only the
# response to the known perturbation, which is independent of the person's own noise.

# 1. Four trials of one stiff arm under sines of 6 N, with force noise and slow voluntary corrections.
"$mbk" simulate rigid_sinusoidal_6N --seeds 4 --overwrite --quiet --out "$out/rigid.h5"
files=("$out"/rigid_seed{1,2,3,4}.h5)
echo "true M [kg], B [N·s/m], K [N/m]:"
"$mbk" info "${files[0]}" | grep -E 'truth_[MBK] '

# 2. mbk always prints both methods and marks significant differences. Here least squares is requested and finds an
#    inertia that is not positive: the result is not usable, exit code 4, hence the `||`.
"$mbk" measure --pool --method ls --handle-mass 0.194 "${files[@]}" > "$out/both.txt" || echo "least squares: exit code $?"
grep -E '^ *(xx  |inertia M|damping B|stiffness K|by instrumental|! |NOT USABLE)|DIFFER' "$out/both.txt" | grep -v '\['

# 3. Each method, selected, as JSON.
for method in ls iv; do
  "$mbk" measure --pool --handle-mass 0.194 --method "$method" --json --overwrite --quiet --out "$out/$method.json" \
    "${files[@]}" || echo "method $method: computed but not usable, exit code $?"
done
echo "results: $out"
