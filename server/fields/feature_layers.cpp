#include "server/fields/feature_layers.h"

#include <algorithm>
#include <cmath>

#include "common/numerics/power_of_two.h"
#include "common/numerics/strict_math.h"
#include "common/tiling/cube_sphere.h"

namespace terrane::lunar {
namespace {

/// Between the entries of a table, at a position counted in entries.
double interpolate(std::span<const double> table, double position) noexcept {
  const double last = static_cast<double>(table.size() - 1);
  const double clamped = std::clamp(position, 0.0, last);
  const auto index = std::min(static_cast<std::size_t>(clamped), table.size() - 2);
  const double t = clamped - static_cast<double>(index);
  return table[index] + t * (table[index + 1] - table[index]);
}

/// Piecewise linear in D between powers of two: exponent + (D / 2^exponent - 1).
double octavePosition(double diameter) noexcept {
  int exponent = 0;
  const double mantissa = std::frexp(diameter, &exponent);  // diameter = mantissa * 2^exponent, mantissa in [1/2, 1)
  return static_cast<double>(exponent - 1) + (2.0 * mantissa - 1.0);
}

// Depth over diameter at 16, 32, ... 16384 m, and from there on depth and rim height in metres at 16384, 32768, ...
// 524288 m.
constexpr std::array<double, 11> kSimpleRatio{0.115, 0.12, 0.12, 0.14, 0.175, 0.198, 0.2, 0.2, 0.2, 0.19, 0.147};
constexpr std::array<double, 6> kComplexDepth{2410, 2960, 3650, 4490, 5540, 6800};
constexpr std::array<double, 6> kComplexRim{690, 945, 1245, 1640, 2170, 2800};

struct Cell {
  int face;
  std::uint32_t column, row;
};

std::uint64_t cellHash(const FeatureLayer& layer, const Cell& cell) noexcept {
  std::uint64_t h = layer.seed + static_cast<std::uint64_t>(cell.face) * 0xD6E8FEB86659FD93ull;
  h = mixHash(h ^ (static_cast<std::uint64_t>(cell.column) << 32 | cell.row));
  return h;
}

/// Patches of many and of few features, 0..2, mean 1: bilinear between hashed corners every 16 cells.
double patchiness(const FeatureLayer& layer, const Cell& cell) noexcept {
  const std::uint32_t i = cell.column >> 4, j = cell.row >> 4;
  const double u = static_cast<double>(cell.column & 15u) / 16.0, v = static_cast<double>(cell.row & 15u) / 16.0;
  const auto corner = [&](std::uint32_t di, std::uint32_t dj) {
    const double r = hashUnit(mixHash(cellHash(layer, {cell.face, i + di, j + dj}) ^ 0xA0761D6478BD642Full));
    return 3.0 * r * r;
  };
  const double low = corner(0, 0) + u * (corner(1, 0) - corner(0, 0));
  const double high = corner(0, 1) + u * (corner(1, 1) - corner(0, 1));
  return low + v * (high - low);
}

double wearOf(const FeatureLayer& layer, std::uint64_t cell) noexcept {
  const double u = hashUnit(mixHash(cell ^ 10));
  const double skewed = layer.wearSkew > 1 ? 1.0 - (1.0 - u) * (1.0 - u) : layer.wearSkew < 1 ? u * u : u;
  return layer.wearMin + (layer.wearMax - layer.wearMin) * skewed;
}

void tangentFrame(const double n[3], std::uint64_t hash, double axis1[3], double axis2[3]) noexcept {
  // A hashed vector, made orthogonal to n. It is never parallel to n in practice; the fallback keeps it finite all the
  // same.
  double v[3] = {2 * hashUnit(mixHash(hash ^ 1)) - 1, 2 * hashUnit(mixHash(hash ^ 2)) - 1,
                 2 * hashUnit(mixHash(hash ^ 3)) - 1};
  for (int attempt = 0; attempt < 2; ++attempt) {
    const double along = v[0] * n[0] + v[1] * n[1] + v[2] * n[2];
    for (int i = 0; i < 3; ++i) axis1[i] = v[i] - along * n[i];
    const double norm = std::sqrt(axis1[0] * axis1[0] + axis1[1] * axis1[1] + axis1[2] * axis1[2]);
    if (norm > 1e-3) {
      for (int i = 0; i < 3; ++i) axis1[i] /= norm;
      break;
    }
    v[0] = n[1];
    v[1] = n[2];
    v[2] = -n[0];
  }
  axis2[0] = n[1] * axis1[2] - n[2] * axis1[1];
  axis2[1] = n[2] * axis1[0] - n[0] * axis1[2];
  axis2[2] = n[0] * axis1[1] - n[1] * axis1[0];
}

/// Lobes of the orders 2..5 whose amplitudes sum to at most `bound`.
void randomLobes(Feature& f, std::uint64_t hash, double bound) noexcept {
  constexpr double kShare[kLobes] = {0.35, 0.25, 0.2, 0.2};
  for (int k = 0; k < kLobes; ++k) {
    // |cos| + |sin| amplitude <= share * bound, so the wave stays within it.
    const double a = 2 * hashUnit(mixHash(hash ^ (16u + static_cast<unsigned>(k)))) - 1;
    const double b = 2 * hashUnit(mixHash(hash ^ (32u + static_cast<unsigned>(k)))) - 1;
    f.lobeCos[k] = 0.5 * kShare[k] * bound * (a + b);
    f.lobeSin[k] = 0.5 * kShare[k] * bound * (a - b);
  }
}

/// The outline's least distance from the centre, in radii.
double narrowest(const Feature& f) noexcept {
  double lobes = 0;
  for (int k = 0; k < kLobes; ++k) lobes += std::sqrt(f.lobeCos[k] * f.lobeCos[k] + f.lobeSin[k] * f.lobeSin[k]);
  return 1 - lobes;
}

Feature makeRock(const double direction[3], double bodyRadius, double diameter, std::uint64_t hash) noexcept {
  Feature f{};
  const double norm =
      std::sqrt(direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2]);
  const double n[3] = {direction[0] / norm, direction[1] / norm, direction[2] / norm};
  for (int i = 0; i < 3; ++i) f.center[i] = n[i] * bodyRadius;
  tangentFrame(n, hash, f.axis1, f.axis2);
  randomLobes(f, hash, kRockLobes);
  f.radius = 0.5 * diameter;
  f.reach = f.radius / narrowest(f) * (1 + 1e-5);
  f.floorBlend = f.rimBlend = 1;
  f.peak = f.radius * (0.35 + (kRockHeight - 0.35) * hashUnit(mixHash(hash ^ 5)));
  f.brightness = static_cast<float>(0.01 + 0.035 * hashUnit(mixHash(hash ^ 6)));
  return f;
}

/// One cell along one axis of its face.
struct CellSpan {
  double start, width;           ///< face angles
  double least = -1, most = -1;  ///< squares of the tangents within; few cells are asked for them
};
CellSpan cellSpan(const FeatureLayer& layer, std::uint32_t index) noexcept {
  const double width = 2.0 / static_cast<double>(layer.cellsPerFace);
  return {width * static_cast<double>(index) - 1, width};
}
void findTangents(CellSpan& span) noexcept {
  if (span.least >= 0) return;
  const double a = span.start, b = a + span.width;
  const double ta = tanQuarterPi(std::clamp(a, -1.0, 1.0)), tb = tanQuarterPi(std::clamp(b, -1.0, 1.0));
  span.least = a * b <= 0 ? 0 : std::min(ta * ta, tb * tb);
  span.most = std::max(ta * ta, tb * tb);
}

bool isOccupied(const FeatureLayer& layer, const Cell& cell, std::uint64_t hash) noexcept {
  const double share =
      layer.stage == FeatureStage::Rock ? std::min(1.0, layer.occupancy * patchiness(layer, cell)) : layer.occupancy;
  return hashUnit(hash) < share;
}

/// Where a cell's feature is and how large: all of it but its shape.
struct Site {
  double diameter = 0;
  std::uint64_t hash = 0;
  double s = 0, t = 0;  ///< face angles
  double direction[3];
};

/// Cumulative N(> D) ~ D^-2 between D0 and 2 D0: D = D0 / sqrt(1 - 3/4 u).
double diameterOf(const FeatureLayer& layer, std::uint64_t hash) noexcept {
  return layer.smallestDiameter() / std::sqrt(1 - 0.75 * hashUnit(mixHash(hash ^ 7)));
}

/// The outline's widest.
double bowlRadius(const FeatureLayer& layer, double diameter) noexcept {
  return 0.5 * diameter / (1 - (layer.stage == FeatureStage::Rock ? kRockLobes : kCraterLobes));
}

constexpr double kFaceAngles = 4 / 3.14159265358979323846;  ///< to a radian

/// False if the cell is too narrow for the feature.
bool placeSite(const FeatureLayer& layer, double bodyRadius, CellSpan& s, CellSpan& t, Site& out) noexcept {
  findTangents(s);
  findTangents(t);
  const double bowl = bowlRadius(layer, out.diameter);
  // Margin to the cell's sides, in face angle: a point at angle a from the side's great circle, measured along the
  // face's own grid, is at least R sin(a) g away from it, g = sqrt((1 + X^2) / (1 + X^2 + Y^2)), here taken at the
  // worst place of the cell.
  const auto margin = [&](double least, double most) {
    const double g = std::sqrt((1 + least) / (1 + least + most));
    const double sine = bowl / (bodyRadius * g);
    return sine * (1 + 0.2 * sine * sine) * kFaceAngles;  // asin(x) <= x (1 + 0.2 x^2) for x <= 1/2
  };
  const double marginS = margin(s.least, t.most), marginT = margin(t.least, s.most);
  const double roomS = s.width - 2 * marginS, roomT = t.width - 2 * marginT;
  if (roomS < 0 || roomT < 0) return false;
  out.s = s.start + marginS + roomS * hashUnit(mixHash(out.hash ^ 8));
  out.t = t.start + marginT + roomT * hashUnit(mixHash(out.hash ^ 9));
  return true;
}

void directSite(int face, Site& out) noexcept {
  const glm::dvec3 direction = cubeDirection(face, out.s, out.t);
  out.direction[0] = direction.x;
  out.direction[1] = direction.y;
  out.direction[2] = direction.z;
}

Feature featureAt(const FeatureLayer& layer, double bodyRadius, const Site& site) noexcept {
  if (layer.stage == FeatureStage::Rock) return makeRock(site.direction, bodyRadius, site.diameter, site.hash);
  return makeCrater(site.direction, bodyRadius, site.diameter, wearOf(layer, site.hash), site.hash);
}

/// Of a reach, for what rounding does to it.
double widened(double reach, double bodyRadius) noexcept { return reach * (1 + 1e-6) + 1e-9 * bodyRadius; }

/// Calls visit(site) for every occupied cell's feature, of those that matter, that reaches the target with its middle,
/// in the order face, row, column. reachOf: by a diameter. A cell's feature may lie anywhere in it but for half its
/// width along the sides; most cells are seen not to matter by that, before the feature's place is computed.
template <class Target, class Matters, class ReachOf, class Visit>
void forEachSite(const FeatureLayer& layer, double bodyRadius, const Target& target, const Matters& matters,
                 const ReachOf& reachOf, const Visit& visit) {
  thread_local std::vector<CellSpan> columnSpans;
  const double widest = 1.02 * reachOf(layer.largestDiameter());
  for (int face = 0; face < 6; ++face) {
    const FaceView& view = target.viewOf(face);
    const auto [columns, rows] = view.cells(widest, layer.cellsPerFace);
    if (columns.empty()) continue;
    columnSpans.clear();
    for (std::uint32_t row = rows.first; row <= rows.last; ++row) {
      CellSpan rowSpan = cellSpan(layer, row);
      for (std::uint32_t column = columns.first; column <= columns.last; ++column) {
        if (row == rows.first) columnSpans.push_back(cellSpan(layer, column));
        CellSpan& columnSpan = columnSpans[column - columns.first];
        const Cell cell{face, column, row};
        const std::uint64_t hash = cellHash(layer, cell);
        if (!isOccupied(layer, cell, hash) || !matters(hash)) continue;
        Site site;
        site.hash = hash;
        site.diameter = diameterOf(layer, hash);
        const double reach = widened(reachOf(site.diameter), bodyRadius);
        const double inset = bowlRadius(layer, site.diameter) / bodyRadius * kFaceAngles;
        if (view.isBeyond({columnSpan.start + inset, columnSpan.start + columnSpan.width - inset},
                          {rowSpan.start + inset, rowSpan.start + rowSpan.width - inset}, reach))
          continue;
        if (!placeSite(layer, bodyRadius, columnSpan, rowSpan, site) ||
            view.isBeyond({site.s, site.s}, {site.t, site.t}, reach))
          continue;
        directSite(face, site);
        if (target.touchedFrom(site.direction, bodyRadius, reach)) visit(site);
      }
    }
  }
}

}  // namespace

double FeatureLayer::smallestDiameter() const noexcept { return powerOfTwo(exponent); }

Morphometry freshCrater(double diameter) noexcept {
  const double position = octavePosition(diameter);
  if (diameter < 16384) {
    const double depth = diameter * interpolate(kSimpleRatio, position - 4);
    return {depth, 0.037 * diameter * (depth / (0.2 * diameter)), 0.12, 0};
  }
  const double size = position - 14;
  const double depth = interpolate(kComplexDepth, size), rim = interpolate(kComplexRim, size);
  return {depth, rim, 0.42 + 0.07 * std::min(size, 4.0), 0.28 * depth};
}

Feature makeCrater(const double direction[3], double bodyRadius, double diameter, double wear,
                   std::uint64_t hash) noexcept {
  Feature f{};
  const double norm =
      std::sqrt(direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2]);
  const double n[3] = {direction[0] / norm, direction[1] / norm, direction[2] / norm};
  for (int i = 0; i < 3; ++i) f.center[i] = n[i] * bodyRadius;
  tangentFrame(n, hash, f.axis1, f.axis2);
  randomLobes(f, hash, kCraterLobes);

  const Morphometry fresh = freshCrater(diameter);
  f.radius = 0.5 * diameter;
  const double depth = fresh.depth * (1 - 0.8 * wear);
  f.rim = fresh.rim * (1 - 0.72 * wear);
  f.floor = f.rim - depth;  // below the surroundings
  const double floorRadius = fresh.floorRadius + (0.55 - 0.5 * fresh.floorRadius) * wear;
  const double floorSquared = floorRadius * floorRadius;
  f.apex = (f.floor - f.rim * floorSquared) / (1 - floorSquared);
  f.rise = f.rim - f.apex;
  f.floorBlend = depth * (0.15 + 0.55 * wear);
  f.rimBlend = f.rim * (0.7 + 4.5 * wear);
  const bool peaked = diameter > 20000 && diameter < 200000 && wear < 0.6;
  f.peak = peaked ? fresh.peak * (1 - wear) : 0;
  f.reach = kApronRadii * f.radius / narrowest(f) * (1 + 1e-5);
  return f;
}

bool featureOfCell(const FeatureLayer& layer, double bodyRadius, int face, std::uint32_t column, std::uint32_t row,
                   Feature& out) {
  const Cell cell{face, column, row};
  const std::uint64_t hash = cellHash(layer, cell);
  Site site;
  site.hash = hash;
  site.diameter = diameterOf(layer, hash);
  CellSpan columnSpan = cellSpan(layer, column), rowSpan = cellSpan(layer, row);
  if (!isOccupied(layer, cell, hash) || !placeSite(layer, bodyRadius, columnSpan, rowSpan, site)) {
    return false;
  }
  directSite(face, site);
  out = featureAt(layer, bodyRadius, site);
  return true;
}

template <class Target>
void gatherFeatures(const FeatureLayer& layer, double bodyRadius, const Target& target, std::vector<Feature>& out) {
  const double bowls = layer.stage == FeatureStage::Rock ? 1 : kApronRadii;
  forEachSite(
      layer, bodyRadius, target, [](std::uint64_t) { return true; },
      [&](double diameter) { return bowls * bowlRadius(layer, diameter) * (1 + 1e-5); },
      [&](const Site& site) {
        const Feature f = featureAt(layer, bodyRadius, site);
        if (target.touchedFrom(f.center, 1.0, f.reach)) out.push_back(f);
      });
}
template void gatherFeatures(const FeatureLayer&, double, const PatchTarget&, std::vector<Feature>&);
template void gatherFeatures(const FeatureLayer&, double, const RowTarget&, std::vector<Feature>&);

Halo makeHalo(const Feature& crater, double brightness, double rays) noexcept {
  Halo h{};
  std::copy(crater.center, crater.center + 3, h.center);
  std::copy(crater.axis1, crater.axis1 + 3, h.axis1);
  std::copy(crater.axis2, crater.axis2 + 3, h.axis2);
  h.radius = crater.radius;
  h.reach = kHaloRadii * crater.radius * (1 + 1e-5);
  h.brightness = static_cast<float>(brightness);
  h.rays = static_cast<float>(rays);
  return h;
}

void gatherHalos(const FeatureLayer& layer, double bodyRadius, const PatchTarget& patch, std::vector<Halo>& out) {
  if (!layer.hasHalos()) return;
  forEachSite(
      layer, bodyRadius, patch, [&](std::uint64_t hash) { return wearOf(layer, hash) < kHaloWear; },
      [](double diameter) { return 0.5 * diameter * kHaloRadii * (1 + 1e-5); },
      [&](const Site& site) {
        const double youth = 1 - wearOf(layer, site.hash) / kHaloWear;
        // Of many halos few are bright.
        const double brightness = (layer.exponent >= 4 ? 0.08 : 0.03) * youth * youth;
        const Halo h = makeHalo(featureAt(layer, bodyRadius, site), brightness, 0.25 * youth);
        if (patch.touchedFrom(h.center, 1.0, h.reach)) out.push_back(h);
      });
}

}  // namespace terrane::lunar
