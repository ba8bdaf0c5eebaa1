// Unpacks an LZMA file (xz --format=lzma), which is a third smaller than what browsers unpack themselves. The format is
// that of Pavlov's LZMA specification.

export function unpackLzma(bytes) {
  const lc = bytes[0] % 9, lp = Math.floor(bytes[0] / 9) % 5, pb = Math.floor(bytes[0] / 45);
  const view = new DataView(bytes.buffer, bytes.byteOffset), size = view.getUint32(5, true);
  const out = new Uint8Array(size);
  let at = 18, range = 0xffffffff, code = view.getUint32(14);

  // Probabilities that a bit is 0, of 2048.
  const fresh = (count) => new Uint16Array(count).fill(1024);
  const literal = fresh(0x300 << (lc + lp)), isMatch = fresh(192), isRep = fresh(12), isRep0 = fresh(12), isRep1 = fresh(12), isRep2 = fresh(12), isRep0Long = fresh(192);
  const slots = [fresh(64), fresh(64), fresh(64), fresh(64)], special = fresh(128), align = fresh(16);
  const lengths = () => ({ choice: fresh(2), low: fresh(16 << 3), middle: fresh(16 << 3), high: fresh(256) });
  const matchLength = lengths(), repLength = lengths();

  function normalize() {
    if (range >= 0x1000000) return;
    range = (range * 256) >>> 0;
    code = ((code << 8) | bytes[at++]) >>> 0;
  }
  function bit(probabilities, i) {
    const p = probabilities[i], bound = (range >>> 11) * p;
    let result = 0;
    if (code < bound) {
      range = bound;
      probabilities[i] = p + ((2048 - p) >>> 5);
    } else {
      range -= bound;
      code -= bound;
      probabilities[i] = p - (p >>> 5);
      result = 1;
    }
    normalize();
    return result;
  }
  function tree(probabilities, offset, bits) {
    let m = 1;
    for (let i = 0; i < bits; ++i) m = (m << 1) | bit(probabilities, offset + m);
    return m - (1 << bits);
  }
  function reverseTree(probabilities, offset, bits) {
    let m = 1, result = 0;
    for (let i = 0; i < bits; ++i) {
      const b = bit(probabilities, offset + m);
      m = (m << 1) | b;
      result |= b << i;
    }
    return result;
  }
  function direct(bits) {
    let result = 0;
    for (let i = 0; i < bits; ++i) {
      range >>>= 1;
      const b = code >= range ? 1 : 0;
      if (b) code -= range;
      normalize();
      result = result * 2 + b;
    }
    return result;
  }
  function readLength(from, position) {
    if (bit(from.choice, 0) === 0) return 2 + tree(from.low, position << 3, 3);
    if (bit(from.choice, 1) === 0) return 10 + tree(from.middle, position << 3, 3);
    return 18 + tree(from.high, 0, 8);
  }
  function readDistance(length) {
    const slot = tree(slots[Math.min(length - 2, 3)], 0, 6);
    if (slot < 4) return slot;
    const bits = (slot >> 1) - 1, base = (2 | (slot & 1)) * 2 ** bits;
    if (slot < 14) return base + reverseTree(special, base - slot, bits);
    return base + direct(bits - 4) * 16 + reverseTree(align, 0, 4);
  }
  function readLiteral(n, state, distance) {
    const before = n > 0 ? out[n - 1] : 0;
    const offset = 0x300 * (((n & ((1 << lp) - 1)) << lc) + (before >> (8 - lc)));
    let symbol = 1;
    if (state >= 7) {
      let match = out[n - distance - 1];
      while (symbol < 0x100) {
        const expected = (match >> 7) & 1, b = bit(literal, offset + ((1 + expected) << 8) + symbol);
        match <<= 1;
        symbol = (symbol << 1) | b;
        if (expected !== b) break;
      }
    }
    while (symbol < 0x100) symbol = (symbol << 1) | bit(literal, offset + symbol);
    return symbol & 0xff;
  }

  let state = 0, distances = [0, 0, 0, 0];
  for (let n = 0; n < size;) {
    const position = n & ((1 << pb) - 1), at0 = (state << 4) + position;
    if (bit(isMatch, at0) === 0) {
      out[n] = readLiteral(n, state, distances[0]);
      ++n;
      state = state < 4 ? 0 : state < 10 ? state - 3 : state - 6;
      continue;
    }
    let length;
    if (bit(isRep, state) === 0) {
      length = readLength(matchLength, position);
      distances = [readDistance(length), ...distances.slice(0, 3)];
      if (distances[0] === 0xffffffff) break;  // the end mark
      state = state < 7 ? 7 : 10;
    } else {
      let which = 0;
      if (bit(isRep0, state) === 0) {
        if (bit(isRep0Long, at0) === 0) {
          out[n] = out[n - distances[0] - 1];
          ++n;
          state = state < 7 ? 9 : 11;
          continue;
        }
      } else {
        which = bit(isRep1, state) === 0 ? 1 : 2 + bit(isRep2, state);
      }
      distances.unshift(...distances.splice(which, 1));
      length = readLength(repLength, position);
      state = state < 7 ? 8 : 11;
    }
    for (const from = distances[0] + 1; length > 0 && n < size; --length, ++n) out[n] = out[n - from];
  }
  return out;
}
