function bytes = mbk_pack_state(state)
%MBK_PACK_STATE  A state for mbk as the bytes of a datagram: 92 of version 1, 112 of version 2.
%   bytes = mbk_pack_state(state)   row of uint8.   state: version, flags (1 stop pressed, 2 motors on, 4 force sensor
%   fitted, 8 accelerometer fitted, 16 watchdog expired, 32 drives measure), session, rejected, sequence, answered,
%   time_s, encoder(1:2), force(1:2), acceleration(1:2), and in version 2 measured(1:2), fault.
%   Little-endian, like the targets of Simulink and QUARC.
%#codegen
flags = uint16(state.flags);
if state.version < 2
  flags = bitand(flags, uint16(31));  % drives measure: version 2 only
end
body = [uint8('MBKS'), typecast(uint16(state.version), 'uint8'), typecast(flags, 'uint8'), ...
        typecast(uint32(state.session), 'uint8'), typecast(uint32(state.rejected), 'uint8'), ...
        typecast(uint64(state.sequence), 'uint8'), typecast(uint64(state.answered), 'uint8'), ...
        typecast(double(state.time_s), 'uint8'), typecast(double(state.encoder), 'uint8'), ...
        typecast(double(state.force), 'uint8'), typecast(double(state.acceleration), 'uint8')];
if state.version < 2
  bytes = [body, typecast(mbk_crc32(body), 'uint8')];
else
  longer = [body, typecast(double(state.measured), 'uint8'), typecast(uint32(state.fault), 'uint8')];
  bytes = [longer, typecast(mbk_crc32(longer), 'uint8')];
end
end
