// Clip-space position with reversed depth and no far plane: depth is near / w, 1 at the near plane and 0 at infinity.

uniform mat3 clipRows;     // rows x, y and w of projection * rotation
uniform float nearMeters;

vec4 clipPosition(vec3 relative) {
  PRECISE vec3 xyw = clipRows * relative;
#ifdef CLIP_CONTROL
  return vec4(xyw.xy, nearMeters, xyw.z);
#else
  // Without clip control depth runs over -1..1 and would lose its precision around 0: this z only clips at the near plane, and the
  // fragment shader writes the depth.
  PRECISE float z = xyw.z - 2.0 * nearMeters;
  return vec4(xyw.xy, z, xyw.z);
#endif
}
