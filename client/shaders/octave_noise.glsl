// Gradient noise (Perlin 1985, with the quintic of 2002) on a lattice of integers that wraps at 2^32, with its derivative. The lattice's
// gradients come from a hash of integers, so they are the same wherever a coordinate was computed.
uint latticeHash(uint h) {
  h = (h ^ (h >> 15)) * 0x2C1B3C6Du;
  h = (h ^ (h >> 12)) * 0x297A2D39u;
  return h ^ (h >> 15);
}

vec3 latticeGradient(uint key) {
  uint h = latticeHash(key);
  return vec3(uvec3(h, h >> 10, h >> 20) & 1023u) * (2.0 / 1023.0) - 1.0;
}

// x: the noise, within 1.5; yzw: its gradient by the coordinate. at: 0..1 in the cell.
vec4 octaveNoise(ivec3 cell, vec3 at, uint seed) {
  const uvec3 prime = uvec3(0x9E3779B1u, 0x85EBCA77u, 0xC2B2AE3Du);
  uvec3 low = uvec3(cell) * prime, high = low + prime;
  low.x += seed;
  high.x += seed;
  vec3 g000 = latticeGradient(low.x + low.y + low.z), g100 = latticeGradient(high.x + low.y + low.z);
  vec3 g010 = latticeGradient(low.x + high.y + low.z), g110 = latticeGradient(high.x + high.y + low.z);
  vec3 g001 = latticeGradient(low.x + low.y + high.z), g101 = latticeGradient(high.x + low.y + high.z);
  vec3 g011 = latticeGradient(low.x + high.y + high.z), g111 = latticeGradient(high.x + high.y + high.z);
  vec3 back = at - 1.0;
  float v000 = dot(g000, at), v100 = dot(g100, vec3(back.x, at.yz));
  float v010 = dot(g010, vec3(at.x, back.y, at.z)), v110 = dot(g110, vec3(back.xy, at.z));
  float v001 = dot(g001, vec3(at.xy, back.z)), v101 = dot(g101, vec3(back.x, at.y, back.z));
  float v011 = dot(g011, vec3(at.x, back.yz)), v111 = dot(g111, back);
  vec3 s = at * at * at * (at * (at * 6.0 - 15.0) + 10.0), ds = 30.0 * at * at * back * back;
  // Along z, then y, then x; what the weights themselves change goes with ds.
  vec4 m00 = mix(vec4(v000, g000), vec4(v001, g001), s.z), m10 = mix(vec4(v100, g100), vec4(v101, g101), s.z);
  vec4 m01 = mix(vec4(v010, g010), vec4(v011, g011), s.z), m11 = mix(vec4(v110, g110), vec4(v111, g111), s.z);
  m00.w += (v001 - v000) * ds.z;
  m10.w += (v101 - v100) * ds.z;
  m01.w += (v011 - v010) * ds.z;
  m11.w += (v111 - v110) * ds.z;
  vec4 m0 = mix(m00, m01, s.y), m1 = mix(m10, m11, s.y);
  m0.z += (m01.x - m00.x) * ds.y;
  m1.z += (m11.x - m10.x) * ds.y;
  vec4 m = mix(m0, m1, s.x);
  m.y += (m1.x - m0.x) * ds.x;
  return m;
}
