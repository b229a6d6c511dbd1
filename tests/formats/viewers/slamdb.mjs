// SPDX-License-Identifier: BSD-3-Clause
// The command, and the atlases that tests run on.
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, readdirSync } from "node:fs";
import { tmpdir } from "node:os";
import { basename, join } from "node:path";

const SLAMDB = process.env.SLAMDB ?? "build/dev/slamdb";
const FIXTURES = new URL("../../../fixtures", import.meta.url).pathname;
const folder = mkdtempSync(join(tmpdir(), "slamdb-viewers-"));

export const fixture = (name) => join(FIXTURES, name);

// Those of the repository, and the large ones of SLAMDB_ATLASES.
export function atlases() {
  const small = ["tiny/tiny.osa", "session_small_a/session_small_a.osa", "session_small_b/session_small_b.osa",
    "mono_small_twice/mono_small_twice.osa"].map(fixture);
  const large = process.env.SLAMDB_ATLASES;
  if (!large) return small;
  return small.concat(readdirSync(large).filter((name) => name.endsWith(".osa")).map((name) => join(large, name)));
}

export const run = (...words) => execFileSync(SLAMDB, words, { maxBuffer: 2 ** 31 - 1, stdio: ["ignore", "pipe", "ignore"] });

// What `convert` writes, and where that is.
export function convert(atlas, suffix, ...options) {
  const path = join(folder, basename(atlas) + suffix);
  run("convert", atlas, path, "-O", "--no-sync", ...options);
  return path;
}
export const converted = (atlas, suffix, ...options) => readFileSync(convert(atlas, suffix, ...options));

// The objects of `dump`, by type.
export function dump(atlas) {
  const objects = { keyframe: [], map_point: [], map: [] };
  for (const line of run("dump", atlas).toString().split("\n"))
    if (line) {
      const object = JSON.parse(line);
      (objects[object.type] ??= []).push(object);
    }
  return objects;
}
