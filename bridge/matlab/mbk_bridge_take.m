function [bridge, event] = mbk_bridge_take(bridge, bytes, sender, now_s)
%MBK_BRIDGE_TAKE  A datagram has come: is it believed, and what does it ask for?
%   [bridge, event] = mbk_bridge_take(bridge, bytes, sender, now_s)
%   sender: any number that names an address and a port; now_s: of a clock that only runs forward.
%   event: 0 rejected and counted; 1 greeted: a session begins, send states to the sender, motors off; 2 commanded;
%   3 repeated: the newest command or the greeting once more, which changes nothing (in lock-step: answer again).
%#codegen
[why, came] = mbk_unpack_command(bytes);
if why ~= 0 || ~all(isfinite(came.command))
  event = 0;
elseif bitand(came.flags, uint16(2)) ~= 0
  if bridge.awake && sender == bridge.master && came.session == bridge.session
    event = 3;
  elseif (bridge.enabled && ~bridge.watchdog_expired) || came.session == 0
    event = 0;  % while the motors are on nobody else is obeyed
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
