// How columns lie in the file (schema/view.md): variable numbers, differences, quantised positions.

/** What the page says where its data cannot be decoded. */
export class DamagedData extends Error {}

export const kBlockRows = 4096;

/** Little-endian base-128 numbers, one after the other. Exact up to 2^53. */
export class Varints {
  position = 0;
  constructor(readonly bytes: Uint8Array, readonly name: string) {}

  get atEnd(): boolean {
    return this.position >= this.bytes.length;
  }

  next(): number {
    const bytes = this.bytes;
    let byte = bytes[this.position++];
    if (byte < 0x80) return byte;
    let value = byte & 0x7f;
    for (let shift = 7; shift < 28; shift += 7) {
      byte = bytes[this.position++];
      value |= (byte & 0x7f) << shift;
      if (byte < 0x80) return value;
    }
    return this.rest(value);
  }

  /** zigzag: 0, 1, 2, 3, ... are 0, -1, 1, -2, ... */
  signed(): number {
    const value = this.next();
    if (value < 0x80000000) return (value >>> 1) ^ -(value & 1);
    return value % 2 === 0 ? value / 2 : -(value + 1) / 2;
  }

  /** What goes beyond 28 bits, where shifts would overflow; and where the column ends within a number. */
  private rest(low: number): number {
    let value = low;
    let weight = 2 ** 28;
    for (;;) {
      if (this.atEnd || weight > 2 ** 63) throw new DamagedData(`column ${this.name} ends within a number`);
      const byte = this.bytes[this.position++];
      value += (byte & 0x7f) * weight;
      if (byte < 0x80) return value;
      weight *= 128;
    }
  }

  /** Throws unless everything was read and nothing beyond: reading on yields no bytes, and no error before. */
  finish(): void {
    if (this.position !== this.bytes.length) {
      throw new DamagedData(`column ${this.name} holds ${this.bytes.length} bytes where ${this.position} belong`);
    }
  }
}

export function expectBytes(bytes: Uint8Array, expected: number, name: string): void {
  if (bytes.length !== expected) {
    throw new DamagedData(`column ${name} holds ${bytes.length} bytes where ${expected} belong`);
  }
}

/** Sums of signed differences; small numbers as 32-bit integers, larger ones as doubles. */
export function readDifferences(bytes: Uint8Array, rows: number, name: string): Int32Array | Float64Array {
  const input = new Varints(bytes, name);
  let values: Int32Array | Float64Array = new Int32Array(rows);
  let sum = 0;
  for (let row = 0; row < rows; ++row) {
    sum += input.signed();
    if (values instanceof Int32Array && (sum > 0x7fffffff || sum < -0x80000000)) values = Float64Array.from(values);
    values[row] = sum;
  }
  input.finish();
  return values;
}

/** As readDifferences, of numbers that are rows of a table of `limit` rows, or -1. */
export function readRows(bytes: Uint8Array, rows: number, limit: number, name: string): Int32Array {
  const values = readDifferences(bytes, rows, name);
  for (let row = 0; row < rows; ++row) {
    if (values[row] < -1 || values[row] >= limit) throw new DamagedData(`column ${name} names row ${values[row]} of ${limit}`);
  }
  return values as Int32Array;
}

/** Quantised coordinates: blocks of differences, all low bytes of a block, then all its high bytes. `maps` are row counts. */
export function readQuantised(bytes: Uint8Array, maps: number[], name: string): Uint16Array {
  const rows = maps.reduce((sum, count) => sum + count, 0);
  expectBytes(bytes, rows * 2, name);
  const values = new Uint16Array(rows);
  let row = 0;
  for (const count of maps) {
    for (let begin = 0; begin < count; begin += kBlockRows) {
      const size = Math.min(kBlockRows, count - begin);
      let last = 0;
      for (let i = 0, low = row * 2, high = row * 2 + size; i < size; ++i) {
        last = (last + bytes[low + i] + (bytes[high + i] << 8)) & 0xffff;
        values[row + i] = last;
      }
      row += size;
    }
  }
  return values;
}

/** Who saw each point: kept as it lies in the file, with the place of every 256th row, since few rows are ever asked for. */
export class Observers {
  static readonly kStep = 256;
  private readonly place: Uint32Array;
  private readonly base: Int32Array;

  /** Walks all once, and tells every row to `visit`: its keyframe rows are buffer[0 .. count). */
  constructor(
    private readonly bytes: Uint8Array, readonly rows: number, private readonly keyframes: number,
    visit: (row: number, buffer: Int32Array, count: number) => void,
  ) {
    this.place = new Uint32Array(Math.ceil(rows / Observers.kStep));
    this.base = new Int32Array(this.place.length);
    const input = new Varints(bytes, "points/seen");
    this.walk(input, 0, rows, 0, (row, buffer, count, base) => {
      if (row % Observers.kStep === 0) {
        this.place[row / Observers.kStep] = this.rowBegin;
        this.base[row / Observers.kStep] = base;
      }
      visit(row, buffer, count);
    });
    input.finish();
  }

  of(row: number): Int32Array {
    const step = Math.floor(row / Observers.kStep);
    const input = new Varints(this.bytes, "points/seen");
    input.position = this.place[step];
    let found = new Int32Array(0);
    this.walk(input, step * Observers.kStep, row + 1, this.base[step], (at, buffer, count) => {
      if (at === row) found = buffer.slice(0, count);
    });
    return found;
  }

  /** Rows of the points in [first, last) that a keyframe saw; begins at a multiple of kStep at or before `first`. */
  seenBy(keyframe: number, first: number, last: number): number[] {
    const found: number[] = [];
    if (first >= last) return found;
    const step = Math.floor(first / Observers.kStep);
    const input = new Varints(this.bytes, "points/seen");
    input.position = this.place[step];
    this.walk(input, step * Observers.kStep, last, this.base[step], (row, buffer, count) => {
      if (row < first) return;
      for (let i = 0; i < count && buffer[i] <= keyframe; ++i) {
        if (buffer[i] === keyframe) found.push(row);
      }
    });
    return found;
  }

  private rowBegin = 0;

  private walk(
    input: Varints, first: number, last: number, base: number,
    visit: (row: number, buffer: Int32Array, count: number, base: number) => void,
  ): void {
    let buffer = new Int32Array(64);
    for (let row = first; row < last; ++row) {
      this.rowBegin = input.position;
      const before = base;
      const count = input.next();
      if (!(count <= this.keyframes)) throw new DamagedData(`column points/seen: row ${row} is seen by ${count} keyframes`);
      if (count > buffer.length) buffer = new Int32Array(count * 2);
      let keyframe = 0;
      for (let i = 0; i < count; ++i) {
        keyframe = i === 0 ? base + input.signed() : keyframe + input.next();
        if (!(keyframe >= 0 && keyframe < this.keyframes)) throw new DamagedData(`column points/seen: row ${row} names keyframe row ${keyframe}`);
        buffer[i] = keyframe;
        if (i === 0) base = keyframe;
      }
      visit(row, buffer, count, before);
    }
  }
}
