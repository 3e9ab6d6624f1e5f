function bytes = mbk_pack_command(command)
%MBK_PACK_COMMAND  A command as the 44 bytes of a datagram, for programs that command a robot themselves.
%   bytes = mbk_pack_command(command)   row of uint8.   command: as mbk_unpack_command gives it.
%#codegen
body = [uint8('MBKC'), typecast(uint16(1), 'uint8'), typecast(uint16(command.flags), 'uint8'), ...
        typecast(uint32(command.session), 'uint8'), typecast(uint32(command.watchdog_ms), 'uint8'), ...
        typecast(uint64(command.sequence), 'uint8'), typecast(double(command.command), 'uint8')];
bytes = [body, typecast(mbk_crc32(body), 'uint8')];
end
