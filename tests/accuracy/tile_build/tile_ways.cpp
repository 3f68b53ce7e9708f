#include "tests/accuracy/tile_build/tile_ways.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "tests/accuracy/tile_build/tile_truth.h"

namespace terrane::accuracy {
namespace {

Columns<double> widened(const Columns<float>& from) {
  Columns<double> out(from.x.size());
  std::ranges::copy(from.x, out.x.begin());
  std::ranges::copy(from.y, out.y.begin());
  std::ranges::copy(from.z, out.z.begin());
  return out;
}
Columns<float> narrowed(const Columns<double>& from) {
  Columns<float> out(from.x.size());
  for (std::size_t i = 0; i < from.x.size(); ++i) {
    out.x[i] = static_cast<float>(from.x[i]);
    out.y[i] = static_cast<float>(from.y[i]);
    out.z[i] = static_cast<float>(from.z[i]);
  }
  return out;
}

template <class Real>
Results<Real> resultsOf(const Place& place, const TileLoopsOf<Real>& loops, OctaveLoop<Real> octaves,
                        const OctaveSum& sum) {
  Results<Real> r{Columns<Real>(kVertices), Columns<Real>(0), {{}, Columns<float>(0)}, {}, {}};
  directionsOf(place, loops, r.directions);
  r.blocks = blockPositions(r.directions, place.radiusMeters);
  r.ground = groundOf<Real>(sum, octaves, r.blocks);
  r.lattice = latticeOf(place, place.stepExponent, loops, r.directions, r.ground.heightMeters);
  r.fineLattice = latticeOf(place, kFinestExponent, loops, r.directions, r.ground.heightMeters);
  return r;
}

template <class Real>
std::vector<float> gradientNormals(const Tile& tile, const TileLoopsOf<Real>& loops, const Columns<Real>& directions) {
  std::vector<float> normals(3 * kVertices);
  const Ground& ground = tile.inDouble.ground;
  loops.gradientNormals(directions.in(), inType<Real>(ground.heightMeters).data(), ground.gradient.in(),
                        static_cast<Real>(tile.place.radiusMeters), kVertices, normals.data());
  return normals;
}

template <class Real>
Columns<Real> positionsOf(const Tile& tile, const TileLoopsOf<Real>& loops, const Columns<Real>& directions) {
  Columns<Real> positions(kVertices);
  loops.positions(directions.in(), inType<Real>(tile.inDouble.ground.heightMeters).data(),
                  static_cast<Real>(tile.place.radiusMeters), kVertices, positions.out());
  return positions;
}

template <class Real>
std::vector<float> neighbourNormals(const TileLoopsOf<Real>& loops, const Columns<Real>& positions) {
  std::vector<float> normals(3 * kVertices);
  loops.neighbourNormals(positions.in(), kSide, normals.data());
  return normals;
}

/// A loop's inputs and results in one type, for timing it alone.
template <class Real>
struct Bench {
  Bench(const Tile& tile, const TileLoopsOf<Real>& with, const Results<Real>& results)
      : place(tile.place),
        loops(with),
        given(results),
        positions(positionsOf(tile, with, results.directions)),
        heights(inType<Real>(tile.inDouble.ground.heightMeters)),
        gradient(tile.inDouble.ground.gradient.in()) {}

  double directionsOnce() {
    directionsOf(place, loops, made);
    return static_cast<double>(made.x.back());
  }
  double latticeOnce() {
    loops.lattice(given.directions.in(), heights.data(), static_cast<Real>(place.radiusMeters),
                  static_cast<Real>(stepMeters(-place.stepExponent)), kVertices, lattice.data());
    return static_cast<double>(lattice.back());
  }
  double gradientNormalsOnce() {
    loops.gradientNormals(given.directions.in(), heights.data(), gradient, static_cast<Real>(place.radiusMeters),
                          kVertices, normals.data());
    return static_cast<double>(normals.back());
  }
  double neighbourNormalsOnce() {
    loops.neighbourNormals(positions.in(), kSide, normals.data());
    return static_cast<double>(normals[normals.size() / 2]);
  }

  const Place& place;
  const TileLoopsOf<Real>& loops;
  const Results<Real>& given;
  Columns<Real> positions;
  std::vector<Real> heights;
  Triples<const float> gradient;
  Columns<Real> made{kVertices};
  std::vector<std::int64_t> lattice = std::vector<std::int64_t>(3 * kVertices);
  std::vector<float> normals = std::vector<float>(3 * kVertices);
};

constexpr std::array<Loop, 4> kWorkLoops{kDirections, kLattice, kGradientNormals, kNeighbourNormals};
static_assert(2 * kWorkLoops.size() == kLoopWorks);

template <class Real>
void addWorks(std::shared_ptr<Bench<Real>> b, std::vector<Work>& works) {
  works.push_back(repeated(kVertices, [b] { return b->directionsOnce(); }));
  works.push_back(repeated(kVertices, [b] { return b->latticeOnce(); }));
  works.push_back(repeated(kVertices, [b] { return b->gradientNormalsOnce(); }));
  works.push_back(repeated(kVertices, [b] { return b->neighbourNormalsOnce(); }));
}

template <class Real>
Work noiseWork(const OctaveSum& sum, OctaveLoop<Real> loop, const Columns<Real>& blocks, std::size_t line) {
  const auto out = std::make_shared<Ground>(Ground{std::vector<double>(kLineSlots), Columns<float>(kLineSlots)});
  const std::size_t first = line * kLineSlots;
  const Triples<const Real> at{blocks.x.data() + first, blocks.y.data() + first, blocks.z.data() + first};
  return repeated(kLineVertices, [=] {
    loop(sum, at, kBlocksPerLine, out->heightMeters.data(), out->gradient.out());
    return out->heightMeters.back();
  });
}

}  // namespace

const TileLoops& loopsOf(SimdPath path) {
  switch (path) {
    case SimdPath::V3:
      return tileLoopsV3();
    case SimdPath::V4:
      return tileLoopsV4();
    case SimdPath::Default:
      break;
  }
  return tileLoopsDefault();
}

Tile::Tile(Place where, const TileLoops& loops)
    : place(std::move(where)),
      sum(octaveSum(place)),
      sumInFloat{sum.octaves, sum.count, 0},
      inFloat(resultsOf(place, loops.inFloat, loops.octavesInFloat, sumInFloat)),
      inCells(resultsOf(place, loops.inDouble, loops.octavesInCells, sum)),
      inDouble(resultsOf(place, loops.inDouble, loops.octavesInDouble, sum)) {}

ErrorsMeters errorsOf(const Tile& tile, const TileLoops& loops, std::size_t stride) {
  const Truth truth(tile.place, stride);
  const std::vector<double>& heights = tile.inDouble.ground.heightMeters;
  const Columns<double>& directions = tile.inDouble.directions;
  const Columns<float> given = narrowed(directions);
  ErrorsMeters e;
  e.inFloat[kDirections] = truth.directionErrorMeters(widened(tile.inFloat.directions));
  e.inDouble[kDirections] = truth.directionErrorMeters(directions);
  e.inFloat[kNoise] = truth.heightErrorMeters(tile.inFloat.ground.heightMeters);
  e.inFloat[kNoiseInCells] = truth.heightErrorMeters(tile.inCells.ground.heightMeters);
  e.inDouble[kNoise] = e.inDouble[kNoiseInCells] = truth.heightErrorMeters(heights);
  e.inFloat[kLattice] =
      truth.latticeErrorMeters(latticeOf(tile.place, kFinestExponent, loops.inFloat, given, heights), &heights);
  e.inDouble[kLattice] = truth.latticeErrorMeters(tile.inDouble.fineLattice, &heights);
  const auto normalError = [&](const std::vector<float>& normals) {
    return truth.gradientNormalErrorMeters(normals, tile.inDouble.ground);
  };
  e.inFloat[kGradientNormals] = normalError(gradientNormals(tile, loops.inFloat, given));
  e.inDouble[kGradientNormals] = normalError(gradientNormals(tile, loops.inDouble, directions));
  const auto neighbourError = [&](const std::vector<float>& normals) {
    return truth.neighbourNormalErrorMeters(normals, heights);
  };
  e.inFloat[kNeighbourNormals] =
      neighbourError(neighbourNormals(loops.inFloat, positionsOf(tile, loops.inFloat, given)));
  e.inDouble[kNeighbourNormals] =
      neighbourError(neighbourNormals(loops.inDouble, positionsOf(tile, loops.inDouble, directions)));
  e.wholeFloat = truth.latticeErrorMeters(tile.inFloat.fineLattice, nullptr);
  e.wholeInCells = truth.latticeErrorMeters(tile.inCells.fineLattice, nullptr);
  e.wholeDouble = truth.latticeErrorMeters(tile.inDouble.fineLattice, nullptr);
  return e;
}

std::vector<Work> loopWorks(const Tile& tile, const TileLoops& loops) {
  std::vector<Work> works;
  addWorks(std::make_shared<Bench<float>>(tile, loops.inFloat, tile.inFloat), works);
  addWorks(std::make_shared<Bench<double>>(tile, loops.inDouble, tile.inDouble), works);
  return works;
}

std::vector<Work> noiseWorks(const Tile& tile, const TileLoops& loops, std::size_t blockLine) {
  return {noiseWork<float>(tile.sumInFloat, loops.octavesInFloat, tile.inFloat.blocks, blockLine),
          noiseWork<double>(tile.sum, loops.octavesInCells, tile.inCells.blocks, blockLine),
          noiseWork<double>(tile.sum, loops.octavesInDouble, tile.inDouble.blocks, blockLine)};
}

TimesNs timesFrom(const double* loopNs, const double* noiseNs) {
  TimesNs times;
  for (std::size_t k = 0; k < kWorkLoops.size(); ++k) {
    times.inFloat[kWorkLoops[k]] = loopNs[k];
    times.inDouble[kWorkLoops[k]] = loopNs[kWorkLoops.size() + k];
  }
  times.inFloat[kNoise] = noiseNs[0];
  times.inFloat[kNoiseInCells] = noiseNs[1];
  times.inDouble[kNoise] = times.inDouble[kNoiseInCells] = noiseNs[2];
  return times;
}

}  // namespace terrane::accuracy
