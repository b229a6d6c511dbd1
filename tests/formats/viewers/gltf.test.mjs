// SPDX-License-Identifier: BSD-3-Clause
// .glb as Khronos' validator has it, and its numbers as `dump` has them.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { validateBytes } from "gltf-validator";
import { atlases, converted, dump, fixture } from "./slamdb.mjs";

function parse(bytes) {
  const length = bytes.readUInt32LE(12);
  return { json: JSON.parse(bytes.subarray(20, 20 + length)), binary: bytes.subarray(28 + length) };
}

for (const atlas of atlases())
  for (const options of [[], ["--color", "height"]])
    test(`the validator finds nothing in ${atlas} ${options}`, async () => {
      const report = await validateBytes(new Uint8Array(converted(atlas, ".glb", ...options)), { maxIssues: 20 });
      assert.equal(report.issues.numErrors, 0, JSON.stringify(report.issues.messages));
      assert.equal(report.issues.numWarnings, 0, JSON.stringify(report.issues.messages));
    });

test("the validator finds nothing in the fixture, which has two maps", async () => {
  const { issues } = await validateBytes(new Uint8Array(readFileSync(fixture("formats/gltf"))));
  assert.deepEqual([issues.numErrors, issues.numWarnings], [0, 0], JSON.stringify(issues.messages));
});

test("points and keyframes are those of the atlas", () => {
  const atlas = fixture("session_small_a/session_small_a.osa");
  const { json, binary } = parse(converted(atlas, ".glb"));
  const { map_point, keyframe } = dump(atlas);
  const points = map_point.filter((point) => !point.bad);
  const { attributes, mode } = json.meshes.find((mesh) => mesh.name === "map 0 points").primitives[0];
  assert.equal(mode, 0);
  const at = (name, row) => {
    const accessor = json.accessors[attributes[name]];
    const view = json.bufferViews[accessor.bufferView];
    assert.equal(accessor.count, points.length);
    return view.byteOffset + accessor.byteOffset + row * view.byteStride;
  };
  points.forEach((point, row) => {
    assert.equal(binary.readBigUInt64LE(at("_ID", row)), BigInt(point.id));
    assert.equal(binary.readFloatLE(at("_OBSERVATIONS", row)), point.observations.length);
    const length = Math.hypot(...point.normal);
    for (let i = 0; i < 3; ++i) {
      assert.equal(binary.readFloatLE(at("POSITION", row) + 4 * i), Math.fround(point.position[i]));
      assert.ok(Math.abs(binary.readFloatLE(at("NORMAL", row) + 4 * i) + point.normal[i] / length) < 1e-6);
    }
  });
  const byName = new Map(json.nodes.map((node) => [node.name, node]));
  for (const { id, timestamp, camera_from_world: pose } of keyframe) {
    const node = byName.get(`kf ${id}`);
    assert.deepEqual(node.extras, { keyframe: id, timestamp });
    const [x, y, z, w] = node.rotation; // world from camera
    const turned = pose.rotation_xyzw.map((value, i) => (i < 3 ? -value : value));
    const same = Math.abs(x * turned[0] + y * turned[1] + z * turned[2] + w * turned[3]);
    assert.ok(Math.abs(same - 1) < 1e-5);
  }
  const camera = json.meshes[byName.get("kf 0").mesh].primitives[0];
  assert.equal(camera.mode, 1);
  assert.equal(json.accessors[camera.indices].count, 16);
});

test("up is y", () => {
  const { json } = parse(converted(fixture("session_small_a/session_small_a.osa"), ".glb"));
  const root = json.nodes[json.scenes[json.scene].nodes[0]];
  assert.equal(root.name, "map 0");
  const [x, y, z, w] = root.rotation; // from x right, z forward, and y down but for the tilt of the first camera
  assert.ok(Math.abs(x) > 0.99, `${[x, y, z, w]}`);
});
