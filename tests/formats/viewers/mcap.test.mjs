// SPDX-License-Identifier: BSD-3-Clause
// .mcap as the official reader has it, in order and by the index, with all checksums; messages by the descriptors in the
// file, and their numbers as `dump` has them.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import protobuf from "protobufjs";
import "protobufjs/ext/descriptor.js";
import { atlases, converted, dump, fixture } from "./slamdb.mjs";

function readInOrder(bytes) {
  const reader = new McapStreamReader({ includeChunks: true, validateCrcs: true });
  reader.append(bytes);
  const records = [];
  for (let record; (record = reader.nextRecord()); ) records.push(record);
  assert.ok(reader.done());
  return records;
}

async function readByIndex(bytes, filter = {}) {
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, length) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + length))),
  };
  const reader = await McapIndexedReader.Initialize({ readable });
  const types = new Map();
  for (const [id, schema] of reader.schemasById) {
    assert.equal(schema.encoding, "protobuf");
    const set = protobuf.descriptor.FileDescriptorSet.decode(schema.data);
    types.set(id, protobuf.Root.fromDescriptor(set).lookupType(schema.name));
  }
  const messages = [];
  for await (const message of reader.readMessages(filter)) {
    const channel = reader.channelsById.get(message.channelId);
    messages.push({
      topic: channel.topic,
      time: message.logTime,
      value: types.get(channel.schemaId).decode(message.data),
      schema: reader.schemasById.get(channel.schemaId).name,
    });
  }
  return { reader, messages };
}

for (const atlas of atlases())
  test(`the official reader reads ${atlas} in order and by its index`, async () => {
    const bytes = converted(atlas, ".mcap");
    const records = readInOrder(bytes);
    const count = (type) => records.filter((record) => record.type === type).length;
    const { reader, messages } = await readByIndex(bytes);
    assert.equal(messages.length, count("Message"));
    assert.equal(reader.statistics.messageCount, BigInt(messages.length));
    assert.equal(reader.statistics.chunkCount, reader.chunkIndexes.length);
    assert.equal(reader.chunkIndexes.length, count("Chunk"));
    for (const [id, number] of reader.statistics.channelMessageCounts)
      assert.equal(records.filter((record) => record.type === "Message" && record.channelId === id).length, Number(number));
    const times = messages.map((message) => message.time);
    assert.ok(times.every((time, i) => i === 0 || times[i - 1] <= time));
  });

test("messages hold what the atlas holds", async () => {
  const atlas = fixture("session_small_a/session_small_a.osa");
  const { messages } = await readByIndex(converted(atlas, ".mcap"));
  const { map_point, keyframe } = dump(atlas);
  const of = (topic) => messages.filter((message) => message.topic === topic);
  const points = map_point.filter((point) => !point.bad);

  const [{ value: cloud, schema }] = of("/map_0/points");
  assert.equal(schema, "foxglove.PointCloud");
  assert.equal(cloud.frame_id, "map_0");
  assert.equal(cloud.data.length, points.length * cloud.point_stride);
  const data = Buffer.from(cloud.data);
  const offset = (name) => cloud.fields.find((field) => field.name === name).offset;
  points.forEach((point, row) => {
    const start = row * cloud.point_stride;
    ["x", "y", "z"].forEach((name, i) => assert.equal(data.readFloatLE(start + offset(name)), Math.fround(point.position[i])));
    ["normal_x", "normal_y", "normal_z"].forEach((name, i) =>
      assert.equal(data.readFloatLE(start + offset(name)), Math.fround(point.normal[i])));
    assert.equal(data.readUInt32LE(start + offset("observations")), point.observations.length);
    assert.equal(data.readUInt32LE(start + offset("id")), point.id);
  });

  const sorted = keyframe.toSorted((a, b) => a.timestamp - b.timestamp);
  assert.equal(of("/map_0/poses")[0].value.poses.length, sorted.length);
  const transforms = of("/tf").filter((message) => message.value.child_frame_id === "map_0/camera");
  assert.equal(transforms.length, sorted.length);
  transforms.forEach(({ value, time }, row) => {
    assert.ok(Math.abs(Number(time) / 1e9 - sorted[row].timestamp) < 1e-6);
    const stamp = value.timestamp;
    assert.equal(BigInt(stamp.seconds.toString()) * 1_000_000_000n + BigInt(stamp.nanos), time);
    const pose = of("/map_0/poses")[0].value.poses[row];
    for (const axis of "xyz") assert.equal(value.translation[axis], pose.position[axis]);
    for (const part of "xyzw") assert.equal(value.rotation[part], pose.orientation[part]);
  });

  const entities = new Map(of("/map_0/graph")[0].value.entities.map((entity) => [entity.id, entity.lines[0]]));
  const edges = new Set();
  const known = new Set(sorted.map((frame) => frame.id));
  for (const frame of sorted)
    for (const { keyframe: other } of frame.connections)
      if (known.has(other)) edges.add([frame.id, other].sort((a, b) => a - b).join());
  assert.equal(entities.get("covisibility").indices.length, 2 * edges.size);
  assert.equal(entities.get("spanning tree").indices.length, 2 * (sorted.length - 1));
  assert.equal(entities.get("cameras").points.length, 5 * sorted.length);

  const [{ value: calibration }] = of("/map_0/camera");
  assert.deepEqual([calibration.K[0], calibration.K[4]], [450, 450]);
  assert.equal(calibration.frame_id, "map_0/camera");
  assert.equal(calibration.width, 640);
});

test("the fixture has topics for each of its two maps", async () => {
  const { reader } = await readByIndex(readFileSync(fixture("formats/mcap")));
  const topics = [...reader.channelsById.values()].map((channel) => channel.topic).sort();
  const of = (map) => ["camera", "graph", "points", "poses"].map((name) => `/map_${map}/${name}`);
  assert.deepEqual(topics, [...of(0), ...of(1), "/tf"]);
});

test("a player seeks", async () => {
  const atlas = fixture("session_small_a/session_small_a.osa");
  const bytes = converted(atlas, ".mcap");
  const all = (await readByIndex(bytes)).messages;
  const middle = all[Math.floor(all.length / 2)].time;
  const later = (await readByIndex(bytes, { startTime: middle })).messages;
  assert.equal(later.length, all.filter((message) => message.time >= middle).length);
});

test("a damaged chunk is seen by its checksum", () => {
  const bytes = Buffer.from(converted(fixture("tiny/tiny.osa"), ".mcap"));
  const chunk = readInOrder(bytes).find((record) => record.type === "Chunk");
  const at = bytes.indexOf(Buffer.from(chunk.records.slice(0, 64)));
  bytes[at + 60] ^= 1;
  assert.throws(() => readInOrder(bytes), /CRC/i);
});
