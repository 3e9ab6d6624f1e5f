function [why, command] = mbk_unpack_command(bytes)
%MBK_UNPACK_COMMAND  A command of mbk from the bytes of a datagram.
%   [why, command] = mbk_unpack_command(bytes)   bytes: row of uint8, all received bytes.   why: as in mbk_look_at.
%   command, if it is valid: flags (1 motors on, 2 greeting, 4 lock-step), session, watchdog_ms, sequence, and
%   command(1:2) for the motors in the robot's unit, which may be non-finite.
%#codegen
[why, head] = mbk_look_at(bytes, uint8('MBKC'), 44);
command = struct('flags', head.flags, 'session', head.session, 'watchdog_ms', uint32(0), 'sequence', uint64(0), ...
                 'command', [0 0]);
if why == 0
  command.watchdog_ms = typecast(bytes(13:16), 'uint32');
  command.sequence = typecast(bytes(17:24), 'uint64');
  command.command = typecast(bytes(25:40), 'double');
end
end
