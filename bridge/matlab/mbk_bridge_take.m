function [bridge, event] = mbk_bridge_take(bridge, bytes, sender, now_s)
%MBK_BRIDGE_TAKE  Processes a received datagram: accepts or rejects it, and stores its command.
%   [bridge, event] = mbk_bridge_take(bridge, bytes, sender, now_s)
%   sender: a number that identifies address and port; now_s: time on a monotonic clock.
%   event: 0 rejected and counted; 1 greeted: starts a session, send states to this sender, motors off; 2 commanded;
%   3 repeated: copy of the newest command or greeting, no effect (in lock-step: reply again).
%#codegen
[why, came] = mbk_unpack_command(bytes);
if why ~= 0 || ~all(isfinite(came.command))
  event = 0;
elseif bitand(came.flags, uint16(2)) ~= 0
  if bridge.awake && sender == bridge.master && came.session == bridge.session
    event = 3;
  elseif (bridge.enabled && ~bridge.watchdog_expired) || came.session == 0
    event = 0;  % greetings are rejected while the motors are on
  else
    event = 1;
    bridge.awake = true;
    bridge.enabled = false;
    bridge.watchdog_expired = false;
    bridge.lock_step = bitand(came.flags, uint16(4)) ~= 0;
    bridge.master = sender;
    bridge.session = came.session;
    bridge.watchdog_ms = came.watchdog_ms;
    bridge.newest = came.sequence;
    bridge.heard_s = now_s;
    bridge.command = [0 0];
  end
elseif ~bridge.awake || sender ~= bridge.master || came.session ~= bridge.session || came.sequence < bridge.newest
  event = 0;
elseif came.sequence == bridge.newest
  event = 3;
else
  event = 2;
  bridge.newest = came.sequence;
  bridge.watchdog_ms = came.watchdog_ms;
  bridge.enabled = bitand(came.flags, uint16(1)) ~= 0;
  bridge.command = came.command;
  bridge.heard_s = now_s;
end
if event == 0
  bridge.rejected = bridge.rejected + 1;
end
end
