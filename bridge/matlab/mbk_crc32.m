function crc = mbk_crc32(bytes)
%MBK_CRC32  CRC-32 as of zlib, polynomial 0xEDB88320.
%   crc = mbk_crc32(bytes)   bytes: row of uint8.   crc: uint32
%#codegen
persistent table
if isempty(table)
  table = zeros(1, 256, 'uint32');
  for k = 0:255
    entry = uint32(k);
    for bit = 1:8
      if bitand(entry, uint32(1)) ~= 0
        entry = bitxor(bitshift(entry, -1), uint32(3988292384));
      else
        entry = bitshift(entry, -1);
      end
    end
    table(k + 1) = entry;
  end
end
crc = uint32(4294967295);
for k = 1:numel(bytes)
  index = bitxor(bitand(crc, uint32(255)), uint32(bytes(k)));
  crc = bitxor(bitshift(crc, -8), table(index + 1));
end
crc = bitxor(crc, uint32(4294967295));
end
