function [drive_enabled, drive_command, datagram, count] = mbk_robot_step(received, received_count, sample, now_s)
%MBK_ROBOT_STEP  A robot's whole step: for a MATLAB Function block in Simulink, once in each millisecond.
%   [drive_enabled, drive_command, datagram, count] = mbk_robot_step(received, received_count, sample, now_s)
%   received: uint8, what the UDP or stream block received; received_count: how many bytes of it are new, 0: none.
%   sample: as mbk_sample gives it, read from the hardware; its field obeyed is filled in here.
%   now_s: of a clock that only runs forward.
%   drive_enabled, drive_command(1:2): to the drives. datagram(1:count): to the UDP or stream block; count 0: send none.
%   Blocks know one sender: let them receive from mbk's address alone (local_port in [device]).
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
