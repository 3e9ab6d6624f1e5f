#!/usr/bin/env bash
# Force without a force sensor: the hand must exert what the motor torque does not explain of the motion.
#   usage: run.sh [FOLDER]    output folder (default: a new temporary folder)
set -euo pipefail
mbk=${MBK:-mbk}                            # the program: from PATH, or set by MBK
out=${1:-$(mktemp --directory)}
mkdir -p "$out"

# 1. The robot moves alone, with nothing at its handle. This identifies inertia [kg·m²] and friction [N·m·s/rad, N·m].
#    Torque is computed from the noisy motor current: 0.2 A at 0.1 N·m/A.
noise=$'[sensors.motor_current]\nnoise_A = 0.2'
{ "$mbk" simulate --show free_motion; echo "$noise"; } > "$out/free.toml"
"$mbk" simulate "$out/free.toml" --overwrite --quiet --out "$out/free.h5"
"$mbk" robot identify "$out/free.h5"
"$mbk" robot identify "$out/free.h5" --json --overwrite --quiet --out "$out/robot.json"

# 2. The same robot with a rig of known mass and springs, and a force sensor that the method does not use.
{ "$mbk" simulate --show rig_table_5_1; echo "$noise"; } > "$out/rig.toml"
"$mbk" simulate "$out/rig.toml" --trial K1_M1 --overwrite --quiet --out "$out/rig.h5"
rig=$out/rig_K1_M1.h5
"$mbk" info "$rig" | grep -E 'truth_[MK] '

# 3. Compare computed and measured force [N]: error, bias, gain, delay, at rest, in motion and at reversals.
"$mbk" robot force "$rig" --robot "$out/robot.json"

# 4. Mass [kg] and stiffness [N/m] from either. The ± of the virtual sensor includes the uncertainty of the robot model.
for source in sensor virtual; do
  echo "force: $source"
  use=(--structure mass-spring --force-source "$source")
  if [[ $source == virtual ]]; then use+=(--robot "$out/robot.json"); fi
  "$mbk" measure "${use[@]}" "$rig" | grep -E '^ *(inertia M|stiffness K)  ' | head -n 2
  "$mbk" measure "${use[@]}" --json --overwrite --quiet --out "$out/$source.json" "$rig"
done
echo "results: $out"
