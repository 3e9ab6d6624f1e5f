function bridge = mbk_bridge_begin(state_version)
%MBK_BRIDGE_BEGIN  Initial state of the bridge, before the first greeting.
%   bridge = mbk_bridge_begin(state_version)   state_version: of the states that the robot sends, 1 or 2.
%   You may read: awake (master is connected and receives states), master (sender of the last greeting), lock_step
%   (requested in the greeting; only a simulation can wait), watchdog_expired (motors stay off until the next greeting).
%#codegen
bridge = struct('version', state_version, 'awake', false, 'enabled', false, 'watchdog_expired', false, ...
                'lock_step', false, 'session', uint32(0), 'watchdog_ms', uint32(0), 'rejected', uint32(0), ...
                'master', 0, 'newest', uint64(0), 'sequence', uint64(0), 'heard_s', 0, 'command', [0 0]);
end
