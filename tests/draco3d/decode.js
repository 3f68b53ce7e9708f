// Reads every sample in a folder (draco3d_samples.cpp says what one holds) with the npm package draco3d, compares each
// value with what C++ libdraco read, and prints how long decoding took. For Node.js; in a browser page.html calls it.

/** A sample's parts, as views of its bytes copied to where each type may stand. */
function parse(bytes) {
  const head = new Int32Array(bytes.slice(0, 28));
  const [vertices, triangles, position, normal, color, grid, size] = head;
  let at = 28;
  const take = (Type, count) => {
    const end = at + count * Type.BYTES_PER_ELEMENT, values = new Type(bytes.slice(at, end));
    at = end;
    return values;
  };
  return {
    vertices, triangles,
    stream: take(Int8Array, size),
    attributes: [
      {name: 'offsets', id: position, expected: take(Uint16Array, 3 * vertices), type: 'DT_UINT16'},
      {name: 'normals', id: normal, expected: take(Float32Array, 3 * vertices), type: 'DT_FLOAT32'},
      {name: 'colours', id: color, expected: take(Uint8Array, color < 0 ? 0 : 3 * vertices), type: 'DT_UINT8'},
      {name: 'grid indices', id: grid, expected: take(Uint16Array, vertices), type: 'DT_UINT16'},
    ].filter((attribute) => attribute.id >= 0),
    indices: take(Uint32Array, 3 * triangles),
  };
}

/** Copies what the decoder wrote to its own memory. */
function readValues(draco, expected, write) {
  const size = expected.byteLength, pointer = draco._malloc(size);
  try {
    if (!write(size, pointer)) throw new Error('draco3d refuses');
    return new expected.constructor(draco.HEAPU8.slice(pointer, pointer + size).buffer);
  } finally {
    draco._free(pointer);
  }
}

/** All values of a sample, decoded. */
function decode(draco, sample) {
  const decoder = new draco.Decoder(), buffer = new draco.DecoderBuffer(), mesh = new draco.Mesh();
  try {
    buffer.Init(sample.stream, sample.stream.length);
    const status = decoder.DecodeBufferToMesh(buffer, mesh);
    if (!status.ok()) throw new Error(status.error_msg());
    if (mesh.num_points() !== sample.vertices || mesh.num_faces() !== sample.triangles) throw new Error('another size');
    const values = sample.attributes.map((attribute) => readValues(draco, attribute.expected, (size, pointer) =>
      decoder.GetAttributeDataArrayForAllPoints(mesh, decoder.GetAttributeByUniqueId(mesh, attribute.id),
                                                draco[attribute.type], size, pointer)));
    values.push(readValues(draco, sample.indices, (size, pointer) =>
      decoder.GetTrianglesUInt32Array(mesh, size, pointer)));
    return values;
  } finally {
    for (const owned of [mesh, buffer, decoder]) draco.destroy(owned);
  }
}

const sameBits = (a, b) => {
  const left = new Uint8Array(a.buffer), right = new Uint8Array(b.buffer);
  return left.length === right.length && left.every((value, i) => value === right[i]);
};

const median = (values) => values.sort((a, b) => a - b)[Math.floor(values.length / 2)];

/** samples: [name, ArrayBuffer]. One line for each setting, the part of a name before its first dot. Throws at the first difference. */
function compareAll(draco, samples) {
  const perSetting = new Map();
  for (const [name, bytes] of samples) {
    const sample = parse(bytes), begin = performance.now(), values = decode(draco, sample);
    const took = performance.now() - begin;
    const expected = [...sample.attributes.map((attribute) => attribute.expected), sample.indices];
    const names = [...sample.attributes.map((attribute) => attribute.name), 'triangles'];
    expected.forEach((array, i) => {
      if (!sameBits(array, values[i])) throw new Error(`${name}: ${names[i]} differ from what C++ reads`);
    });
    const setting = name.split('.')[0];
    if (!perSetting.has(setting)) perSetting.set(setting, {ms: [], bytes: 0});
    perSetting.get(setting).ms.push(took);
    perSetting.get(setting).bytes += sample.stream.length;
  }
  if (perSetting.size === 0) throw new Error('no samples');
  return [...perSetting].map(([setting, {ms, bytes}]) =>
    `${setting}: ${ms.length} tiles exact, ${Math.round(bytes / ms.length)} bytes, ${median(ms).toFixed(2)} ms each (median)`);
}

if (typeof require !== 'undefined' && require.main === module) {
  const fs = require('fs'), path = require('path');
  const folder = process.argv[2];
  require('draco3d').createDecoderModule({}).then((draco) => {
    const samples = fs.readdirSync(folder).filter((name) => name.endsWith('.bin')).sort().map((name) => {
      const file = fs.readFileSync(path.join(folder, name));
      return [name, file.buffer.slice(file.byteOffset, file.byteOffset + file.length)];
    });
    console.log(compareAll(draco, samples).join('\n'));
  }).catch((failure) => {
    console.error(`draco3d: ${failure.message}`);
    process.exit(1);
  });
}
