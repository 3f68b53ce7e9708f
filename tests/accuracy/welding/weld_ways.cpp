#include "tests/accuracy/welding/weld_ways.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace terrane::accuracy {
namespace {

template <class Key>
struct Keyed {
  Key key;
  std::uint32_t corner;
};

template <class Key>
Weld joined(std::span<const Keyed<Key>> sorted) {
  Weld weld{std::vector<std::uint32_t>(sorted.size()), 0};
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (i == 0 || !(sorted[i].key == sorted[i - 1].key)) ++weld.count;
    weld.vertexOfCorner[sorted[i].corner] = weld.count - 1;
  }
  return weld;
}

template <class Key, class Item, class KeyOf>
std::vector<Keyed<Key>> keysOf(std::span<const Item> items, const KeyOf& keyOf) {
  std::vector<Keyed<Key>> keys(items.size());
  for (std::size_t i = 0; i < items.size(); ++i) keys[i] = {keyOf(items[i]), static_cast<std::uint32_t>(i)};
  return keys;
}

template <class Key, class Item, class KeyOf>
Weld weldByKey(std::span<const Item> items, const KeyOf& keyOf) {
  auto keys = keysOf<Key>(items, keyOf);
  std::ranges::sort(keys, {}, &Keyed<Key>::key);
  return joined<Key>(keys);
}

std::uint64_t key64Of(const Corner& corner) { return key64(cellPoint(corner.face, corner.weights)); }

void radixSort(std::vector<Keyed<std::uint64_t>>& keys) {
  std::vector<Keyed<std::uint64_t>> other(keys.size());
  for (int shift = 0; shift < 64; shift += 8) {
    const auto digit = [shift](const Keyed<std::uint64_t>& k) {
      return static_cast<std::size_t>(k.key >> shift) & 255;
    };
    std::array<std::size_t, 257> starts{};
    for (const auto& k : keys) ++starts[digit(k) + 1];
    if (std::ranges::find(starts, keys.size()) != starts.end()) continue;  // all alike
    for (std::size_t d = 1; d < starts.size(); ++d) starts[d] += starts[d - 1];
    for (const auto& k : keys) other[starts[digit(k)]++] = k;
    keys.swap(other);
  }
}

struct Coordinates {
  double x, y, z;
  auto operator<=>(const Coordinates&) const = default;  // NOLINT(modernize-use-nullptr): clang 14
};

}  // namespace

Weld weldByKey64(std::span<const Corner> corners) { return weldByKey<std::uint64_t>(corners, key64Of); }

Weld weldByKey64Radix(std::span<const Corner> corners) {
  auto keys = keysOf<std::uint64_t>(corners, key64Of);
  radixSort(keys);
  return joined<std::uint64_t>(keys);
}

Weld weldByKey64HashTable(std::span<const Corner> corners) {
  constexpr std::uint32_t kFree = ~std::uint32_t{0};
  const std::size_t size = std::bit_ceil(corners.size() + 1);  // never full
  std::vector<std::uint32_t> vertices(size, kFree);
  std::vector<std::uint64_t> keyOfVertex;
  Weld weld{std::vector<std::uint32_t>(corners.size()), 0};
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const std::uint64_t key = key64Of(corners[i]);
    std::size_t at = static_cast<std::size_t>(key * 0x9E3779B97F4A7C15 >> (64 - std::countr_zero(size)));
    while (vertices[at] != kFree && keyOfVertex[vertices[at]] != key) at = (at + 1) & (size - 1);
    if (vertices[at] == kFree) {
      vertices[at] = weld.count++;
      keyOfVertex.push_back(key);
    }
    weld.vertexOfCorner[i] = vertices[at];
  }
  return weld;
}

Weld weldByKey128(std::span<const Corner> corners) {
  return weldByKey<Key128>(corners, [](const Corner& c) { return key128(cellPoint(c.face, c.weights)); });
}

Weld weldByCoordinates(std::span<const glm::dvec3> positions) {
  return weldByKey<Coordinates>(positions, [](const glm::dvec3& p) { return Coordinates{p.x, p.y, p.z}; });
}

template <class Real>
std::vector<HashedCorner<Real>> sortedHashes(std::span<const glm::vec<3, Real>> positions, Sort sort) {
  std::vector<HashedCorner<Real>> hashes(positions.size());
  for (std::size_t i = 0; i < hashes.size(); ++i) {
    const glm::vec<3, Real>& p = positions[i];
    const Real theta = std::acos(std::clamp(p.z, Real(-1), Real(1))), phi = std::atan2(p.y, p.x);
    hashes[i] = {theta + static_cast<Real>(kLongitudeFactor) * phi, static_cast<std::uint32_t>(i)};
  }
  const auto before = [](const HashedCorner<Real>& a, const HashedCorner<Real>& b) { return a.hash < b.hash; };
  if (sort == Sort::Introsort) {
    std::sort(hashes.begin(), hashes.end(), before);
  } else {
    std::make_heap(hashes.begin(), hashes.end(), before);
    std::sort_heap(hashes.begin(), hashes.end(), before);
  }
  return hashes;
}

template <class Real>
Weld weldSorted(std::span<const HashedCorner<Real>> sorted, double epsilon) {
  Weld weld{std::vector<std::uint32_t>(sorted.size()), 0};
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (i == 0 || static_cast<double>(sorted[i].hash) - static_cast<double>(sorted[i - 1].hash) > epsilon) ++weld.count;
    weld.vertexOfCorner[sorted[i].corner] = weld.count - 1;
  }
  return weld;
}

template std::vector<HashedCorner<float>> sortedHashes<float>(std::span<const glm::vec3>, Sort);
template std::vector<HashedCorner<double>> sortedHashes<double>(std::span<const glm::dvec3>, Sort);
template Weld weldSorted<float>(std::span<const HashedCorner<float>>, double);
template Weld weldSorted<double>(std::span<const HashedCorner<double>>, double);

}  // namespace terrane::accuracy
