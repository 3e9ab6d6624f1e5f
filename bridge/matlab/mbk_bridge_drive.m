function [bridge, drive] = mbk_bridge_drive(bridge, now_s, stop_pressed)
%MBK_BRIDGE_DRIVE  Command for the motors. Call it at every step, even if no datagram was received.
%   [bridge, drive] = mbk_bridge_drive(bridge, now_s, stop_pressed)
%   drive.enabled: false means motors off; drive.command(1:2): 0 if they are off; drive.sequence: of this command;
%   return it in sample.obeyed once the drives execute it.
%#codegen
silent_s = now_s - bridge.heard_s;
if bridge.enabled && silent_s > 1e-3 * double(bridge.watchdog_ms)
  bridge.watchdog_expired = true;
end
if silent_s > 10
  bridge.awake = false;  % the master is no longer connected
end
enabled = bridge.awake && bridge.enabled && ~bridge.watchdog_expired && ~stop_pressed;
drive = struct('enabled', enabled, 'command', [0 0], 'sequence', bridge.newest);
if enabled
  drive.command = bridge.command;
end
end
