function [why, command] = mbk_unpack_command(bytes)
%MBK_UNPACK_COMMAND  A command of mbk from the bytes of a datagram.
%   [why, command] = mbk_unpack_command(bytes)   bytes: row of uint8, all that has come.
%   why: 0 believed, 1 wrong length, 2 wrong magic, 3 wrong version, 4 wrong checksum.
%   command, where it is believed: flags (1 motors on, 2 greeting, 4 lock-step), session, watchdog_ms, sequence, and
%   command(1:2) to the motors in the robot's unit, which need not be finite.
%#codegen
command = struct('flags', uint16(0), 'session', uint32(0), 'watchdog_ms', uint32(0), 'sequence', uint64(0), ...
                 'command', [0 0]);
why = mbk_look_at(bytes, uint8('MBKC'), 44);
if why ~= 0
  return
end
command.flags = typecast(bytes(7:8), 'uint16');
command.session = typecast(bytes(9:12), 'uint32');
command.watchdog_ms = typecast(bytes(13:16), 'uint32');
command.sequence = typecast(bytes(17:24), 'uint64');
command.command = typecast(bytes(25:40), 'double');
end
