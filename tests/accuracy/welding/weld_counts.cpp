#include "tests/accuracy/welding/weld_counts.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace terrane::accuracy {
namespace {

constexpr double kCosineOfPoles = 0.9961946980917455;  // of 5 degrees
constexpr double kOnSeam = 1e-9;                       // radians
constexpr std::size_t kNowhere = std::numeric_limits<std::size_t>::max();

struct Pair {
  std::uint32_t truth, found;
  std::uint32_t corner;
  auto operator<=>(const Pair&) const = default;  // NOLINT(modernize-use-nullptr): clang 14
};

/// Each true vertex with each vertex that it became part of, once.
std::vector<Pair> incidences(const Weld& weld, const Weld& truth) {
  std::vector<Pair> pairs(weld.vertexOfCorner.size());
  for (std::size_t i = 0; i < pairs.size(); ++i)
    pairs[i] = {truth.vertexOfCorner[i], weld.vertexOfCorner[i], static_cast<std::uint32_t>(i)};
  std::ranges::sort(pairs);
  const auto same = [](const Pair& a, const Pair& b) { return a.truth == b.truth && a.found == b.found; };
  pairs.erase(std::unique(pairs.begin(), pairs.end(), same), pairs.end());
  return pairs;
}

/// Largest gap between neighbours in order that the copies of one vertex, out of those counted, lie on both sides of.
template <class Real, class Counts>
double widestGapWithin(std::span<const HashedCorner<Real>> sorted, const Weld& truth, const Counts& counts) {
  std::vector<std::size_t> first(truth.count, kNowhere), last(truth.count, kNowhere);
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (!counts(sorted[i].corner)) continue;
    const std::uint32_t vertex = truth.vertexOfCorner[sorted[i].corner];
    if (first[vertex] == kNowhere) first[vertex] = i;
    last[vertex] = i;
  }
  std::vector<int> begins(sorted.size() + 1, 0);
  for (std::size_t vertex = 0; vertex < first.size(); ++vertex) {
    if (first[vertex] == kNowhere) continue;
    ++begins[first[vertex]];
    --begins[last[vertex]];
  }
  double widest = 0;
  int open = 0;
  for (std::size_t i = 0; i + 1 < sorted.size(); ++i) {
    open += begins[i];
    if (open > 0)
      widest = std::max(widest, static_cast<double>(sorted[i + 1].hash) - static_cast<double>(sorted[i].hash));
  }
  return widest;
}

}  // namespace

Where whereIs(const glm::dvec3& direction) {
  if (std::fabs(direction.z) > kCosineOfPoles) return Where::Pole;
  return direction.x < 0 && std::fabs(direction.y) < kOnSeam ? Where::Seam : Where::Elsewhere;
}

void ByPlace::add(Where where, std::int64_t count) {
  (where == Where::Pole ? pole : where == Where::Seam ? seam : elsewhere) += count;
}

WeldCounts compare(const Weld& weld, const Weld& truth, std::span<const glm::dvec3> directions) {
  WeldCounts counts;
  counts.truth = truth.count;
  counts.found = weld.count;
  std::vector<Pair> pairs = incidences(weld, truth);
  for (std::size_t i = 1; i < pairs.size(); ++i)
    if (pairs[i].truth == pairs[i - 1].truth) counts.missed.add(whereIs(directions[pairs[i].corner]), 1);
  std::ranges::sort(pairs, {}, &Pair::found);
  for (std::size_t i = 1; i < pairs.size(); ++i)
    if (pairs[i].found == pairs[i - 1].found) counts.wrong.add(whereIs(directions[pairs[i].corner]), 1);
  return counts;
}

template <class Real>
EpsilonBounds epsilonBounds(std::span<const HashedCorner<Real>> sorted, const Weld& truth,
                            std::span<const glm::dvec3> directions) {
  EpsilonBounds bounds;
  bounds.leastForNoMiss = widestGapWithin(sorted, truth, [](std::uint32_t) { return true; });
  bounds.leastForNoMissElsewhere = widestGapWithin(
      sorted, truth, [&](std::uint32_t corner) { return whereIs(directions[corner]) == Where::Elsewhere; });
  bounds.mostForNoWrong = std::numeric_limits<double>::infinity();
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    if (truth.vertexOfCorner[sorted[i].corner] == truth.vertexOfCorner[sorted[i - 1].corner]) continue;
    bounds.mostForNoWrong =
        std::min(bounds.mostForNoWrong, static_cast<double>(sorted[i].hash) - static_cast<double>(sorted[i - 1].hash));
  }
  return bounds;
}

template EpsilonBounds epsilonBounds<float>(std::span<const HashedCorner<float>>, const Weld&,
                                            std::span<const glm::dvec3>);
template EpsilonBounds epsilonBounds<double>(std::span<const HashedCorner<double>>, const Weld&,
                                             std::span<const glm::dvec3>);

}  // namespace terrane::accuracy
