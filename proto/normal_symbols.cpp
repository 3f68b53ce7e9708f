#include "proto/normal_symbols.h"

#include <algorithm>
#include <cmath>

#include "proto/octahedron.h"

namespace terrane {
namespace {

void quantise(const OctahedralGrid& grid, NormalScratch& scratch) {
  const std::size_t count = scratch.x.size();
  scratch.s.resize(count + 1);
  scratch.t.resize(count + 1);
  scratch.s[0] = scratch.t[0] = 0;
  const float *x = scratch.x.data(), *y = scratch.y.data(), *z = scratch.z.data();
  std::int32_t *s = scratch.s.data() + 1, *t = scratch.t.data() + 1;
  for (std::size_t i = 0; i < count; ++i) {
    const OctahedralPoint point = octahedralPoint(grid, x[i], y[i], z[i]);
    s[i] = point.s;
    t[i] = point.t;
  }
}

/// Sums of the normals, as long as twice the area, of all triangles around an entry. Whole numbers: a coordinate of one
/// is below 2^34, of a sum below 2^46, exact in double.
void sumFaceNormals(std::span<const std::int32_t> positions, const EntryOrder& order, std::vector<double>& sums) {
  sums.assign(4 * order.size(), 0.0);
  for (const auto& [a, b, c] : order.faces) {
    const std::int32_t *pa = &positions[4 * std::size_t{a}], *pb = &positions[4 * std::size_t{b}],
                       *pc = &positions[4 * std::size_t{c}];
    const double ux = pb[0] - pa[0], uy = pb[1] - pa[1], uz = pb[2] - pa[2];
    const double vx = pc[0] - pa[0], vy = pc[1] - pa[1], vz = pc[2] - pa[2];
    const double nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    for (const std::uint32_t entry : {a, b, c}) {
      double* sum = &sums[4 * std::size_t{entry}];
      sum[0] += nx;
      sum[1] += ny;
      sum[2] += nz;
    }
  }
}

double truncated(double x) noexcept { return static_cast<double>(static_cast<std::int32_t>(x)); }

/// The sums scaled to vectors whose coordinates' magnitudes add up to the center, in whole divisions cut towards zero.
/// Those are divisions in double, cut: a quotient that is not whole is further from the next whole number, by 2^-18 of
/// the first division and 2^-30 of the second, than its rounding moves it, 2^-23 and 2^-38.
void predictVectors(const OctahedralGrid& grid, const std::vector<double>& sums, NormalScratch& scratch) {
  const std::size_t count = sums.size() / 4;
  for (auto* values : {&scratch.px, &scratch.py, &scratch.pz}) values->resize(count);
  constexpr double kMostSum = 1 << 29;
  const double center = grid.center;
  std::int32_t *px = scratch.px.data(), *py = scratch.py.data(), *pz = scratch.pz.data();
  for (std::size_t i = 0; i < count; ++i) {
    const double x = sums[4 * i], y = sums[4 * i + 1], z = sums[4 * i + 2];
    const double sum = std::abs(x) + std::abs(y) + std::abs(z);
    const double quotient = std::max(1.0, truncated(sum / kMostSum));
    const double wholeX = truncated(x / quotient), wholeY = truncated(y / quotient), wholeZ = truncated(z / quotient);
    const double wholeSum = std::abs(wholeX) + std::abs(wholeY) + std::abs(wholeZ);
    const bool flat = wholeSum == 0;
    const double divisor = flat ? 1.0 : wholeSum;
    const auto scaledX = static_cast<std::int32_t>(wholeX * center / divisor);
    const auto scaledY = static_cast<std::int32_t>(wholeY * center / divisor);
    const std::int32_t rest = grid.center - magnitude(scaledX) - magnitude(scaledY);
    px[i] = choose(flat, grid.center, scaledX);
    py[i] = choose(flat, 0, scaledY);
    pz[i] = choose(flat, 0, choose(wholeZ >= 0, rest, -rest));
  }
}

}  // namespace

bool gatherNormals(std::span<const float> normals, const EntryOrder& order, NormalScratch& scratch) {
  const std::size_t count = order.size();
  for (auto* values : {&scratch.x, &scratch.y, &scratch.z}) values->resize(count);
  float *x = scratch.x.data(), *y = scratch.y.data(), *z = scratch.z.data();
  bool sound = true;
  for (std::size_t i = 0; i < count; ++i) {
    const float* normal = &normals[3 * static_cast<std::size_t>(order.pointOfEntry[i])];
    x[i] = normal[0];
    y[i] = normal[1];
    z[i] = normal[2];
    const float squared = x[i] * x[i] + y[i] * y[i] + z[i] * z[i];
    sound &= (squared > 1e-12f) & (squared < 1e12f);  // a NaN fails both
  }
  return sound;
}

void differenceSymbols(int bits, NormalScratch& scratch, std::vector<std::uint32_t>& symbols) {
  const OctahedralGrid grid(bits);
  quantise(grid, scratch);
  const std::size_t count = scratch.x.size();
  symbols.resize(2 * count);
  const std::int32_t *s = scratch.s.data(), *t = scratch.t.data();
  std::uint32_t* out = symbols.data();
  for (std::size_t i = 0; i < count; ++i) {
    const OctahedralPoint left = octahedralCorrection(grid, {s[i + 1], t[i + 1]}, {s[i], t[i]});
    out[2 * i] = static_cast<std::uint32_t>(left.s);
    out[2 * i + 1] = static_cast<std::uint32_t>(left.t);
  }
}

void geometricSymbols(int bits, std::span<const std::int32_t> positions, const EntryOrder& order,
                      NormalScratch& scratch, std::vector<std::uint32_t>& symbols) {
  const OctahedralGrid grid(bits);
  quantise(grid, scratch);
  sumFaceNormals(positions, order, scratch.sums);
  predictVectors(grid, scratch.sums, scratch);
  const std::size_t count = scratch.x.size();
  symbols.resize(2 * count);
  scratch.flips.resize(count);
  const std::int32_t *px = scratch.px.data(), *py = scratch.py.data(), *pz = scratch.pz.data();
  const std::int32_t *s = scratch.s.data() + 1, *t = scratch.t.data() + 1;
  std::uint32_t* out = symbols.data();
  std::uint8_t* flips = scratch.flips.data();
  for (std::size_t i = 0; i < count; ++i) {
    const OctahedralPoint value{s[i], t[i]};
    const OctahedralPoint along = octahedralCorrection(grid, value, octahedralPoint(grid, px[i], py[i], pz[i]));
    const OctahedralPoint against = octahedralCorrection(grid, value, octahedralPoint(grid, -px[i], -py[i], -pz[i]));
    const std::int32_t lengthAlong = magnitude(shortest(grid, along.s)) + magnitude(shortest(grid, along.t));
    const std::int32_t lengthAgainst = magnitude(shortest(grid, against.s)) + magnitude(shortest(grid, against.t));
    const bool flip = lengthAlong >= lengthAgainst;
    out[2 * i] = static_cast<std::uint32_t>(choose(flip, against.s, along.s));
    out[2 * i + 1] = static_cast<std::uint32_t>(choose(flip, against.t, along.t));
    flips[i] = flip ? 1 : 0;
  }
}

}  // namespace terrane
