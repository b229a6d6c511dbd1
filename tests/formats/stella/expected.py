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
slots = {k["id"]: k["features"]["map_points"] for k in keyframes}
points_of = {}  # of a keypoint; of several points it is the one that it knows, or the first
for point in points:
    for observation in point["observations"]:
        keyframe, row = observation["keyframe"], observation["left"]
        if (keyframe, row) not in points_of or slots[keyframe][row] == point["id"]:
            points_of[keyframe, row] = point["id"]
kept = set(points_of.values())
points = [point for point in points if point["id"] in kept]
seen = {k["id"]: sum(p for (keyframe, _), p in points_of.items() if keyframe == k["id"]) for k in keyframes}


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
