#!/usr/bin/env python3
"""model.py equal ONE OTHER: whether two models of COLMAP hold the same, whatever the order and the form of their files,
up to the length of quaternions, which COLMAP makes 1.
model.py seen ONE OTHER TOLERANCE: the same, of points that images see.
model.py count MODEL images|seen: how many images it has, or points that images see.
model.py error MODEL...: the reprojection error of models, root of the mean square, in pixels, which is what bundle
adjustment makes small; and how far the errors of points are from what they are.
Shares nothing with slamdb: the formulas are those of COLMAP's documentation."""
import collections
import math
import os
import struct
import sys

MODELS = ["SIMPLE_PINHOLE", "PINHOLE", "SIMPLE_RADIAL", "RADIAL", "OPENCV", "OPENCV_FISHEYE", "FULL_OPENCV"]
PARAMETERS = dict(zip(MODELS, [3, 4, 4, 5, 8, 8, 12]))

Camera = collections.namedtuple("Camera", "model width height parameters")
Image = collections.namedtuple("Image", "rotation translation camera name keypoints")
Point = collections.namedtuple("Point", "position color error track")
Model = collections.namedtuple("Model", "cameras images points")


class Bytes:
    def __init__(self, path):
        with open(path, "rb") as file:
            self.bytes = file.read()
        self.at = 0

    def take(self, form):
        values = struct.unpack_from("<" + form, self.bytes, self.at)
        self.at += struct.calcsize("<" + form)
        return values if len(values) > 1 else values[0]

    def name(self):
        end = self.bytes.index(b"\0", self.at)
        name, self.at = self.bytes[self.at:end], end + 1
        return name

    def end(self):
        assert self.at == len(self.bytes), "bytes follow"


def read_binary(folder):
    cameras, images, points = {}, {}, {}
    file = Bytes(os.path.join(folder, "cameras.bin"))
    for _ in range(file.take("Q")):
        number, model, width, height = file.take("IiQQ")
        cameras[number] = Camera(MODELS[model], width, height, file.take("%dd" % PARAMETERS[MODELS[model]]))
    file.end()
    file = Bytes(os.path.join(folder, "images.bin"))
    for _ in range(file.take("Q")):
        number, pose, camera, name = file.take("I"), file.take("7d"), file.take("I"), file.name()
        keypoints = [file.take("ddq") for _ in range(file.take("Q"))]
        images[number] = Image(pose[:4], pose[4:], camera, name, keypoints)
    file.end()
    file = Bytes(os.path.join(folder, "points3D.bin"))
    for _ in range(file.take("Q")):
        number, position, color, error = file.take("Q"), file.take("3d"), file.take("3B"), file.take("d")
        points[number] = Point(position, color, error, sorted(file.take("II") for _ in range(file.take("Q"))))
    file.end()
    return Model(cameras, images, points)


def lines_of(path):
    with open(path, "rb") as file:
        return file.read().split(b"\n")


def read_text(folder):
    cameras, images, points = {}, {}, {}
    for line in lines_of(os.path.join(folder, "cameras.txt")):
        words = line.decode().split()
        if words and words[0] != "#":
            cameras[int(words[0])] = Camera(words[1], int(words[2]), int(words[3]), tuple(map(float, words[4:])))
    lines = iter(lines_of(os.path.join(folder, "images.txt")))
    for line in lines:
        words = line.split()
        if not words or words[0].startswith(b"#"):
            continue
        second = next(lines).split()
        keypoints = [(float(x), float(y), int(point)) for x, y, point in zip(*[iter(second)] * 3)]
        pose = tuple(map(float, words[1:8]))
        images[int(words[0])] = Image(pose[:4], pose[4:], int(words[8]), words[9], keypoints)
    for line in lines_of(os.path.join(folder, "points3D.txt")):
        words = line.decode().split()
        if words and words[0] != "#":
            track = [int(word) for word in words[8:]]
            points[int(words[0])] = Point(tuple(map(float, words[1:4])), tuple(map(int, words[4:7])), float(words[7]),
                                          sorted(zip(*[iter(track)] * 2)))
    return Model(cameras, images, points)


def read(folder):
    binary = os.path.exists(os.path.join(folder, "cameras.bin"))
    return read_binary(folder) if binary else read_text(folder)


def unit(quaternion):
    length = math.sqrt(sum(value * value for value in quaternion))
    return [value / length for value in quaternion]


def rotate(quaternion, at):
    w, x, y, z = unit(quaternion)
    a, b, c = at
    return ((1 - 2 * (y * y + z * z)) * a + 2 * (x * y - w * z) * b + 2 * (x * z + w * y) * c,
            2 * (x * y + w * z) * a + (1 - 2 * (x * x + z * z)) * b + 2 * (y * z - w * x) * c,
            2 * (x * z - w * y) * a + 2 * (y * z + w * x) * b + (1 - 2 * (x * x + y * y)) * c)


def in_camera(image, position):
    return [turned + shift for turned, shift in zip(rotate(image.rotation, position), image.translation)]


def distort(model, k, u, v):
    r2 = u * u + v * v
    if model == "OPENCV_FISHEYE":
        r = math.sqrt(r2)
        theta = math.atan(r)
        t2 = theta * theta
        bent = theta * (1 + k[0] * t2 + k[1] * t2 ** 2 + k[2] * t2 ** 3 + k[3] * t2 ** 4)
        return (u * bent / r, v * bent / r) if r > 1e-12 else (u, v)
    k = list(k) + [0] * (8 - len(k))  # k1 k2 p1 p2 k3 k4 k5 k6
    radial = (1 + k[0] * r2 + k[1] * r2 ** 2 + k[4] * r2 ** 3) / (1 + k[5] * r2 + k[6] * r2 ** 2 + k[7] * r2 ** 3)
    return (u * radial + 2 * k[2] * u * v + k[3] * (r2 + 2 * u * u),
            v * radial + 2 * k[3] * u * v + k[2] * (r2 + 2 * v * v))


def project(camera, at):
    """A pixel, counted from the corner of the image; None behind the camera."""
    if at[2] <= 0:
        return None
    fx, fy, cx, cy = camera.parameters[:4]
    u, v = distort(camera.model, camera.parameters[4:], at[0] / at[2], at[1] / at[2])
    return fx * u + cx, fy * v + cy


def errors(model):
    """For each point the errors of its track."""
    of_points = {}
    for number, point in model.points.items():
        of_points[number] = []
        for image_number, row in point.track:
            image = model.images[image_number]
            x, y, seen = image.keypoints[row]
            assert seen == number, "the keypoint names another point"
            at = project(model.cameras[image.camera], in_camera(image, point.position))
            of_points[number].append(math.dist(at, (x, y)) if at else math.inf)
    return of_points


def seen(model):
    return model._replace(points={number: point for number, point in model.points.items() if point.track})


def require_equal(one, other, most):
    assert one.cameras == other.cameras, "cameras differ"
    assert one.points.keys() == other.points.keys(), "points differ"
    for number, point in one.points.items():
        same = other.points[number]
        assert point._replace(error=0) == same._replace(error=0), "point %d differs" % number
        assert abs(point.error - same.error) <= 100 * most, "the error of point %d differs" % number  # pixels
    assert one.images.keys() == other.images.keys(), "images differ"
    for number, image in one.images.items():
        same = other.images[number]
        turn = max(abs(a - b) for a, b in zip(unit(image.rotation), unit(same.rotation)))
        assert turn <= most, "the rotation of image %d differs by %g" % (number, turn)
        assert image[1:] == same[1:], "image %d differs" % number


def main():
    if sys.argv[1] == "equal":
        return require_equal(read(sys.argv[2]), read(sys.argv[3]), 1e-15)
    if sys.argv[1] == "seen":
        return require_equal(seen(read(sys.argv[2])), seen(read(sys.argv[3])), float(sys.argv[4]))
    if sys.argv[1] == "count":
        model = read(sys.argv[2])
        print({"images": len(model.images), "seen": len(seen(model).points)}[sys.argv[3]])
        return
    every, off = [], []
    for folder in sys.argv[2:]:
        model = read(folder)
        for number, of_point in errors(model).items():
            every += filter(math.isfinite, of_point)
            if of_point and model.points[number].error >= 0:
                off.append(abs(sum(of_point) / len(of_point) - model.points[number].error))
    print("%.6f %.6f" % (math.sqrt(sum(error * error for error in every) / len(every)), max(off, default=math.nan)))


if __name__ == "__main__":
    main()
