function bridge = mbk_bridge_begin(state_version)
%MBK_BRIDGE_BEGIN  What a robot remembers from one step to the next, before anybody has greeted it.
%   bridge = mbk_bridge_begin(state_version)   of the states that it sends: 1 or 2.
%   To be read: awake (somebody is there to send states to), master (who greeted last), lock_step (asked for in the
%   greeting; only a simulation can wait), watchdog_expired (the motors stay off until the next greeting).
%#codegen
bridge = struct('version', state_version, 'awake', false, 'enabled', false, 'watchdog_expired', false, ...
                'lock_step', false, 'session', uint32(0), 'watchdog_ms', uint32(0), 'rejected', uint32(0), ...
                'master', 0, 'newest', uint64(0), 'sequence', uint64(0), 'heard_s', 0, 'command', [0 0]);
end
