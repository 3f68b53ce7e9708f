// For fragment shaders: the same depth near / w where the fixed function cannot give it.
#ifndef CLIP_CONTROL
uniform float nearMeters;
#endif

void writeDepth() {
#ifndef CLIP_CONTROL
  gl_FragDepth = nearMeters * gl_FragCoord.w;
#endif
}
