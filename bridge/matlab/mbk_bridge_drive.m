function [bridge, drive] = mbk_bridge_drive(bridge, now_s, stop_pressed)
%MBK_BRIDGE_DRIVE  What the motors shall do now: call it at each step, whether or not anything has come.
%   [bridge, drive] = mbk_bridge_drive(bridge, now_s, stop_pressed)
%   drive.enabled: false is motors off; drive.command(1:2): 0 where they are off; drive.sequence: of the command that
%   this is, which goes back in sample.obeyed once the drives obey it.
%#codegen
silent_s = now_s - bridge.heard_s;
if bridge.enabled && silent_s > 1e-3 * double(bridge.watchdog_ms)
  bridge.watchdog_expired = true;
end
if silent_s > 10
  bridge.awake = false;  % nobody is there any more
end
enabled = bridge.awake && bridge.enabled && ~bridge.watchdog_expired && ~stop_pressed;
drive = struct('enabled', enabled, 'command', [0 0], 'sequence', bridge.newest);
if enabled
  drive.command = bridge.command;
end
end
