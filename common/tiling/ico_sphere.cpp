#include "common/tiling/ico_sphere.h"

#include <bit>
#include <cmath>

#include "common/numerics/strict_math.h"

// Bounds, with u = 2^-53; lengths of error vectors, which bound their components.
//
// Gnomonic. A vertex's components are rounded by 0.51 ulp <= 0.51 u, so its error is <= 0.73 u (one component is 0).
// Products round by u of themselves and the two sums by u of partial sums, all <= 0.851 w (w the sum of weights): 3 u
// 0.851 w for a component at most. The sum's length is >= kIcosahedronInradius w, so its direction errs by
// (0.73 + sqrt(3) 2.56) u / 0.795 <= 6.5 u. The norm is within 2.5 u and the division rounds by u: 3.5 u of the
// component. Together 10 u, and terms of u^2.
//
// Bisected. Let P and Q, an angle a apart, err sideways by e and in length by <= 3.5 u. Their sum rounds by u of each
// component, and so does the division by its norm, which is a factor within 2.5 u of the right one. So the middle errs
// in length by 3.5 u again, and sideways by e / cos(a / 2) + 2 u + 3.5 u tan(a / 2), the last from unequal lengths. An
// edge of level l has a <= 1.2 atan 2 / 2^l (ico_shapes_test; the first two are 63.5 and 36 degrees at most). The
// factors 1 / cos multiply to less than 1.26 over all levels, 1.072 after the first, 1.019 after the second, 1.005
// after the third. Summed, beginning with 0.73 u at the face's corners: 0.92 u + 4.46 u + 3.20 u + 2.61 u + 2.30 u +
// ... <= (2 gridLevel + 5.8) u. With 3.5 u of length it is below (2 gridLevel + 10) u.

namespace terrane {
namespace {

using CornerDirections = std::array<glm::dvec3, kTriangleCorners>;
constexpr int kCentreChild = 3;

CornerDirections faceCorners(int face) noexcept {
  const auto& vertices = icosahedronCorners(face);
  return {icosahedronVertex(vertices[0]), icosahedronVertex(vertices[1]), icosahedronVertex(vertices[2])};
}

/// Always x, then y, then z: the faces that share this point must round alike.
double norm(double x, double y, double z) noexcept { return std::sqrt((x * x + y * y) + z * z); }

glm::dvec3 normalised(const glm::dvec3& p) noexcept {
  const double length = norm(p.x, p.y, p.z);
  return glm::dvec3(p.x / length, p.y / length, p.z / length);
}

glm::dvec3 middle(const glm::dvec3& a, const glm::dvec3& b) noexcept { return normalised(a + b); }

CornerDirections childCorners(const CornerDirections& parent, int digit) noexcept {
  if (digit == kCentreChild)
    return {middle(parent[1], parent[2]), middle(parent[2], parent[0]), middle(parent[0], parent[1])};
  CornerDirections child = parent;
  const glm::dvec3& kept = parent[static_cast<std::size_t>(digit)];
  for (std::size_t k = 0; k < child.size(); ++k) {
    if (k != static_cast<std::size_t>(digit)) child[k] = middle(kept, parent[k]);
  }
  return child;
}

/// The child whose part of a tile holds the point with these weights at the tile's corners; their sum is `whole`. On a
/// border, the centre child.
int childHolding(const FaceWeights& weights, std::int64_t whole) noexcept {
  for (int k = 0; k < kTriangleCorners; ++k) {
    if (2 * weights[k] > whole) return k;
  }
  return kCentreChild;
}

/// The same point by its weights at the child's corners, with the same sum.
FaceWeights weightsInChild(const FaceWeights& weights, std::int64_t whole, int digit) noexcept {
  const FaceWeights twice = weights * std::int64_t{2};
  if (digit == kCentreChild) return FaceWeights(whole) - twice;
  FaceWeights out = twice;
  out[digit] -= whole;
  return out;
}

glm::dvec3 bisectedDirection(int face, int gridLevel, FaceWeights weights) noexcept {
  const std::int64_t whole = std::int64_t{1} << gridLevel;
  CornerDirections corners = faceCorners(face);
  for (;;) {
    for (int k = 0; k < kTriangleCorners; ++k) {
      if (weights[k] == whole) return corners[static_cast<std::size_t>(k)];
    }
    const int digit = childHolding(weights, whole);
    weights = weightsInChild(weights, whole, digit);
    corners = childCorners(corners, digit);
  }
}

/// In the corners' order: see the header for why it does not matter on an edge.
double weightedSum(double w0, double c0, double w1, double c1, double w2, double c2) noexcept {
  return (w0 * c0 + w1 * c1) + w2 * c2;
}

void gnomonicDirections(const FacePath& path, int cells, const DirectionSpans& out) noexcept {
  const TriangleTile tile = triangleTile(path);
  const auto [a, b, c] = faceCorners(path.face());
  const double sign = tile.sign;
  for (int j = 0; j <= cells; ++j) {
    const FaceWeights first = gridVertexWeights(tile, cells, {0, j});
    // Weights are integers below 2^53: exact.
    const double first0 = static_cast<double>(first.x), first1 = static_cast<double>(first.y);
    const double w2 = static_cast<double>(first.z);
    const auto row = static_cast<std::size_t>(triangleGridIndex(cells, {0, j}));
    double *x = out.x.data() + row, *y = out.y.data() + row, *z = out.z.data() + row;
    for (int i = 0; i + j <= cells; ++i) {
      const double w0 = first0 - sign * i, w1 = first1 + sign * i;
      const double px = weightedSum(w0, a.x, w1, b.x, w2, c.x);
      const double py = weightedSum(w0, a.y, w1, b.y, w2, c.y);
      const double pz = weightedSum(w0, a.z, w1, b.z, w2, c.z);
      const double length = norm(px, py, pz);
      x[i] = px / length;
      y[i] = py / length;
      z[i] = pz / length;
    }
  }
}

void bisectedDirections(const FacePath& path, int cells, const DirectionSpans& out) noexcept {
  const auto set = [&](const GridVertex& vertex, const glm::dvec3& direction) {
    const auto at = static_cast<std::size_t>(triangleGridIndex(cells, vertex));
    out.x[at] = direction.x;
    out.y[at] = direction.y;
    out.z[at] = direction.z;
  };
  const auto get = [&](int i, int j) {
    const auto at = static_cast<std::size_t>(triangleGridIndex(cells, {i, j}));
    return glm::dvec3(out.x[at], out.y[at], out.z[at]);
  };
  const CornerDirections corners = icoCornerDirections(IcoMap::Bisected, path);
  set({0, 0}, corners[0]);
  set({cells, 0}, corners[1]);
  set({0, cells}, corners[2]);
  for (int half = cells / 2; half > 0; half /= 2) {
    for (int j = 0; j <= cells; j += half) {
      const bool oddRow = (j & half) != 0;  // else every other vertex is there already
      for (int i = oddRow ? 0 : half; i + j <= cells; i += oddRow ? half : 2 * half) {
        const int stepI = i & half, stepJ = oddRow ? (stepI != 0 ? -half : half) : 0;
        set({i, j}, middle(get(i - stepI, j - stepJ), get(i + stepI, j + stepJ)));
      }
    }
  }
}

glm::dvec3 cross(const glm::dvec3& a, const glm::dvec3& b) noexcept {
  return glm::dvec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
double dot(const glm::dvec3& a, const glm::dvec3& b) noexcept { return (a.x * b.x + a.y * b.y) + a.z * b.z; }

/// Positive to the left of the great circle from a to b. As differences from a: they are exact where the three are
/// close, so that the sign is right up to some ulps of their distance, not of 1.
double leftOf(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& direction) noexcept {
  return dot(cross(b - a, direction - a), a);
}

FacePath bisectedTileAt(int face, const glm::dvec3& direction, int level) noexcept {
  FacePath path = FacePath::wholeFace(Scheme::Ico, face);
  CornerDirections corners = faceCorners(face);
  while (path.level() < level) {
    const CornerDirections middles = childCorners(corners, kCentreChild);  // [k] opposite corner k
    int digit = kCentreChild;
    for (std::size_t k = 0; k < corners.size() && digit == kCentreChild; ++k) {
      if (leftOf(middles[(k + 2) % 3], middles[(k + 1) % 3], direction) > 0) digit = static_cast<int>(k);
    }
    path = path.child(digit);
    if (digit == kCentreChild) {
      corners = middles;
      continue;
    }
    const auto kept = static_cast<std::size_t>(digit);
    const std::size_t next = (kept + 1) % 3, last = (kept + 2) % 3;
    corners[next] = middles[last];
    corners[last] = middles[next];
  }
  return path;
}

FacePath gnomonicTileAt(int face, const glm::dvec3& direction, int level) noexcept {
  // Where the direction meets the face, as weights in units of 2^-52: from there on all is exact.
  constexpr std::int64_t kWhole = std::int64_t{1} << 52;
  const CornerDirections corners = faceCorners(face);
  std::array<double, kTriangleCorners> share{};
  for (std::size_t k = 0; k < share.size(); ++k)
    share[k] = std::fmax(0.0, dot(direction, cross(corners[(k + 1) % 3], corners[(k + 2) % 3])));
  const double sum = (share[0] + share[1]) + share[2];
  FaceWeights weights(0);
  int largest = 0;
  for (int k = 0; k < kTriangleCorners; ++k) {
    const double part = share[static_cast<std::size_t>(k)] / sum;
    weights[k] = static_cast<std::int64_t>(part * static_cast<double>(kWhole) + 0.5);
    if (weights[k] > weights[largest]) largest = k;
  }
  weights[largest] += kWhole - (weights.x + weights.y + weights.z);

  FacePath path = FacePath::wholeFace(Scheme::Ico, face);
  while (path.level() < level) {
    const int digit = childHolding(weights, kWhole);
    weights = weightsInChild(weights, kWhole, digit);
    path = path.child(digit);
  }
  return path;
}

}  // namespace

glm::dvec3 icoGridDirection(IcoMap map, int face, int gridLevel, const FaceWeights& weights) noexcept {
  if (map == IcoMap::Bisected) return bisectedDirection(face, gridLevel, weights);
  const auto [a, b, c] = faceCorners(face);
  const double w0 = static_cast<double>(weights.x), w1 = static_cast<double>(weights.y);
  const double w2 = static_cast<double>(weights.z);
  return normalised(glm::dvec3(weightedSum(w0, a.x, w1, b.x, w2, c.x), weightedSum(w0, a.y, w1, b.y, w2, c.y),
                               weightedSum(w0, a.z, w1, b.z, w2, c.z)));
}

std::array<glm::dvec3, kTriangleCorners> icoCornerDirections(IcoMap map, const FacePath& path) noexcept {
  if (map == IcoMap::Gnomonic) {
    const auto weights = tileCorners(triangleTile(path));
    const auto at = [&](std::size_t k) { return icoGridDirection(map, path.face(), path.level(), weights[k]); };
    return {at(0), at(1), at(2)};
  }
  CornerDirections corners = faceCorners(path.face());
  for (int i = 0; i < path.level(); ++i) corners = childCorners(corners, path.digit(i));
  return corners;
}

void icoGridDirections(IcoMap map, const FacePath& path, int cells, const DirectionSpans& out) noexcept {
  if (map == IcoMap::Gnomonic) {
    gnomonicDirections(path, cells, out);
  } else {
    bisectedDirections(path, cells, out);
  }
}

void icoEdgeDirections(IcoMap map, const FacePath& path, int edge, int cells, const DirectionSpans& out) noexcept {
  const auto set = [&](int k, const glm::dvec3& direction) {
    const auto at = static_cast<std::size_t>(k);
    out.x[at] = direction.x;
    out.y[at] = direction.y;
    out.z[at] = direction.z;
  };
  if (map == IcoMap::Gnomonic) {
    const TriangleTile tile = triangleTile(path);
    const int gridLevel = path.level() + std::countr_zero(static_cast<unsigned>(cells));
    for (int k = 0; k <= cells; ++k)
      set(k, icoGridDirection(map, path.face(), gridLevel, gridVertexWeights(tile, cells, edgeVertex(cells, edge, k))));
    return;
  }
  const auto get = [&](int k) {
    const auto at = static_cast<std::size_t>(k);
    return glm::dvec3(out.x[at], out.y[at], out.z[at]);
  };
  const CornerDirections corners = icoCornerDirections(map, path);
  set(0, corners[static_cast<std::size_t>((edge + 1) % kTriangleCorners)]);
  set(cells, corners[static_cast<std::size_t>((edge + 2) % kTriangleCorners)]);
  for (int half = cells / 2; half > 0; half /= 2)
    for (int k = half; k < cells; k += 2 * half) set(k, middle(get(k - half), get(k + half)));
}

FacePath icoTileAt(IcoMap map, const glm::dvec3& direction, int level) noexcept {
  const double largest = std::fmax(std::fabs(direction.x), std::fmax(std::fabs(direction.y), std::fabs(direction.z)));
  const glm::dvec3 unit = normalised(glm::dvec3(direction.x / largest, direction.y / largest, direction.z / largest));
  const int face = icosahedronFaceAt(unit);
  return map == IcoMap::Gnomonic ? gnomonicTileAt(face, unit, level) : bisectedTileAt(face, unit, level);
}

}  // namespace terrane
