#!/usr/bin/env python3
"""check_las.py FILE: reads a LAS file by the tables of ASPRS's specification 1.2 alone, says what is wrong with it, and
prints its points as `x y z red green blue source`."""
import struct
import sys

HEADER = "<4sHH16sBB32s32sHHHIIBHI5I3d3d6d"
NAMES = ("signature source encoding guid major minor system software day year header_size offset records format "
         "record_size points").split()
FORMATS = {0: 20, 1: 28, 2: 26, 3: 34}


def require(holds, what):
    if not holds:
        sys.exit("FAILED: " + what)


def text(field):
    return field.split(b"\0")[0].decode("ascii")


def keys_of(data, header):
    at, found = header["header_size"], {}
    for _ in range(header["records"]):
        reserved, user, record, size, _description = struct.unpack_from("<H16sHH32s", data, at)
        require(reserved == 0, "reserved is not 0")
        at += 54
        if text(user) == "LASF_Projection" and record == 34735:
            shorts = struct.unpack_from("<%dH" % (size // 2), data, at)
            require(shorts[:3] == (1, 1, 0) and len(shorts) == 4 + 4 * shorts[3], "the directory of keys")
            entries = [shorts[i:i + 4] for i in range(4, len(shorts), 4)]
            require(entries == sorted(entries), "keys do not ascend")
            require(all(entry[1:3] == (0, 1) for entry in entries), "keys are not numbers of their own")
            found.update({entry[0]: entry[3] for entry in entries})
        at += size
    require(at == header["offset"], "records end at %d, points begin at %d" % (at, header["offset"]))
    return found


def main():
    with open(sys.argv[1], "rb") as file:
        data = file.read()
    fields = struct.unpack_from(HEADER, data)
    header = dict(zip(NAMES, fields))
    returns, scale, offset, bounds = fields[16:21], fields[21:24], fields[24:27], fields[27:33]
    require(header["signature"] == b"LASF", "the signature")
    require((header["major"], header["minor"]) == (1, 2), "the version")
    require(struct.calcsize(HEADER) == header["header_size"] == 227, "the size of the header")
    require(header["record_size"] == FORMATS[header["format"]], "the size of a record")
    require(len(data) == header["offset"] + header["points"] * header["record_size"], "the size of the file")
    require(sum(returns) == header["points"], "points by return")
    require(text(header["software"]) == "slamdb", "the software")
    keys = keys_of(data, header)
    require(keys.get(1024) == 1 and keys.get(3076) == 9001, "projected, in metres")
    require(32601 <= keys[3072] <= 32660 or 32701 <= keys[3072] <= 32760, "a zone of UTM")
    print("epsg", keys[3072])
    least, most = [float("inf")] * 3, [float("-inf")] * 3
    for i in range(header["points"]):
        at = header["offset"] + i * header["record_size"]
        *place, _intensity, flags, _kind, _angle, _user, source = struct.unpack_from("<3iHBBbBH", data, at)
        colour = struct.unpack_from("<3H", data, at + 20)
        require(flags & 7 == 1 and flags >> 3 & 7 == 1, "point %d is not the only return" % i)
        place = [number * step + zero for number, step, zero in zip(place, scale, offset)]
        least, most = list(map(min, least, place)), list(map(max, most, place))
        print("%.4f %.4f %.4f" % tuple(place), *colour, source)
    if header["points"] > 0:
        require(all(abs(bounds[2 * axis] - most[axis]) < 1e-9 for axis in range(3)), "the upper bounds")
        require(all(abs(bounds[2 * axis + 1] - least[axis]) < 1e-9 for axis in range(3)), "the lower bounds")


main()
