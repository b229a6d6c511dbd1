// SPDX-License-Identifier: BSD-3-Clause
// KML and GeoJSON: well-formed, valid, and where the map is.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { check } from "@placemarkio/check-geojson";
import { kml } from "@tmcw/togeojson";
import { DOMParser } from "@xmldom/xmldom";
import { atlases, convert, dump, fixture } from "./slamdb.mjs";

const small = fixture("session_small_a/session_small_a.osa");

for (const atlas of atlases())
  test(`GeoJSON of ${atlas} is RFC 7946`, () => {
    const json = check(readFileSync(convert(atlas, ".geojson", "--origin", "48.15,11.57,519", "--most-points", "500"), "utf8"));
    assert.equal(json.type, "FeatureCollection");
  });

test("GeoJSON is cut at the antimeridian", () => {
  const { features } = check(readFileSync(convert(small, ".geojson", "--origin", "0,-179.99999,0"), "utf8"));
  const { geometry, properties } = features[0];
  assert.equal(geometry.type, "MultiLineString");
  for (const line of geometry.coordinates)
    assert.ok(line.length > 1 && new Set(line.map(([longitude]) => Math.sign(longitude))).size === 1);
  assert.deepEqual(properties.coordTimes.map((times) => times.length), geometry.coordinates.map((line) => line.length));
});

test("keyframes are metres east, north and up of the origin", () => {
  const { features } = check(readFileSync(convert(small, ".geojson", "--origin", "0,0,0"), "utf8"));
  const frames = new Map(dump(small).keyframe.map((frame) => [frame.id, frame]));
  const placed = features.filter(({ properties }) => properties.kind === "keyframe");
  assert.equal(placed.length, frames.size);
  for (const { geometry, properties } of placed) {
    const [x, y, z] = centre(frames.get(properties.id).camera_from_world);
    const [longitude, latitude, altitude] = geometry.coordinates;
    // Near the equator a degree is 111319.4908 m of longitude, 110574.2758 m of latitude.
    assert.ok(Math.abs(longitude * 111319.4908 - x) < 2e-3);
    assert.ok(Math.abs(latitude * 110574.2758 - y) < 2e-3);
    assert.ok(Math.abs(altitude - z) < 2e-3);
    assert.ok(Math.abs(Date.parse(properties.time) / 1000 - properties.timestamp) < 1e-3);
  }
});

function centre({ rotation_xyzw: [x, y, z, w], translation: t }) {
  const q = [-x, -y, -z];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const u = cross(q, t).map((value, i) => value + w * t[i]);
  return cross(q, u).map((value, i) => -(t[i] + 2 * value));
}

const xmllint = (() => {
  try {
    execFileSync("xmllint", ["--version"], { stdio: "ignore" });
    return true;
  } catch {
    return false;
  }
})();

for (const atlas of atlases())
  test(`KML of ${atlas} is well-formed XML`, { skip: !xmllint && "xmllint is not installed" }, () => {
    execFileSync("xmllint", ["--noout", convert(atlas, ".kml", "--origin", "48.15,11.57,519")]);
  });

test("a reader of KML finds in it what GeoJSON has", () => {
  const where = ["--origin", "48.15,11.57,519"];
  const text = readFileSync(convert(small, ".kml", ...where), "utf8");
  const { features } = kml(new DOMParser().parseFromString(text, "text/xml"));
  const expected = check(readFileSync(convert(small, ".geojson", ...where), "utf8")).features;
  const of = (kind) => expected.filter(({ properties }) => properties.kind === kind);

  const track = features.find(({ properties }) => properties.name === "map 0 trajectory");
  assert.deepEqual(track.geometry.coordinates, of("trajectory")[0].geometry.coordinates);
  assert.deepEqual(track.properties.coordinateProperties.times, of("trajectory")[0].properties.coordTimes);
  assert.equal(track.properties.stroke, of("trajectory")[0].properties.stroke);

  const placed = features.filter(({ properties }) => properties.name.startsWith("kf "));
  assert.deepEqual(placed.map(({ geometry }) => geometry), of("keyframe").map(({ geometry }) => geometry));
  assert.deepEqual(placed.map(({ properties }) => properties.timestamp), of("keyframe").map(({ properties }) => properties.time));

  const points = features.find(({ properties }) => properties.name === "map 0 points").geometry;
  assert.deepEqual(points.geometries.map(({ coordinates }) => coordinates), of("point").map(({ geometry }) => geometry.coordinates));
});
