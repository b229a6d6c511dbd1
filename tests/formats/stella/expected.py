"""expected.py < DUMP: what summary.py prints, of what `slamdb dump` prints of the atlas."""
import json
import struct
import sys

keyframes, points = [], []
for line in sys.stdin:
    entity = json.loads(line)
    if entity["type"] == "keyframe" and not entity["bad"]:
        keyframes.append(entity)
    elif entity["type"] == "map_point" and not entity["bad"] and entity["observations"]:
        points.append(entity)
keyframes.sort(key=lambda k: k["id"])
points.sort(key=lambda p: p["id"])
seen = {k["id"]: 0 for k in keyframes}
for point in points:
    for observation in point["observations"]:
        seen[observation["keyframe"]] += point["id"]


def bits(value):
    return struct.pack("<f", value).hex()


def words(descriptor):
    return sum(struct.unpack("<8I", bytes.fromhex(descriptor)))


def places(keyframe):
    return [bits(v) for x, y in list(zip(*[keyframe["features"]["undistorted"][c] for c in "xy"]))[:3] for v in (x, y)]


print("keyframes", len(keyframes), "keypoints", sum(len(k["features"]["descriptors"]) for k in keyframes), ".")
for k in keyframes:
    pose = k["camera_from_world"]
    print(k["id"], repr(k["timestamp"]), *map(bits, pose["rotation_xyzw"] + pose["translation"]),
          -1 if k["parent"] is None else k["parent"], sum(map(words, k["features"]["descriptors"])), seen[k["id"]], *places(k))
print("landmarks", len(points), ".")
for point in points:
    print(point["id"], *map(bits, point["position"]), point["reference"])
