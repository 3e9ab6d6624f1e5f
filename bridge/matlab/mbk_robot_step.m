function [drive_enabled, drive_command, datagram, count] = mbk_robot_step(received, received_count, sample, now_s)
%MBK_ROBOT_STEP  One complete step of a robot: for a MATLAB Function block in Simulink, once per millisecond.
%   [drive_enabled, drive_command, datagram, count] = mbk_robot_step(received, received_count, sample, now_s)
%   received: uint8, output of the UDP or stream block; received_count: number of new bytes in it, 0: none.
%   sample: as returned by mbk_sample, filled from the hardware; this function sets its field obeyed.
%   now_s: time on a monotonic clock.
%   drive_enabled, drive_command(1:2): for the drives. datagram(1:count): for the UDP or stream block; count 0: none.
%   Blocks support one sender: set them to receive only from the address of mbk (local_port in [device]).
%   States are of version 2: 112 bytes.
%#codegen
persistent bridge
if isempty(bridge)
  bridge = mbk_bridge_begin(2);
end
if received_count > 0
  bytes = reshape(received(1:received_count), 1, []);
  [bridge, ~] = mbk_bridge_take(bridge, bytes, 0, now_s);
end
[bridge, drive] = mbk_bridge_drive(bridge, now_s, sample.stop_pressed);
drive_enabled = drive.enabled;
drive_command = drive.command;
sample.obeyed = drive.sequence;
[bridge, datagram] = mbk_bridge_state(bridge, sample);
count = 0;
if bridge.awake
  count = numel(datagram);
end
end
