#!/usr/bin/env bash
# Least squares in a closed loop finds a wrong arm; instrumental variables find the right one.
#   usage: run.sh [FOLDER]    where the files go; without it a new temporary folder
set -euo pipefail
mbk=${MBK:-mbk}                            # the program: from PATH, or named by MBK
out=${1:-$(mktemp --directory)}
mkdir -p "$out"

# A person who holds on answers the motion that the robot makes, and the robot gives way to the force that the person
# makes: a loop. Least squares is then biased towards the negative robot impedance. Instrumental variables use only what follows the
# known perturbation, which no noise of the person can have caused.

# 1. Four trials of one stiff arm under sines of 6 N, with force noise and slow corrections of its own.
"$mbk" simulate rigid_sinusoidal_6N --seeds 4 --overwrite --quiet --out "$out/rigid.h5"
files=("$out"/rigid_seed{1,2,3,4}.h5)
echo "the arm's own M [kg], B [N·s/m], K [N/m]:"
"$mbk" info "${files[0]}" | grep -E 'truth_[MBK] '

# 2. mbk prints both methods without being asked, and says where they differ significantly. Here least squares, which
#    is asked for, finds an inertia that is not positive: not to be used, exit code 4, hence the `||`.
"$mbk" measure --pool --method ls --handle-mass 0.194 "${files[@]}" > "$out/both.txt" || echo "least squares: exit code $?"
grep -E '^ *(xx  |inertia M|damping B|stiffness K|by instrumental|! |NOT USABLE)|DIFFER' "$out/both.txt" | grep -v '\['

# 3. One of them, chosen, for machines.
for method in ls iv; do
  "$mbk" measure --pool --handle-mass 0.194 --method "$method" --json --overwrite --quiet --out "$out/$method.json" \
    "${files[@]}" || echo "method $method: computed but not usable, exit code $?"
done
echo "results: $out"
