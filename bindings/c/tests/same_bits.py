"""same_bits.py STEM RAW KIND...: RAW holds the channels of STEM.KIND.wav one after another, bit for bit."""

import struct
import sys


def channels(path):
    data, at, count, words = open(path, "rb").read(), 12, 0, ()
    while at < len(data):
        name, size = data[at : at + 4], struct.unpack("<I", data[at + 4 : at + 8])[0]
        if name == b"fmt ":
            count = struct.unpack("<H", data[at + 10 : at + 12])[0]
        if name == b"data":
            words = struct.unpack(f"<{size // 4}I", data[at + 8 : at + 8 + size])
        at += 8 + size + size % 2
    return [words[i::count] for i in range(count)]


stem, raw, *kinds = sys.argv[1:]
expected = [word for kind in kinds for channel in channels(f"{stem}.{kind}.wav") for word in channel]
found = open(raw, "rb").read()
found = list(struct.unpack(f"<{len(found) // 4}I", found))
assert len(found) == len(expected) > 0, f"{len(found)} samples; must be {len(expected)}"
assert any(word & 0x7FFFFFFF for word in expected), "the reference is silent"
differ = sum(a != b for a, b in zip(found, expected))
assert differ == 0, f"{differ} of {len(found)} samples differ"
