function [why, head] = mbk_look_at(bytes, magic, lengths)
%MBK_LOOK_AT  Checks a datagram and reads its head.
%   why: 0 valid, 1 wrong length, 2 wrong magic, 3 wrong version, 4 wrong checksum.   lengths: of versions 1, 2, …
%   head: version, flags and session; version 1 and zeros if the datagram is invalid.
%#codegen
head = struct('version', uint16(1), 'flags', uint16(0), 'session', uint32(0));
why = 0;
count = numel(bytes);
if count < 6
  why = 1;
elseif any(bytes(1:4) ~= magic)
  why = 2;
else
  version = double(typecast(bytes(5:6), 'uint16'));
  if version < 1 || version > numel(lengths)
    why = 3;
  elseif count ~= lengths(version)
    why = 1;
  elseif typecast(bytes(count-3:count), 'uint32') ~= mbk_crc32(bytes(1:count-4))
    why = 4;
  else
    head.version = typecast(bytes(5:6), 'uint16');
    head.flags = typecast(bytes(7:8), 'uint16');
    head.session = typecast(bytes(9:12), 'uint32');
  end
end
end
