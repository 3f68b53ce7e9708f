#include "tests/accuracy/tile_build/tile_product.h"

#include <algorithm>

#include "server/build/level_accuracy.h"
#include "server/build/tile_builder.h"
#include "tests/support/moon_body.h"

namespace terrane::accuracy {

ProductNoise::ProductNoise(const Place& place, SimdPath path, const Columns<double>& blockPositions)
    : program_(octavesOnly(place.octaves, place.doubleWavelength, place.radiusMeters, groups_)),
      evaluate_(kernelOf(path)),
      blocks_(kBlocks) {
  for (std::size_t slot = 0; slot < kSlots; ++slot) {
    lunar::Block& block = blocks_[slot / kBlockSamples];
    const std::size_t at = slot % kBlockSamples;
    block.count = kBlockSamples;
    block.x[at] = blockPositions.x[slot];
    block.y[at] = blockPositions.y[slot];
    block.z[at] = blockPositions.z[slot];
  }
}

std::vector<double> ProductNoise::heightMeters() {
  std::vector<double> heights;
  for (lunar::Block& block : blocks_) {
    evaluate_(program_, block);
    heights.insert(heights.end(), block.height, block.height + kBlockSamples);
  }
  return heights;
}

double ProductNoise::lastHeightMeters(std::size_t blockLine) {
  double last = 0;
  for (std::size_t k = 0; k < kBlocksPerLine; ++k) {
    lunar::Block& block = blocks_[blockLine * kBlocksPerLine + k];
    evaluate_(program_, block);
    last = block.height[kBlockSamples - 1];
  }
  return last;
}

std::vector<std::int64_t> productLattice(const Place& place, const GridDirections& at,
                                         const std::vector<double>& heightMeters) {
  std::vector<std::int64_t> out;
  out.reserve(3 * kVertices);
  for (std::size_t v = 0; v < kVertices; ++v) {
    const double radius = place.radiusMeters + heightMeters[v];
    const LatticePoint p = roundToLattice({at.x[v] * radius, at.y[v] * radius, at.z[v] * radius}, place.stepExponent);
    out.insert(out.end(), {p.x, p.y, p.z});
  }
  return out;
}

std::size_t builtVerticesThatDiffer(const TileLoopsOf<double>& loops, int level) {
  const TileBuilder builder(testMoon(), {kCells, {}}, bestSimdPath());
  const Place place = placeAt(builder.body().radiusMeters, level, 0);
  const auto built = builder.buildMesh(place.path);
  if (!built) return kVertices;

  const auto field = makeHeightField(builder.body(), bestSimdPath());
  const LevelAccuracy accuracy = levelAccuracies(*field, place.radiusMeters, Scheme::Cube, kCells, level).back();
  Columns<double> directions(kVertices);
  directionsOf(place, loops, directions);
  SurfaceSamples samples;
  field->evaluate({directions.x.data(), directions.y.data(), directions.z.data(), kSide, kSide,
                   0.5 * accuracy.minWavelengthMeters, GridPlace{place.path, kCells}, accuracy.toleranceMeters},
                  accuracy.minWavelengthMeters, samples);
  const auto lattice = latticeOf(place, place.stepExponent, loops, directions, samples.heightMeters);
  std::vector<float> normals(3 * kVertices);
  loops.gradientNormals(directions.in(), samples.heightMeters.data(),
                        {samples.gradientX.data(), samples.gradientY.data(), samples.gradientZ.data()},
                        place.radiusMeters, kVertices, normals.data());
  std::size_t differ = 0;
  for (std::size_t v = 0; v < kVertices; ++v) {
    bool same = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t k = 3 * v + axis;
      const auto at = built->metadata.origin[static_cast<int>(axis)] + std::int64_t{built->mesh.offsets[k]};
      same = same && at == lattice[k] && built->mesh.normals[k] == normals[k];
    }
    differ += same ? 0 : 1;
  }
  return differ;
}

}  // namespace terrane::accuracy
