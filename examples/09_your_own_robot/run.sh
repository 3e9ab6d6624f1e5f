#!/usr/bin/env bash
# Your own robot: describe it, check the description, identify its inertia and friction.
#   usage: run.sh [FOLDER]    output folder (default: a new temporary folder)
set -euo pipefail
mbk=${MBK:-mbk}                            # the program: from PATH, or set by MBK
out=${1:-$(mktemp --directory)}
mkdir -p "$out"
here=$(dirname "${BASH_SOURCE[0]}")

# 1. Any serial robot is described by its URDF and a few lines beside it. mbk shows joints, hand [mm], coefficients
#    [kg, kg·m, kg·m², N·m], and which of them no motion can identify.
"$mbk" robot describe "$here/../robots/double_pendulum.toml" | tee "$out/described.txt"

# 2. A robot with both motors at the base is "planar". Links and inertia here are invented: enter yours.
cat > "$out/my_robot.toml" <<'TOML'
[robot]
kind = "planar"
d1_mm = 300
d2_mm = 280
theta1_deg = [-55, 90]
theta2_deg = [0, 145]
smallest_opening_deg = 35

[drive]
terms = ["viscous", "coulomb", "offset"]
TOML

# 3. With nothing at the hand, the robot follows sines through its workspace for a minute. This simulated robot has
#    inertia and friction that differ from the description above.
"$mbk" simulate --show free_motion > "$out/free.toml"
robot='home_mm = [320, -50]
d1_mm = 300
d2_mm = 280
alpha_kg_m2 = [0.09, 0.05, 0.055]
viscous_Nms_per_rad = [0.08, 0.06]'
sed -i "s/^home_mm.*/${robot//$'\n'/\\n}/" "$out/free.toml"
printf '[sensors.motor_current]\nnoise_A = 0.2\n' >> "$out/free.toml"   # torque from current, 0.1 N·m/A
"$mbk" simulate "$out/free.toml" --overwrite --quiet --out "$out/free.h5"

# 4. Its coefficients, each with a 95 % interval; robot.json needs no other file.
"$mbk" robot identify "$out/free.h5" --robot "$out/my_robot.toml"
"$mbk" robot identify "$out/free.h5" --robot "$out/my_robot.toml" --json --overwrite --quiet --out "$out/robot.json"

# 5. Nothing was attached to the handle, so the residual force [N] shows the quality of the model.
"$mbk" robot force "$out/free.h5" --robot "$out/robot.json" | sed -n '1,10p'
echo "description and result: $out"
