"""summary.py MAP.msg: what a map of stella_vslam holds, read with Python's MessagePack library."""
import struct
import sys

import msgpack

with open(sys.argv[1], "rb") as file:
    stored = msgpack.unpack(file, strict_map_key=True)


def bits(value):
    return struct.pack("<f", value).hex()


keyframes = sorted(stored["keyframes"].items(), key=lambda item: int(item[0]))
print("keyframes", len(keyframes), "keypoints", sum(k["n_keypts"] for _, k in keyframes), ".")
for name, keyframe in keyframes:
    words = [word for descriptor in keyframe["descs"] for word in descriptor]
    print(name, repr(keyframe["ts"]), *map(bits, keyframe["rot_cw"] + keyframe["trans_cw"]), keyframe["span_parent"],
          sum(words), sum(x for x in keyframe["lm_ids"] if x >= 0),
          *[bits(v) for point in keyframe["undist_keypts"][:3] for v in point["pt"]])
points = sorted(stored["landmarks"].items(), key=lambda item: int(item[0]))
print("landmarks", len(points), ".")
for name, point in points:
    print(name, *map(bits, point["pos_w"]), point["ref_keyfrm"])
