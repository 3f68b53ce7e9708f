#include "client/dust/grain_field.h"

#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>

#include "client/dust/grain_cells.h"
#include "common/numerics/strict_math.h"
#include "common/tiling/lattice.h"

namespace terrane {
namespace {

/// Diameters of a class, as shares of its cell: one octave, so that classes follow one another without gap or overlap.
constexpr double kLeastShare = 0.2, kMiddleShare = 0.283, kMostShare = 0.4;
/// What a grain covers on average when numbers fall with the cube of size, pi/4 E[d^2], in squares of a cell's width.
constexpr double kMeanCover = 0.0581;
static_assert(kMostCover < kMeanCover && SquareGrainCell::kAreaInWidths <= 1 && TriangleGrainCell::kAreaInWidths <= 1);
/// Classes of any body: a cell of the coarsest is a 64th of a face, the finest is bounded by what 2^52 can count.
constexpr int kLastClass = 40;
/// Broken rock has the more cover the smaller it is: of an octave's, the octave above has so much.
constexpr double kCoverFalls = 0.75;
/// Density goes by patches this many cells of the class wide, and of a quarter of that.
constexpr double kPatchCells = 40;

std::uint64_t mixed(std::uint64_t h) noexcept {
  h ^= h >> 30;
  h *= 0xBF58476D1CE4E5B9ull;
  h ^= h >> 27;
  h *= 0x94D049BB133111EBull;
  return h ^ (h >> 31);
}

/// Numbers in [0, 1), one after the other, from one cell (the sequence of splitmix64).
class CellRandom {
 public:
  CellRandom(std::uint64_t stream, std::uint64_t column, std::uint64_t row) noexcept
      : state_(mixed(mixed(column + 0x9E3779B97F4A7C15ull * stream) ^ (row + 0xD1B54A32D192ED03ull))) {}
  /// 24 bits: exact in float too.
  double next() noexcept {
    state_ += 0x9E3779B97F4A7C15ull;
    return static_cast<double>(mixed(state_) >> 40) * 0x1p-24;
  }

 private:
  std::uint64_t state_;
};

double cornerValue(const glm::dvec3& corner) noexcept {
  const auto bits = [](double x) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(x)); };
  const std::uint64_t h = mixed(mixed(mixed(bits(corner.x) + 0x9E3779B97F4A7C15ull) ^ bits(corner.y)) ^ bits(corner.z));
  return static_cast<double>(h >> 40) * 0x1p-24;
}

/// Value noise, 0..1, in space: so it knows of no faces.
double patchValue(const glm::dvec3& at) noexcept {
  const glm::dvec3 base(std::floor(at.x), std::floor(at.y), std::floor(at.z));
  const auto eased = [](double x) { return x * x * (3 - 2 * x); };
  const double u = eased(at.x - base.x), v = eased(at.y - base.y), w = eased(at.z - base.z);
  double sum = 0;
  for (const int z : {0, 1})
    for (const int y : {0, 1})
      for (const int x : {0, 1})
        sum += (x != 0 ? u : 1 - u) * (y != 0 ? v : 1 - v) * (z != 0 ? w : 1 - w) *
               cornerValue(base + glm::dvec3(x, y, z));
  return sum;
}

/// Of a patch, as a multiple of the mean: some ground is all but bare.
constexpr double kDensest = 2.1, kBarest = 0.1;
double density(double patch) noexcept {
  return kBarest + (kDensest - kBarest) * std::clamp((patch - 0.33) / 0.38, 0.0, 1.0);
}

/// Uniform over all rotations: two points in discs (Shoemake 1992 has them on circles, by sines; Marsaglia 1972
/// without).
void setTurn(CellRandom& random, Grain& grain) noexcept {
  const auto inDisc = [&](double& x, double& y) {
    double square = 2;
    for (int attempt = 0; attempt < 16 && !(square < 1 && square > 0); ++attempt) {
      x = 2 * random.next() - 1;
      y = 2 * random.next() - 1;
      square = x * x + y * y;
    }
    if (!(square < 1 && square > 0)) x = square = 0.25, y = 0;
    return square;
  };
  double x = 0, y = 0, z = 0, w = 0;
  const double first = inDisc(x, y), second = inDisc(z, w);
  const double scale = std::sqrt((1 - first) / second);
  grain.turn[0] = static_cast<float>(x);
  grain.turn[1] = static_cast<float>(y);
  grain.turn[2] = static_cast<float>(z * scale);
  grain.turn[3] = static_cast<float>(w * scale);
}

}  // namespace

GrainField::GrainField(const DustSettings& settings, double radiusMeters, Scheme scheme) noexcept
    : settings_(settings), radiusMeters_(radiusMeters), scheme_(scheme) {
  settings_.cover = std::clamp(settings.cover, 0.0, kMostCover);
  if (!(settings_.cover > 0)) return;
  const auto middle = [this](int classLevel) { return kMiddleShare * cellMeters(classLevel); };
  while (coarsest_ < kLastClass && middle(coarsest_) > settings_.largestMeters) ++coarsest_;
  finest_ = coarsest_ - 1;
  while (finest_ + 1 < kLastClass && middle(finest_ + 1) >= settings_.smallestMeters) ++finest_;
}

double GrainField::cellMeters(int classLevel) const noexcept {
  return nominalTileWidthMeters(radiusMeters_, classLevel, scheme_) / kGrainCells;
}

double GrainField::largestMeters(int classLevel) const noexcept {
  return std::min(kMostShare * cellMeters(classLevel), settings_.largestMeters);
}

template <class Cell>
void GrainField::collectFrom(const FacePath& tile, int classLevel, std::vector<Grain>& grains) const {
  const double cell = cellMeters(classLevel), patchMeters = kPatchCells * cell;
  double cover = settings_.cover;
  for (int finer = classLevel; finer < finest_; ++finer) cover *= kCoverFalls;
  Cell::eachOf(tile, classLevel, [&](const Cell& at) {
    CellRandom random(at.stream(), at.column, at.row);
    const double chance = random.next() * kMeanCover / Cell::kAreaInWidths;
    if (chance >= kDensest * cover) return;
    const double u = random.next();
    const double share = kLeastShare / std::sqrt(1 - u * (1 - (kLeastShare / kMostShare) * (kLeastShare / kMostShare)));
    const double diameter = share * cell;
    if (diameter < settings_.smallestMeters || diameter > settings_.largestMeters) return;
    // It stays within its cell, so that neighbours of a class do not overlap.
    const double first = random.next(), second = random.next();
    const auto place = at.place(tile, share, first, second);
    if (!place) return;
    const glm::dvec3 patchAt = place->direction * (radiusMeters_ / patchMeters);
    const double patch = 0.6 * patchValue(patchAt) + 0.4 * patchValue(4.0 * patchAt);
    if (chance >= cover * density(patch)) return;
    Grain grain;
    grain.cells = place->cells;
    grain.classLevel = classLevel;
    grain.column = at.column;
    grain.row = at.row;
    grain.diameterMeters = static_cast<float>(diameter);
    grain.flattening = static_cast<float>(0.55 + 0.35 * random.next());
    grain.centerHeight = static_cast<float>(-0.35 + 0.75 * random.next());
    grain.shade = static_cast<float>(0.75 + 0.5 * random.next());
    grain.variant = static_cast<int>(kGrainVariants * random.next());
    setTurn(random, grain);
    grains.push_back(grain);
  });
}

void GrainField::collect(const FacePath& tile, int classLevel, std::vector<Grain>& grains) const {
  if (classLevel < coarsest_ || classLevel > finest_) return;
  if (scheme_ == Scheme::Cube) {
    collectFrom<SquareGrainCell>(tile, classLevel, grains);
  } else {
    collectFrom<TriangleGrainCell>(tile, classLevel, grains);
  }
}

}  // namespace terrane
