// Another picture's pixel at the same place, alpha and all.
uniform sampler2D picture;
layout(location = 0) out vec4 pixel;

void main() { pixel = texelFetch(picture, ivec2(gl_FragCoord.xy), 0); }
