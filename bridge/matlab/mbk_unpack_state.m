function [why, state] = mbk_unpack_state(bytes)
%MBK_UNPACK_STATE  A robot's state from the bytes of a datagram, for programs that command a robot themselves.
%   [why, state] = mbk_unpack_state(bytes)   why: as in mbk_look_at.   state: as mbk_pack_state expects it.
%#codegen
[why, head] = mbk_look_at(bytes, uint8('MBKS'), [92 112]);
state = struct('version', head.version, 'flags', head.flags, 'session', head.session, 'rejected', uint32(0), ...
               'sequence', uint64(0), 'answered', uint64(0), 'time_s', 0, 'encoder', [0 0], 'force', [0 0], ...
               'acceleration', [0 0], 'measured', [0 0], 'fault', uint32(0));
if why == 0
  state.rejected = typecast(bytes(13:16), 'uint32');
  state.sequence = typecast(bytes(17:24), 'uint64');
  state.answered = typecast(bytes(25:32), 'uint64');
  state.time_s = typecast(bytes(33:40), 'double');
  state.encoder = typecast(bytes(41:56), 'double');
  state.force = typecast(bytes(57:72), 'double');
  state.acceleration = typecast(bytes(73:88), 'double');
  if state.version >= 2
    state.measured = typecast(bytes(89:104), 'double');
    state.fault = typecast(bytes(105:108), 'uint32');
  end
end
end
