#include "proto/normal_symbols.h"

#include <algorithm>
#include <cmath>

#include "proto/octahedron.h"

namespace terrane {
namespace {

/// How many numbers a loop over entries writes.
std::size_t padded(std::size_t count) noexcept { return (count + 3) / 4 * 4; }

/// Of |x| < 2^31, in operations that compilers make vector instructions of.
double floored(double x) noexcept {
  const auto whole = static_cast<double>(static_cast<std::int32_t>(x));
  return whole - (whole > x ? 1.0 : 0.0);
}

/// The first two coordinates on the grid, rounded, where the magnitudes of all three add up to the center.
void scaleToGrid(const OctahedralGrid& grid, NormalScratch& scratch) {
  const std::size_t count = scratch.x.size();
  const double center = grid.center;
  const float *x = scratch.x.data(), *y = scratch.y.data(), *z = scratch.z.data();
  std::int32_t *wholeX = scratch.wholeX.data(), *wholeY = scratch.wholeY.data();
  for (std::size_t i = 0; i < count; ++i) {
    const double dx = x[i], dy = y[i], dz = z[i];
    const double scale = 1.0 / (std::abs(dx) + std::abs(dy) + std::abs(dz));
    wholeX[i] = static_cast<std::int32_t>(floored(dx * scale * center + 0.5));
    wholeY[i] = static_cast<std::int32_t>(floored(dy * scale * center + 0.5));
  }
}

void quantise(const OctahedralGrid& grid, NormalScratch& scratch) {
  const std::size_t count = scratch.x.size();
  for (auto* values : {&scratch.wholeX, &scratch.wholeY, &scratch.wholeZ}) values->resize(count);
  for (auto* values : {&scratch.s, &scratch.t}) values->resize(count + 1);
  scaleToGrid(grid, scratch);
  scratch.s[0] = scratch.t[0] = 0;
  for (std::size_t i = 0; i < count; i += 4) {
    const OctahedralPoints points = octahedralPointsOfRounded(grid, load4(&scratch.wholeX[i]),
                                                              load4(&scratch.wholeY[i]), load4(&scratch.negativeZ[i]));
    store4(&scratch.s[i + 1], points.s);
    store4(&scratch.t[i + 1], points.t);
  }
}

/// s and t in turn.
void storePairs(const OctahedralPoints& points, std::uint32_t* out) noexcept {
  store4(out, __builtin_shufflevector(points.s, points.t, 0, 4, 1, 5));
  store4(out + 4, __builtin_shufflevector(points.s, points.t, 2, 6, 3, 7));
}

/// Sums of the normals, as long as twice the area, of all triangles around an entry. Whole numbers: a coordinate of one
/// is below 2^34, of a sum below 2^46, exact in double.
void sumFaceNormals(std::span<const std::int32_t> positions, const EntryOrder& order, std::size_t count,
                    std::vector<double>& sums) {
  sums.assign(4 * count, 0.0);
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
void predictVectors(const OctahedralGrid& grid, NormalScratch& scratch) {
  const std::size_t count = scratch.sums.size() / 4;
  constexpr double kMostSum = 1 << 29;
  const double center = grid.center;
  const double* sums = scratch.sums.data();
  std::int32_t *wholeX = scratch.wholeX.data(), *wholeY = scratch.wholeY.data(), *wholeZ = scratch.wholeZ.data();
  for (std::size_t i = 0; i < count; ++i) {
    const double x = sums[4 * i], y = sums[4 * i + 1], z = sums[4 * i + 2];
    const double sum = std::abs(x) + std::abs(y) + std::abs(z);
    const double quotient = std::max(1.0, truncated(sum / kMostSum));
    const double cutX = truncated(x / quotient), cutY = truncated(y / quotient), cutZ = truncated(z / quotient);
    const double cutSum = std::abs(cutX) + std::abs(cutY) + std::abs(cutZ);
    const double divisor = std::max(1.0, cutSum);
    // Of no direction libdraco makes the first axis.
    const double scaledX = truncated(cutX * center / divisor) + (cutSum == 0 ? center : 0.0);
    const double scaledY = truncated(cutY * center / divisor);
    const double rest = center - std::abs(scaledX) - std::abs(scaledY);
    wholeX[i] = static_cast<std::int32_t>(scaledX);
    wholeY[i] = static_cast<std::int32_t>(scaledY);
    wholeZ[i] = static_cast<std::int32_t>(cutZ < 0 ? -rest : rest);
  }
}

/// libdraco takes what is shorter than 1e-6 by its magnitudes' sum for +x.
void replaceTiny(NormalScratch& scratch) {
  for (std::size_t i = 0; i < scratch.x.size(); ++i) {
    const double sum = std::abs(static_cast<double>(scratch.x[i])) + std::abs(static_cast<double>(scratch.y[i])) +
                       std::abs(static_cast<double>(scratch.z[i]));
    if (!(sum > 1e-6)) scratch.x[i] = 1, scratch.y[i] = scratch.z[i] = 0, scratch.negativeZ[i] = 0;
  }
}

}  // namespace

bool gatherNormals(std::span<const float> normals, const EntryOrder& order, NormalScratch& scratch) {
  const std::size_t count = order.size(), all = padded(count);
  for (auto* values : {&scratch.x, &scratch.y, &scratch.z}) {
    values->resize(all);
    std::fill(values->begin() + static_cast<std::ptrdiff_t>(count), values->end(), 1.0f);
  }
  scratch.negativeZ.resize(all);
  float *x = scratch.x.data(), *y = scratch.y.data(), *z = scratch.z.data();
  for (std::size_t i = 0; i < count; ++i) {
    const float* normal = &normals[3 * static_cast<std::size_t>(order.pointOfEntry[i])];
    x[i] = normal[0];
    y[i] = normal[1];
    z[i] = normal[2];
  }
  std::int32_t* negativeZ = scratch.negativeZ.data();
  std::int32_t unsound = 0, tiny = 0;
  for (std::size_t i = 0; i < all; ++i) {
    const float squared = x[i] * x[i] + y[i] * y[i] + z[i] * z[i];
    unsound |= (squared > 1e-12f ? 0 : 1) | (squared < 1e12f ? 0 : 1);  // a NaN fails both
    tiny |= squared < 4e-12f ? 1 : 0;
    negativeZ[i] = z[i] < 0 ? -1 : 0;
  }
  if (tiny != 0) [[unlikely]]
    replaceTiny(scratch);
  return unsound == 0;
}

void differenceSymbols(int bits, const EntryOrder& order, NormalScratch& scratch, std::vector<std::uint32_t>& symbols) {
  const OctahedralGrid grid(bits);
  quantise(grid, scratch);
  const std::size_t count = scratch.x.size();
  symbols.resize(2 * count);
  const std::int32_t *s = scratch.s.data(), *t = scratch.t.data();
  for (std::size_t i = 0; i < count; i += 4) {
    const OctahedralPoints before{load4(s + i), load4(t + i)}, values{load4(s + i + 1), load4(t + i + 1)};
    storePairs(octahedralCorrections(grid, values, before), &symbols[2 * i]);
  }
  symbols.resize(2 * order.size());
}

void geometricSymbols(int bits, std::span<const std::int32_t> positions, const EntryOrder& order,
                      NormalScratch& scratch, std::vector<std::uint32_t>& symbols) {
  const OctahedralGrid grid(bits);
  quantise(grid, scratch);
  const std::size_t count = scratch.x.size();
  sumFaceNormals(positions, order, count, scratch.sums);
  predictVectors(grid, scratch);
  symbols.resize(2 * count);
  scratch.flips.resize(count);
  for (std::size_t i = 0; i < count; i += 4) {
    const OctahedralPoints values{load4(&scratch.s[i + 1]), load4(&scratch.t[i + 1])};
    const Int4 x = load4(&scratch.wholeX[i]), y = load4(&scratch.wholeY[i]), z = load4(&scratch.wholeZ[i]);
    const OctahedralPoints along = octahedralCorrections(grid, values, octahedralPoints(grid, x, y, z));
    const OctahedralPoints against = octahedralCorrections(grid, values, octahedralPoints(grid, -x, -y, -z));
    const Int4 flip = correctionLengths(grid, along) >= correctionLengths(grid, against);
    storePairs({choose(flip, against.s, along.s), choose(flip, against.t, along.t)}, &symbols[2 * i]);
    for (std::size_t k = 0; k < 4; ++k) scratch.flips[i + k] = flip[k] != 0 ? 1 : 0;
  }
  symbols.resize(2 * order.size());
  scratch.flips.resize(order.size());
}

}  // namespace terrane
