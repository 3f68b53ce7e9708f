#include "server/fields/midpoint_keys.h"

#include <algorithm>
#include <utility>

#include "common/tiling/cube_sphere.h"
#include "common/tiling/icosahedron.h"

namespace terrane {
namespace {

constexpr std::int64_t kEdgeKeys = kIcosahedronFaces;  // after those of the faces' insides
constexpr std::int64_t kCornerKeys = kEdgeKeys + std::int64_t{kIcosahedronVertices} * kIcosahedronVertices;

/// Across the face's edge `edge`, beyond which the point lies.
void unfold(int& face, FaceWeights& weights, int edge) noexcept {
  // The apex beyond is the mirror image P_k+1 + P_k+2 - P_k of the corner P_k. Its edge runs the other way.
  const FaceEdge beyond = beyondFaceEdge(face, edge);
  const std::int64_t depth = -weights[edge];
  FaceWeights there;
  there[beyond.edge] = depth;
  there[(beyond.edge + 1) % kTriangleCorners] = weights[(edge + 2) % kTriangleCorners] - depth;
  there[(beyond.edge + 2) % kTriangleCorners] = weights[(edge + 1) % kTriangleCorners] - depth;
  face = beyond.face;
  weights = there;
}

/// A step beyond a corner takes two edges, any other one.
void unfoldFully(int& face, FaceWeights& weights) noexcept {
  for (int k = 0; k < kTriangleCorners;) {
    if (weights[k] >= 0) {
      ++k;
      continue;
    }
    unfold(face, weights, k);
    k = 0;
  }
}

/// Brings a face coordinate back to the face's border, and how far it was beyond onto the depth below the face.
void foldDown(std::int64_t& coordinate, std::int64_t& normal, std::int64_t half) noexcept {
  const std::int64_t within = std::clamp(coordinate, -half, half);
  normal -= coordinate > within ? coordinate - within : within - coordinate;
  coordinate = within;
}

}  // namespace

VertexKey icoVertexKey(int face, FaceWeights weights) noexcept {
  unfoldFully(face, weights);
  const auto& corners = icosahedronCorners(face);
  for (int k = 0; k < kTriangleCorners; ++k) {
    if (weights[k] != 0) continue;
    std::int64_t low = corners[static_cast<std::size_t>((k + 1) % kTriangleCorners)];
    std::int64_t high = corners[static_cast<std::size_t>((k + 2) % kTriangleCorners)];
    std::int64_t atLow = weights[(k + 1) % kTriangleCorners], atHigh = weights[(k + 2) % kTriangleCorners];
    if (atHigh == 0) return {kCornerKeys + low, 0, 0};
    if (atLow == 0) return {kCornerKeys + high, 0, 0};
    if (low > high) {
      std::swap(low, high);
      std::swap(atLow, atHigh);
    }
    return {kEdgeKeys + kIcosahedronVertices * low + high, atLow, 0};
  }
  return {face, weights.y, weights.z};
}

int icoCornerAt(int face, FaceWeights weights) noexcept {
  unfoldFully(face, weights);
  return icosahedronCorners(face)[static_cast<std::size_t>(weights.x != 0 ? 0 : weights.y != 0 ? 1 : 2)];
}

VertexKey cubeVertexKey(int face, int gridLevel, std::int64_t column, std::int64_t row) noexcept {
  const std::int64_t half = std::int64_t{1} << gridLevel;
  std::int64_t u = 2 * column - half, v = 2 * row - half, normal = half;
  foldDown(u, normal, half);
  foldDown(v, normal, half);
  const FaceAxes& axes = cubeFaceAxes(face);
  const auto along = [&](int axis) {
    return normal * static_cast<std::int64_t>(axes.normal[axis]) + u * static_cast<std::int64_t>(axes.u[axis]) +
           v * static_cast<std::int64_t>(axes.v[axis]);
  };
  return {along(0), along(1), along(2)};
}

}  // namespace terrane
