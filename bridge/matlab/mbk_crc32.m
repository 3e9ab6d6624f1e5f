function crc = mbk_crc32(bytes)
%MBK_CRC32  CRC-32 as in zlib, polynomial 0xEDB88320.
%   crc = mbk_crc32(bytes)   bytes: row of uint8.   crc: uint32
%   Processes four bytes at a time, little-endian, each with its own column of the table.
%#codegen
persistent table
if isempty(table)
  table = zeros(256, 4, 'uint32');
  for k = 0:255
    entry = uint32(k);
    for bit = 1:8
      if bitand(entry, uint32(1)) ~= 0
        entry = bitxor(bitshift(entry, -1), uint32(3988292384));
      else
        entry = bitshift(entry, -1);
      end
    end
    table(k + 1, 1) = entry;
  end
  for column = 2:4  % a byte of zeros later
    for k = 1:256
      entry = table(k, column - 1);
      table(k, column) = bitxor(bitshift(entry, -8), table(bitand(entry, uint32(255)) + 1, 1));
    end
  end
end
crc = uint32(4294967295);
quads = floor(numel(bytes) / 4);
words = typecast(bytes(1:4*quads), 'uint32');
for k = 1:quads
  four = double(typecast(bitxor(crc, words(k)), 'uint8'));
  parts = table(four + [769 513 257 1]);  % the first byte by the last column
  crc = bitxor(bitxor(parts(1), parts(2)), bitxor(parts(3), parts(4)));
end
for k = 4*quads+1:numel(bytes)
  index = bitxor(bitand(crc, uint32(255)), uint32(bytes(k)));
  crc = bitxor(bitshift(crc, -8), table(index + 1, 1));
end
crc = bitxor(crc, uint32(4294967295));
end
