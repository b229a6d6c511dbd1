#!/usr/bin/env python3
"""Builds a map from nothing: a camera that goes along a wall. Python's own library is enough.

    examples/make_map.py | slamdb convert - wall.osa --from ndjson
    slamdb vocabulary recompute wall.osa map.osa --vocabulary ORBvoc.txt

What is left out here, slamdb derives: observations, covisibility, the spanning tree, normals, grids, counters. The
second line gives it bags of words, without which ORB-SLAM3 loads no map.
"""
import hashlib
import json

FX, FY, CX, CY, WIDTH, HEIGHT = 400, 400, 320, 240, 640, 480
WALL = [(x / 4, y / 4, 3 + (x * y % 5) / 10) for x in range(-4, 29) for y in range(-5, 6)]


def descriptor(point):
    """32 bytes that tell a point from others, as ORB's do."""
    return hashlib.sha256(str(point).encode()).hexdigest()


def seen_from(place):
    """Which points a camera at `place`, looking along z, sees where."""
    for row, point in enumerate(WALL):
        x, y, z = (a - b for a, b in zip(point, place))
        u, v = FX * x / z + CX, FY * y / z + CY
        if 0 <= u < WIDTH and 0 <= v < HEIGHT:
            yield row, u, v, z


def keyframe(number):
    place = (0.5 * number, 0, 0)
    seen = list(seen_from(place))
    return {
        "type": "keyframe", "id": number, "timestamp": 1.7e9 + 0.5 * number, "camera": 0,
        "camera_from_world": {"rotation_xyzw": [0, 0, 0, 1], "translation": [-axis for axis in place]},
        "bounds": {"min_x": 0, "min_y": 0, "max_x": WIDTH, "max_y": HEIGHT},
        "features": {
            "keypoints": {"x": [u for _, u, _, _ in seen], "y": [v for _, _, v, _ in seen]},
            "descriptors": [descriptor(row) for row, _, _, _ in seen],
            "map_points": [row for row, _, _, _ in seen],
        },
    }


def lines():
    yield {"type": "atlas"}
    yield {"type": "camera", "id": 0, "model": "pinhole", "parameters": [FX, FY, CX, CY]}
    yield {"type": "map", "id": 0}
    yield from (keyframe(number) for number in range(12))
    yield from ({"type": "map_point", "id": row, "position": point} for row, point in enumerate(WALL))


if __name__ == "__main__":
    for line in lines():
        print(json.dumps(line))
