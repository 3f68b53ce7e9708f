// A vertex between its tile's own surface and its parent's (common/view/drawn_tile.h, client/render/morph_grid.h). Vertices lie in grid order,
// so that gl_VertexID tells the place in the grid; the parent's are read from its own vertex buffer.
uniform usamplerBuffer parentVertices;  // 5 words a vertex, as GpuVertex has them
uniform ivec3 morphGrid;                // vertices in a row; column and row of the parent's grid where the tile's vertex (0, 0) lies
uniform ivec3 parentMinusOwn;           // twice the parent's origin minus the tile's, in the tile's steps
uniform float morphByPlace[9];          // rows first, between, last of columns first, between, last

struct MorphedVertex {
  float morph;        // 0 own .. 1 the parent's
  int first, second;  // words of the two vertices of the parent in whose middle it then lies; equal where it lies on one
};

MorphedVertex morphedVertex() {
  int side = morphGrid.x;
  int row = gl_VertexID / side;
  ivec2 at = ivec2(gl_VertexID - row * side, min(row, side - 1));
  ivec2 first = (at >> 1) + morphGrid.yz;
  ivec2 second = first + (at & 1);
  ivec2 place = ivec2(greaterThan(at, ivec2(0))) + ivec2(equal(at, ivec2(side - 1)));
  float morph = row < side ? morphByPlace[3 * place.y + place.x] : 0.0;  // a skirt keeps its foot
  return MorphedVertex(morph, 5 * (first.y * side + first.x), 5 * (second.y * side + second.x));
}

uint parentWord(int at) { return texelFetch(parentVertices, at).r; }

ivec3 parentOffset(int vertex) {
  uint xy = parentWord(vertex);
  return ivec3(int(xy & 65535u), int(xy >> 16), int(parentWord(vertex + 1) & 65535u));
}

// Normals and colours as whole numbers, as the parent's own draw has them.
vec3 parentNormal(int vertex) {
  int xy = int(parentWord(vertex + 2)), z = int(parentWord(vertex + 3));
  return vec3((xy << 16) >> 16, xy >> 16, (z << 16) >> 16);
}

vec3 parentColor(int vertex) {
  uint rgb = parentWord(vertex + 4);
  return vec3(rgb & 255u, (rgb >> 8) & 255u, (rgb >> 16) & 255u);
}

// From the middle between the two vertices of the parent to the first, in steps of the tile. Exact.
ivec3 stepsToFirst(MorphedVertex vertex) { return parentOffset(vertex.first) - parentOffset(vertex.second); }

// In steps of the tile, from an offset in it to the point of the parent's mesh. Exact.
ivec3 stepsToParent(MorphedVertex vertex, ivec3 offsetSteps) {
  return parentMinusOwn + parentOffset(vertex.first) + parentOffset(vertex.second) - offsetSteps;
}
