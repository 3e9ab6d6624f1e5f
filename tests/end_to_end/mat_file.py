"""MAT files of level 5, as far as the tests need them: real numeric matrices, nothing else."""

import array
import struct
import sys
import zlib

KINDS = {1: "b", 2: "B", 3: "h", 4: "H", 5: "i", 6: "I", 7: "f", 9: "d", 12: "q", 13: "Q"}  # of data elements
CLASSES = {"d": (6, 9), "f": (7, 7), "h": (10, 3), "i": (12, 5)}  # array.typecode: class of the matrix, data element
MATRIX, COMPRESSED, INT32, UINT32, INT8 = 14, 15, 5, 6, 1
CELLS, STRUCTURE, CHARACTERS, UINT16 = 1, 2, 4, 4  # classes of arrays; the last one is a kind of element


def elements(data):
    """(kind, bytes) of each data element."""
    place = 0
    while place + 8 <= len(data):
        kind, size = struct.unpack_from("<II", data, place)
        if kind >> 16:  # four bytes or fewer stand in the tag itself
            yield kind & 0xFFFF, data[place + 4:place + 4 + (kind >> 16)]
            place += 8
            continue
        yield kind, data[place + 8:place + 8 + size]
        place += 8 + size if kind == COMPRESSED else 8 + (size + 7) // 8 * 8


def read(path):
    """{name: list of rows} of every matrix of numbers in the file."""
    assert sys.byteorder == "little"
    variables = {}
    for kind, data in elements(path.read_bytes()[128:]):
        if kind == COMPRESSED:
            (kind, data), = elements(zlib.decompress(data))
        if kind != MATRIX:
            continue
        parts = list(elements(data))
        if parts[0][1][0] == STRUCTURE:
            continue
        rows, columns = struct.unpack("<2i", parts[1][1])
        values = array.array(KINDS[parts[3][0]], parts[3][1])
        variables[parts[2][1].decode()] = [[float(v) for v in values[k:rows * columns:rows]] for k in range(rows)]
    return variables


def read_complex(path):
    """{name: list of values} of every complex vector of doubles in the file."""
    variables = {}
    for kind, data in elements(path.read_bytes()[128:]):
        if kind == COMPRESSED:
            (kind, data), = elements(zlib.decompress(data))
        parts = list(elements(data))
        if kind == MATRIX and len(parts) > 4 and parts[3][0] == 9:
            real, imaginary = (array.array("d", part[1]) for part in parts[3:5])
            variables[parts[2][1].decode()] = [complex(a, b) for a, b in zip(real, imaginary)]
    return variables


def element(kind, data):
    return struct.pack("<II", kind, len(data)) + data + b"\0" * (-len(data) % 8)


def matrix(name, rows, typecode="d"):
    """One variable; integer typecodes round."""
    convert = float if typecode in "df" else round
    values = array.array(typecode, [convert(value) for column in zip(*rows) for value in column])
    kind, data_kind = CLASSES[typecode]
    return element(MATRIX, element(UINT32, struct.pack("<II", kind, 0))
                   + element(INT32, struct.pack("<ii", len(rows), len(rows[0])))
                   + element(INT8, name.encode()) + element(data_kind, values.tobytes()))


def texts(name, lines):
    """A column cell array of texts."""
    def text(line):
        data = line.encode("utf-16-le")
        return element(MATRIX, element(UINT32, struct.pack("<II", CHARACTERS, 0))
                       + element(INT32, struct.pack("<ii", 1, len(line))) + element(INT8, b"") + element(UINT16, data))
    return element(MATRIX, element(UINT32, struct.pack("<II", CELLS, 0))
                   + element(INT32, struct.pack("<ii", len(lines), 1)) + element(INT8, name.encode())
                   + b"".join(text(line) for line in lines))


def events(times, names):
    """The structure `events` of a recording."""
    fields = (matrix("", [[time] for time in times]), texts("", names), matrix("", [[0.0] for _ in times]))
    return element(MATRIX, element(UINT32, struct.pack("<II", STRUCTURE, 0)) + element(INT32, struct.pack("<ii", 1, 1))
                   + element(INT8, b"events") + element(INT32, struct.pack("<i", 32))
                   + element(INT8, b"".join(name.ljust(32, b"\0") for name in (b"time", b"name", b"value")))
                   + b"".join(fields))


def write(path, variables, typecode="d", more=b""):
    """@param more  further variables, as `events` makes them"""
    header = b"MATLAB 5.0 MAT-file, written by a test of mbk".ljust(124) + struct.pack("<H2s", 0x0100, b"IM")
    path.write_bytes(header + b"".join(matrix(name, rows, typecode) for name, rows in variables.items()) + more)
    return path
