#include "tests/accuracy/placement/schemes.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "common/numerics/relative_position.h"

namespace terrane::accuracy {
namespace {

template <class Vertex, class Relative>
Placed placed(std::vector<Vertex> encoded, Relative relative) {
  const auto vertices = std::make_shared<const std::vector<Vertex>>(std::move(encoded));
  return {[=](std::size_t i) { return relative((*vertices)[i]); },
          [=](std::size_t count) {
            glm::vec3 sum(0.0f);
            for (std::size_t done = 0; done < count; done += vertices->size())
              for (const Vertex& vertex : *vertices) sum += relative(vertex);
            return static_cast<double>(sum.x + sum.y + sum.z);
          }};
}

/// A scheme that encodes vertices and camera alike.
template <class Encode, class Relative>
Placed placedAlike(const Sample& sample, Encode encode, Relative relative) {
  std::vector<decltype(encode(sample.camera))> vertices;
  for (const UnitPoint& vertex : sample.vertices) vertices.push_back(encode(FinePoint{vertex, glm::dvec3(0.0)}));
  return placed(std::move(vertices),
                [relative, camera = encode(sample.camera)](const auto& vertex) { return relative(vertex, camera); });
}

Placed inLattice(const Sample& sample) {
  OnLattice lattice = latticeOf(sample);
  return placed(std::move(lattice.offsets),
                [toOrigin = lattice.originMinusCamera, rest = lattice.cameraRest](const glm::u16vec4& offset) {
                  return relativeOnLattice(toOrigin, glm::ivec3(offset.x, offset.y, offset.z), rest,
                                           static_cast<float>(kLatticeMeters));
                });
}

Placed inLatticePairs(const Sample& sample) {
  OnLattice lattice = latticeOf(sample);
  const UnitPoint originUnits{lattice.origin[0] * kLatticeUnits, lattice.origin[1] * kLatticeUnits,
                              lattice.origin[2] * kLatticeUnits};
  return placed(std::move(lattice.offsets), [origin = pairsOf({originUnits, glm::dvec3(0.0)}),
                                             camera = pairsOf(sample.camera)](const glm::u16vec4& offset) {
    const glm::vec3 meters = glm::vec3(offset.x, offset.y, offset.z) * static_cast<float>(kLatticeMeters);
    return subtractAndDemote(add(origin, meters), camera);
  });
}

template <glm::vec3 (*relative)(glm::ivec3, glm::vec3, glm::ivec3, glm::vec3, float)>
Placed inTiles(const Sample& sample) {
  return placedAlike(sample, tiledOf, [](const TiledPosition& vertex, const TiledPosition& camera) {
    return relative(vertex.tile, vertex.offsetMeters, camera.tile, camera.offsetMeters, kTileMeters);
  });
}

Placed inPairs(const Sample& sample) {
  return placedAlike(sample, pairsOf, [](const DoubleFloat3& vertex, const DoubleFloat3& camera) {
    return add(vertex, DoubleFloat3(-camera.hi, -camera.lo)).hi;
  });
}

}  // namespace

TiledPosition tiledOf(const FinePoint& point) {
  TiledPosition tiled;
  constexpr int kTileBits = 31;  // 2048 m of units
  for (int axis = 0; axis < 3; ++axis) {
    const Units units = point.units[static_cast<std::size_t>(axis)];
    const Units tile = (units + (Units{1} << (kTileBits - 1))) >> kTileBits;
    const double rest = static_cast<double>(units - (tile << kTileBits)) + point.restUnits[axis];
    tiled.tile[axis] = static_cast<std::int32_t>(tile);
    tiled.offsetMeters[axis] = static_cast<float>(rest * kUnitMeters);
  }
  return tiled;
}

OnLattice latticeOf(const Sample& sample) {
  OnLattice lattice;
  UnitPoint lowest = sample.vertices.front();
  for (const UnitPoint& vertex : sample.vertices)
    for (std::size_t a = 0; a < 3; ++a) lowest[a] = std::min(lowest[a], vertex[a]);
  for (std::size_t a = 0; a < 3; ++a) {
    const auto axis = static_cast<int>(a);
    const Units whole = sample.camera.units[a] >> 10;
    lattice.origin[a] = lowest[a] / kLatticeUnits;
    lattice.originMinusCamera[axis] = static_cast<std::int32_t>(lattice.origin[a] - whole);
    const double rest = static_cast<double>(sample.camera.units[a] - whole * kLatticeUnits);
    lattice.cameraRest[axis] =
        static_cast<float>((rest + sample.camera.restUnits[axis]) / static_cast<double>(kLatticeUnits));
  }
  for (const UnitPoint& vertex : sample.vertices) {
    glm::u16vec4 offset(0);
    for (std::size_t a = 0; a < 3; ++a)
      offset[static_cast<int>(a)] = static_cast<std::uint16_t>((vertex[a] - lowest[a]) / kLatticeUnits);
    lattice.offsets.push_back(offset);
  }
  return lattice;
}

double worstMetersAt(const Scheme& scheme, double metersFromOrigin, std::uint64_t seed) {
  double worst = 0;
  for (int camera = 0; camera < kCameras; ++camera) {
    const Sample sample = makeSampleOf(metersFromOrigin, seed, camera, 64);
    const Placed placed = scheme.onCpu(sample);
    for (std::size_t i = 0; i < sample.vertices.size(); ++i)
      worst = std::max(worst, errorMeters(placed.at(i), sample.vertices[i], sample.camera));
  }
  return worst;
}

const std::vector<Scheme>& schemes() {
  static const std::vector<Scheme> all{
      {kFloat32, 12, 0,
       [](const Sample& s) {
         return placedAlike(s, floatsOf, [](const glm::vec3& v, const glm::vec3& c) { return v - c; });
       }},
      {kCameraRelative, 24, 12,
       [](const Sample& s) {
         return placedAlike(s, doublesOf,
                            [](const glm::dvec3& v, const glm::dvec3& c) { return cameraRelative(v, c); });
       }},
      {kTiles, 24, 0, inTiles<relativeByTilesAndOffsets>},
      {kTilesByHalves, 24, 0, inTiles<relativeByHalves>},
      {kSplit, 24, 0,
       [](const Sample& s) {
         return placedAlike(s, splitOf,
                            [](const DoubleFloat3& v, const DoubleFloat3& c) { return subtractWordsAndDemote(v, c); });
       }},
      {kWords, 24, 0,
       [](const Sample& s) {
         return placedAlike(s, pairsOf,
                            [](const DoubleFloat3& v, const DoubleFloat3& c) { return subtractWordsAndDemote(v, c); });
       }},
      {kDemoted, 24, 0,
       [](const Sample& s) {
         return placedAlike(s, pairsOf,
                            [](const DoubleFloat3& v, const DoubleFloat3& c) { return subtractAndDemote(v, c); });
       }},
      {kPairs, 24, 0, inPairs},
      {kLattice, 8, 0, inLattice},
      {kLatticePairs, 8, 0, inLatticePairs},
  };
  return all;
}

}  // namespace terrane::accuracy
