#!/usr/bin/env python3
"""What slamdb writes for those who train splats and NeRFs, followed from the points to the pixels by formulas of its own.

scene.py bend IN.ndjson OUT.ndjson MODEL k...: an atlas whose keypoints a lens of COLMAP's MODEL distorts.
scene.py pictures MODEL FOLDER: a picture for every image of a model of COLMAP, whose colours tell the place.
scene.py nerf SCENE MODEL: transforms.json sees the points of points.ply where the images of the model have them.
scene.py 3dgs SCENE MODEL: so does sparse/0, its pictures are those of its pinholes, and points have their colours."""
import json
import math
import os
import struct
import sys
import zlib

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "colmap"))
import model as colmap

PERIOD, STEP = 64, 4  # of the colours, pixels; how much a pixel is, of 255


def fail(*what):
    sys.exit("FAILED: " + " ".join(map(str, what)))


def mean(values):
    return sum(values) / len(values)


# ---- pictures


def color_at(x, y):
    """Of the place x, y, counted from the centre of the first pixel; a saw tooth across, and one down."""
    return (x % PERIOD) * STEP, (y % PERIOD) * STEP


def write_ppm(path, width, height):
    across = [int(color_at(x, 0)[0]) for x in range(width)]
    rows = (b"".join(bytes((red, int(color_at(0, y)[1]), 77)) for red in across) for y in range(height))
    with open(path, "wb") as file:
        file.write(b"P6 %d %d 255\n" % (width, height) + b"".join(rows))


def read_png(path):
    with open(path, "rb") as file:
        data = file.read()
    at, packed, width, height = 8, b"", 0, 0
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        if kind == b"IHDR":
            width, height, depth, color = struct.unpack(">IIBB", data[at + 8:at + 18])
            assert (depth, color) == (8, 2), "8 bits of red, green and blue"
        if kind == b"IDAT":
            packed += data[at + 8:at + 8 + length]
        at += 12 + length
    raw, stride = zlib.decompress(packed), 3 * width
    rows, above = [], bytearray(stride)
    for y in range(height):
        kind, row = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            left, up, corner = row[i - 3] if i > 2 else 0, above[i], above[i - 3] if i > 2 else 0
            guess = left + up - corner
            paeth = min((abs(guess - left), 0, left), (abs(guess - up), 1, up), (abs(guess - corner), 2, corner))[2]
            row[i] = (row[i] + (0, left, up, (left + up) // 2, paeth)[kind]) & 255
        rows.append(row)
        above = row
    return width, height, rows


# ---- what to check with


def bend(source, target, name, parameters):
    """Distorts the keypoints as detected of a pinhole whose keypoints are undistorted, and says so in each keyframe."""
    k = [float(word) for word in parameters]
    with open(source, encoding="utf-8") as file, open(target, "w", encoding="utf-8") as out:
        for line in file:
            entry = json.loads(line)
            if entry["type"] == "keyframe":
                lens, features = entry["intrinsics"], entry["features"]
                fx, fy, cx, cy = (lens[word] for word in ("fx", "fy", "cx", "cy"))
                straight = features["keypoints"]
                features["undistorted"] = dict(straight)
                places = [colmap.distort(name, k, (x - cx) / fx, (y - cy) / fy)
                          for x, y in zip(straight["x"], straight["y"])]
                straight["x"] = [fx * u + cx for u, v in places]
                straight["y"] = [fy * v + cy for u, v in places]
                entry["distortion"] = {"rows": len(k), "columns": 1, "type": 5, "continuous": True, "values": k}
            out.write(json.dumps(entry) + "\n")


def pictures(folder, out):
    os.makedirs(out, exist_ok=True)
    model = colmap.read(folder)
    for image in model.images.values():
        camera = model.cameras[image.camera]
        name = os.path.splitext(os.path.basename(image.name.decode()))[0] + ".ppm"
        if image.name.startswith(b"right/"):
            continue
        write_ppm(os.path.join(out, name), camera.width, camera.height)


def read_ply(path):
    with open(path, "rb") as file:
        head, data = file.read().split(b"end_header\n", 1)
    size = struct.calcsize("<6f3B")
    assert len(data) % size == 0 and b"element vertex %d\n" % (len(data) // size) in head
    return [struct.unpack_from("<6f3B", data, at) for at in range(0, len(data), size)]


def keypoints_of(model):
    """Which keypoint of which image each point is, by rows of points in the order of the model's file."""
    for row, point in enumerate(model.points.values()):
        for number, at in point.track:
            yield row, model.images[number], model.images[number].keypoints[at][:2]


def pictured(model):
    """A model without the tracks of right images, of which there are no pictures."""
    return colmap.Model(model.cameras, model.images, {
        number: point._replace(track=[(n, at) for n, at in point.track if not model.images[n].name.startswith(b"right/")])
        for number, point in model.points.items()})


def require_error(found, model, what):
    wanted = mean([error for errors in colmap.errors(model).values() for error in errors])
    print("   %s: %.4f px over %d keypoints; %.4f in the model" % (what, mean(found), len(found), wanted))
    if not found or abs(mean(found) - wanted) > 0.002:
        fail(what, "sees points elsewhere")


def nerf(scene, folder):
    with open(os.path.join(scene, "transforms.json"), encoding="utf-8") as file:
        transforms = json.load(file)
    model, points = colmap.read(folder), read_ply(os.path.join(scene, transforms["ply_file_path"]))
    frames = {os.path.splitext(os.path.basename(frame["file_path"]))[0]: frame for frame in transforms["frames"]}
    found = []
    for row, image, seen in keypoints_of(model):
        if image.name.startswith(b"right/"):  # of which there are no pictures
            continue
        frame = frames[os.path.splitext(os.path.basename(image.name.decode()))[0]]
        lens = frame if "fl_x" in frame else transforms
        m = frame["transform_matrix"]  # world from camera; x right, y up, z backward
        away = [points[row][axis] - m[axis][3] for axis in range(3)]
        x, y, z = (sum(m[axis][column] * away[axis] for axis in range(3)) for column in range(3))
        names = ["k1", "k2", "k3", "k4"] if lens["camera_model"] == "OPENCV_FISHEYE" else ["k1", "k2", "p1", "p2", "k3"]
        name = "OPENCV_FISHEYE" if lens["camera_model"] == "OPENCV_FISHEYE" else "FULL_OPENCV"
        u, v = colmap.distort(name, [lens.get(word, 0) for word in names], x / -z, -y / -z)
        at = lens["fl_x"] * u + lens["cx"], lens["fl_y"] * v + lens["cy"]
        found.append(math.dist(at, seen))
        if "w" not in lens or not os.path.exists(os.path.join(scene, frame["file_path"])):
            fail(frame["file_path"], "is not there from transforms.json")
    turn = transforms["applied_transform"]
    for row, point in enumerate(model.points.values()):
        turned = [sum(a * b for a, b in zip(line, list(point.position) + [1])) for line in turn]
        if math.dist(turned, points[row][:3]) > 1e-4:
            fail("points.ply is not in the frame of applied_transform")
    require_error(found, pictured(model), "transforms.json")


def gaussian(scene, folder):
    """The loader of 3D Gaussian splatting knows PINHOLE and SIMPLE_PINHOLE, and finds pictures by the end of their names."""
    model, lens_model = colmap.read(os.path.join(scene, "sparse/0")), pictured(colmap.read(folder))
    points = read_ply(os.path.join(scene, "sparse/0/points3D.ply"))
    for camera in model.cameras.values():
        if camera.model != "PINHOLE":
            fail("a camera is", camera.model)
    bent = any(len(camera.parameters) > 4 for camera in lens_model.cameras.values())
    found, exact = [], []
    for number, point in model.points.items():
        for image_number, at in lens_model.points[number].track:
            image, lens_image = model.images[image_number], lens_model.images[image_number]
            lens = lens_model.cameras[lens_image.camera]
            straight = colmap.project(model.cameras[image.camera], colmap.in_camera(image, point.position))
            seen = colmap.project(lens, colmap.in_camera(lens_image, lens_model.points[number].position))
            camera = model.cameras[image.camera].parameters
            u, v = (image.keypoints[at][0] - camera[2]) / camera[0], (image.keypoints[at][1] - camera[3]) / camera[1]
            u, v = colmap.distort(lens.model, lens.parameters[4:], u, v)
            again = lens.parameters[0] * u + lens.parameters[2], lens.parameters[1] * v + lens.parameters[3]
            exact.append(math.dist(again, lens_image.keypoints[at][:2]))
            found.append(math.dist(seen, lens_image.keypoints[at][:2]))
            if not straight:
                fail("a point behind a camera")
    require_error(found, lens_model, "sparse/0")
    if sorted(exact)[int(0.99 * len(exact))] > 0.05:
        fail("keypoints are not where the pinhole sees them:", sorted(exact)[-5:])
    for image in model.images.values():
        if not os.path.exists(os.path.join(scene, "images", os.path.basename(image.name.decode()))):
            fail(image.name, "has no picture")
    check_colors(model, lens_model, points)
    check_pictures(scene, model, lens_model, bent)


def check_colors(model, lens_model, points):
    colored = 0
    for row, (number, point) in enumerate(model.points.items()):
        if tuple(points[row][6:]) != point.color or math.dist(points[row][:3], point.position) > 1e-4:
            fail("points3D.ply is not points3D.bin")
        shown = [(image, lens_model.images[image].keypoints[at]) for image, at in lens_model.points[number].track]
        if not shown or point.color == (128, 128, 128):
            continue
        colored += 1
        colors = [color_at(math.floor(x), math.floor(y)) for image, (x, y, _) in shown]  # the pixel around the place
        for channel in range(2):
            if abs(mean([color[channel] for color in colors]) - point.color[channel]) > 1:
                fail("point", number, "is", point.color, "and pictures show", colors)
    if colored < 0.9 * len([point for point in lens_model.points.values() if point.track]):
        fail("only", colored, "points have a colour")


def check_pictures(scene, model, lens_model, bent):
    """Each pixel shows what the lens saw in the direction of the pinhole's pixel, to a tenth of a pixel on average."""
    off = []
    for number, image in sorted(model.images.items())[:2]:
        path = os.path.join(scene, "images", os.path.basename(image.name.decode()))
        if not bent:
            continue
        width, height, rows = read_png(path)
        camera, lens = model.cameras[image.camera], lens_model.cameras[lens_model.images[number].camera]
        if (width, height) != (camera.width, camera.height):
            fail(path, "has", width, height, "and its camera", camera.width, camera.height)
        fx, fy, cx, cy = camera.parameters
        for y in range(3, height, 7):
            for x in range(3, width, 7):
                u, v = colmap.distort(lens.model, lens.parameters[4:], (x + 0.5 - cx) / fx, (y + 0.5 - cy) / fy)
                at = lens.parameters[0] * u + lens.parameters[2] - 0.5, lens.parameters[1] * v + lens.parameters[3] - 0.5
                inside = all(1 < value < side - 2 for value, side in zip(at, (lens.width, lens.height)))
                if not inside or any(not 1 < value % PERIOD < PERIOD - 2 for value in at):  # the teeth of the saw
                    continue
                pixel = rows[y][3 * x:3 * x + 3]
                off += [(pixel[channel] - color_at(*at)[channel]) / STEP for channel in range(2)]
    if bent:
        print("   pictures: off by %.4f px, at most %.3f, over %d" % (mean(off), max(map(abs, off)), len(off)))
        if abs(mean(off)) > 0.05 or max(map(abs, off)) > 0.3:
            fail("pictures are not what the pinhole sees")


if __name__ == "__main__":
    arguments = sys.argv[2:]
    {"bend": lambda: bend(*arguments[:3], arguments[3:]), "pictures": lambda: pictures(*arguments),
     "nerf": lambda: nerf(*arguments), "3dgs": lambda: gaussian(*arguments)}[sys.argv[1]]()
