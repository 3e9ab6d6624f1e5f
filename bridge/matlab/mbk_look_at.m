function why = mbk_look_at(bytes, magic, lengths)
%MBK_LOOK_AT  Whether a datagram is one: 0 believed, 1 wrong length, 2 magic, 3 version, 4 checksum.
%   lengths: of version 1, 2, …
%#codegen
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
  end
end
end
