// A vertex between its tile's own surface and its parent's (common/view/drawn_tile.h, client/render/morph_grid.h); the parent's vertices are
// read from its own buffer. One code for squares and triangles (common/tiling/tile_grid.h).
uniform usamplerBuffer parentVertices;  // 5 words a vertex, as GpuVertex has them
uniform ivec3 morphGrid;                // vertices in the first row; how many fewer each next row has, 0 or 1; 1, or -1 if turned round
uniform ivec2 firstInHalfCells;         // where vertex (0, 0) lies, in half cells of the parent's grid
uniform ivec3 parentMinusOwn;           // twice the parent's origin minus the tile's, in the tile's steps
uniform float morphByBorders[13];

struct MorphedVertex {
  float morph;        // 0 own .. 1 the parent's
  int first, second;  // words of the two vertices of the parent in whose middle it then lies; equal where it lies on one
};

int parentWords(ivec2 at) { return 5 * (at.y * morphGrid.x - morphGrid.y * ((at.y * (at.y - 1)) >> 1) + at.x); }

// place: GpuVertex has it.
MorphedVertex morphedVertex(uint place) {
  int fewer = morphGrid.y, last = morphGrid.x - 1;
  ivec2 at = min(ivec2(place & 255u, place >> 8), ivec2(last));
  ivec2 odd = at & 1;
  // Where both are odd the parent's edge is the one that cuts a square, or runs along i + j of a triangle.
  ivec2 along = ivec2(odd.x, odd.y - 2 * (odd.x & odd.y & fewer));
  ivec2 twice = firstInHalfCells + morphGrid.z * at;
  int borders = int(at.x == 0) + 2 * int(at.y == 0) + 4 * int(at.x == last - fewer * at.y) + 8 * (1 - fewer) * int(at.y == last);
  float morph = place == 65535u ? 0.0 : morphByBorders[borders];  // a skirt keeps its foot
  return MorphedVertex(morph, parentWords((twice - along) >> 1), parentWords((twice + along) >> 1));
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
