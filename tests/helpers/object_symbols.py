"""Names that an object file of ELF or Mach-O leaves to libraries."""

import struct


def undefined(data):
    """Names of the symbols that an object file uses and does not hold."""
    if data[:4] == b"\x7fELF":
        return _of_elf(data)
    assert data[:4] == b"\xcf\xfa\xed\xfe"
    return _of_mach_o(data)


def _text(data, start):
    return data[start : data.index(b"\0", start)].decode()


def _of_elf(data):
    (table,) = struct.unpack_from("<Q", data, 0x28)
    size, count = struct.unpack_from("<2H", data, 0x3A)
    sections = [
        struct.unpack_from("<2I4Q2I2Q", data, table + size * k) for k in range(count)
    ]
    (symbols,) = (section for section in sections if section[1] == 2)
    names = sections[symbols[6]][4]
    found = set()
    for place in range(symbols[4], symbols[4] + symbols[5], 24):
        name, _, _, section = struct.unpack_from("<I2BH", data, place)
        if name and section == 0:
            found.add(_text(data, names + name))
    return found


def _of_mach_o(data):
    place, found = 32, set()
    (commands,) = struct.unpack_from("<I", data, 16)
    for _ in range(commands):
        kind, size = struct.unpack_from("<2I", data, place)
        if kind == 2:  # the table of symbols
            symbols, count, names = struct.unpack_from("<3I", data, place + 8)
            for k in range(count):
                name, of = struct.unpack_from("<IB", data, symbols + 16 * k)
                if not of & 0x0E:
                    found.add(_text(data, names + name))
        place += size
    return found
