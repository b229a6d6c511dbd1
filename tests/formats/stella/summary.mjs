// summary.mjs MAP.msg: what summary.py prints, with npm's MessagePack library.
import { decode } from "@msgpack/msgpack";
import { readFileSync } from "node:fs";

const stored = decode(readFileSync(process.argv[2]));
const bits = (value) => {
  const buffer = Buffer.alloc(4);
  buffer.writeFloatLE(value);
  return buffer.toString("hex");
};
const seconds = (value) => (Number.isInteger(value) ? value.toFixed(1) : String(value));
const sorted = (table) => Object.entries(table).sort((a, b) => Number(a[0]) - Number(b[0]));
const sum = (values) => values.reduce((all, value) => all + value, 0);

const keyframes = sorted(stored.keyframes);
console.log("keyframes", keyframes.length, "keypoints", sum(keyframes.map(([, k]) => k.n_keypts)), ".");
for (const [name, k] of keyframes)
  console.log(
    [name, seconds(k.ts), ...[...k.rot_cw, ...k.trans_cw].map(bits), k.span_parent, sum(k.descs.flat()),
      sum(k.lm_ids.filter((id) => id >= 0)), ...k.undist_keypts.slice(0, 3).flatMap((p) => p.pt.map(bits))].join(" "));
const points = sorted(stored.landmarks);
console.log("landmarks", points.length, ".");
for (const [name, point] of points) console.log([name, ...point.pos_w.map(bits), point.ref_keyfrm].join(" "));
