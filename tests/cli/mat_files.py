"""MAT files by hand: another writer than the one (libmatio) that the program reads with."""
import struct

import h5py
import numpy as np


def _words(*values):
    return b"".join(struct.pack("<I", value) for value in values)


def _element(kind, content):
    return _words(kind, len(content)) + content + bytes(-len(content) % 8)


def _header(version):
    return b"MATLAB MAT-file, by hand".ljust(116) + bytes(8) + struct.pack("<H", version) + b"IM"


def _array(name, kind, sizes, content):
    return _element(14, _element(6, _words(kind, 0)) + _element(5, _words(*sizes)) + _element(1, name.encode()) + content)


def numbers(name, values):
    """A column of doubles."""
    values = np.asarray(values, "<f8")
    return _array(name, 6, (values.size, 1), _element(9, values.tobytes()))


def text(name, value):
    return _array(name, 4, (1, len(value)), _element(4, value.encode("utf-16-le")))


def struct5(name, **fields):
    """A struct; a field is a text or a column of numbers."""
    longest = 32
    names = b"".join(field.encode().ljust(longest, b"\0") for field in fields)
    members = b"".join(text("", value) if isinstance(value, str) else numbers("", value) for value in fields.values())
    length = struct.pack("<HHI", 5, 4, longest)  # small element
    return _array(name, 2, (1, 1), length + _element(1, names) + members)


def table(name):
    """As MATLAB stores a table: a reference into an object that it alone knows."""
    reference = _array("", 13, (6, 1), _element(6, _words(0xDD000000, 2, 1, 1, 1, 1)))
    return _element(14, _element(6, _words(17, 0)) + _element(1, name.encode()) + _element(1, b"MCOS") +
                    _element(1, b"table") + reference)


def version5(*variables):
    return _header(0x0100) + b"".join(variables)


def big_endian(name, values):
    """A file with a column of doubles, as a workstation of old writes it."""
    def words(*numbers_):
        return struct.pack(f">{len(numbers_)}I", *numbers_)

    def element(kind, content):
        return words(kind, len(content)) + content + bytes(-len(content) % 8)

    values = np.asarray(values, ">f8")
    header = b"MATLAB MAT-file, by hand".ljust(116) + bytes(8) + b"\1\0MI"
    return header + element(14, element(6, words(6, 0)) + element(5, words(values.size, 1)) + element(1, name.encode()) +
                            element(9, values.tobytes()))


def channel(title, values, units="V", interval=0.001, start=0.0002):
    """The fields of a channel as Spike2 exports it."""
    return {"title": title, "comment": "No comment", "interval": [interval], "scale": [1], "offset": [0], "units": units,
            "start": [start], "length": [len(values)], "values": values}


def _set_class(item, name):
    kind = h5py.h5t.C_S1.copy()
    kind.set_size(len(name))
    attribute = h5py.h5a.create(item.id, b"MATLAB_class", kind, h5py.h5s.create(h5py.h5s.SCALAR))
    attribute.write(np.array(name.encode(), f"S{len(name)}"), mtype=kind)


def _add(group, name, value):
    if isinstance(value, dict):
        item = group.create_group(name)
        for field, inner in value.items():
            _add(item, field, inner)
        _set_class(item, "struct")
        fields = np.empty(len(value), object)
        fields[:] = [np.array([letter.encode() for letter in field], "S1") for field in value]
        item.attrs.create("MATLAB_fields", fields, dtype=h5py.vlen_dtype(np.dtype("S1")))
    elif isinstance(value, str):
        item = group.create_dataset(name, data=np.array([[ord(letter)] for letter in value], np.uint16))
        item.attrs["MATLAB_int_decode"] = np.int32(2)
        _set_class(item, "char")
    else:
        item = group.create_dataset(name, data=np.atleast_2d(np.asarray(value, float)), chunks=True, compression="gzip")
        _set_class(item, "double")


def write_version73(path, change=None, **variables):
    """change(h5py.File) is done before MATLAB's header is written."""
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, value in variables.items():
            _add(file, name, value)
        if change:
            change(file)
    with open(path, "r+b") as file:
        file.write(_header(0x0200))
