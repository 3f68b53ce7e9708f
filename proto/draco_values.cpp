#include "proto/draco_values.h"

#include <draco/compression/attributes/normal_compression_utils.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "common/numerics/strict_math.h"
#include "proto/draco_octahedron.h"

namespace terrane {
namespace {

enum class Method : std::int8_t {
  Difference = 0,
  Parallelogram = 1,
  ConstrainedMultiParallelogram = 4,
  GeometricNormal = 6
};
enum class Transform : std::int8_t { Wrap = 1, CanonicalOctahedron = 3 };

/// What every attribute begins with: how it is predicted, how corrected, and whether its symbols are entropy-coded.
bool takeMethod(DracoBytes& bytes, Transform expected, Method& method) {
  std::int8_t transform = 0, number = 0;
  std::uint8_t coded = 0;
  if (!bytes.take(number) || !bytes.take(transform) || !bytes.take(coded)) return false;
  method = static_cast<Method>(number);
  return transform == static_cast<std::int8_t>(expected) && coded == 1;
}

/// Undoes what the encoder did to bring corrections of values in [least, greatest] into half of that range.
class Unwrapping {
 public:
  template <class T>
  static bool take(DracoBytes& bytes, Unwrapping& out) {
    return bytes.take(out.least_) && bytes.take(out.greatest_) && out.least_ >= 0 && out.least_ <= out.greatest_ &&
           out.greatest_ <= std::numeric_limits<T>::max();
  }
  /// A value outside the range makes ok() false.
  std::int32_t operator()(std::int32_t predicted, std::uint32_t symbol) noexcept {
    // The lowest bit is the sign. Unsigned, for a hostile symbol may have all bits.
    const std::uint32_t correction = (symbol >> 1) ^ (0u - (symbol & 1u));
    auto value =
        static_cast<std::int32_t>(static_cast<std::uint32_t>(std::clamp(predicted, least_, greatest_)) + correction);
    const std::int32_t range = greatest_ - least_ + 1;
    const std::int32_t shift = (value < least_ ? range : 0) - (value > greatest_ ? range : 0);
    value += shift;
    outside_ |= value < least_ || value > greatest_;
    return value;
  }
  bool ok() const noexcept { return !outside_; }

 private:
  std::int32_t least_ = 0, greatest_ = 0;
  bool outside_ = false;
};

/// Which parallelograms count: a flag for each, kept apart by how many there are at an entry.
class Creases {
 public:
  bool begin(DracoBytes& bytes, std::size_t corners) {
    for (std::size_t i = 0; i < flags_.size(); ++i) {
      if (!bytes.takeVarint(left_[i]) || left_[i] > corners) return false;
      if (left_[i] > 0 && !flags_[i].begin(bytes)) return false;
    }
    return true;
  }
  /// Of the next of so many.
  bool next(std::size_t count) {
    if (left_[count - 1] == 0) {
      ok_ = false;
      return false;
    }
    --left_[count - 1];
    return flags_[count - 1].next();
  }
  bool ok() const noexcept { return ok_; }

 private:
  std::array<DracoFlags, 4> flags_;
  std::array<std::uint32_t, 4> left_{};
  bool ok_ = true;
};

template <std::size_t kComponents>
using Entry = std::array<std::int32_t, kComponents>;

template <std::size_t kComponents, class T>
Entry<kComponents> entryAt(const T* values, std::uint16_t vertex) {
  Entry<kComponents> entry;
  std::copy_n(values + kComponents * vertex, kComponents, entry.begin());
  return entry;
}

// What predicts an entry from those before it. Nothing comes before the first: it is predicted by its own value, which
// is zero until it is set.

struct ByDifference {
  const std::uint16_t* vertexOfEntry;

  template <std::size_t kComponents, class T>
  Entry<kComponents> predict(const T* values, std::size_t entry) const {
    return entryAt<kComponents>(values, vertexOfEntry[entry == 0 ? 0 : entry - 1]);
  }
};

template <std::size_t kComponents, class T>
void addParallelogram(const T* values, const DracoParallelogram& by, Entry<kComponents>& sum) {
  const T *next = values + kComponents * by.next, *previous = values + kComponents * by.previous,
          *opposite = values + kComponents * by.opposite;
  for (std::size_t c = 0; c < kComponents; ++c) sum[c] += next[c] + previous[c] - opposite[c];
}

struct ByParallelogram {
  const DracoParallelogram* parallelograms;

  template <std::size_t kComponents, class T>
  Entry<kComponents> predict(const T* values, std::size_t entry) const {
    Entry<kComponents> predicted{};
    addParallelogram<kComponents>(values, parallelograms[entry], predicted);
    return predicted;
  }
};

struct ByParallelograms {
  const std::uint8_t* counts;
  const DracoParallelogram* next;  ///< of the entry that comes next
  ByDifference otherwise;
  Creases creases;

  template <std::size_t kComponents, class T>
  Entry<kComponents> predict(const T* values, std::size_t entry) {
    Entry<kComponents> sum{};
    std::int32_t used = 0;
    for (const DracoParallelogram* const end = next + counts[entry]; next != end; ++next) {
      if (creases.next(counts[entry])) continue;
      addParallelogram<kComponents>(values, *next, sum);
      ++used;
    }
    if (used == 0) return otherwise.predict<kComponents>(values, entry);
    if (used > 1)
      for (std::int32_t& component : sum) component /= used;
    return sum;
  }
};

/// Sets every vertex' value. All that the loop needs is its own: bytes that it writes could otherwise be anything's.
template <std::size_t kComponents, class T, class Predictor, class Symbols>
bool correct(std::span<const std::uint16_t> vertexOfEntry, Predictor& predictor, Unwrapping unwrapping, Symbols symbols,
             T* values) {
  Predictor own = predictor;
  for (std::size_t entry = 0; entry < vertexOfEntry.size(); ++entry) {
    const Entry<kComponents> predicted = own.template predict<kComponents>(values, entry);
    const auto corrections = symbols.template take<kComponents>();
    T* value = values + kComponents * vertexOfEntry[entry];
    for (std::size_t c = 0; c < kComponents; ++c) value[c] = static_cast<T>(unwrapping(predicted[c], corrections[c]));
  }
  predictor = own;
  return symbols.ok() && unwrapping.ok();
}

/// An attribute of kComponents integers a vertex; values by vertex, empty before.
template <std::size_t kComponents, class T>
bool decodeIntegers(const DracoConnectivity& connectivity, DracoBytes& bytes, DracoSymbols& symbols,
                    std::vector<T>& values) {
  Method method{};
  if (!takeMethod(bytes, Transform::Wrap, method) || !symbols.begin(bytes, kComponents, connectivity.vertexCount()))
    return false;
  Creases creases;
  if (method == Method::ConstrainedMultiParallelogram && !creases.begin(bytes, connectivity.triangles.size()))
    return false;
  Unwrapping unwrapping;
  if (!Unwrapping::take<T>(bytes, unwrapping)) return false;
  values.resize(kComponents * connectivity.vertexCount());
  const auto correctBy = [&](auto& predictor) {
    return symbols.read([&](auto reader) {
      return correct<kComponents>(connectivity.vertexOfEntry, predictor, unwrapping, reader, values.data());
    });
  };
  ByDifference difference{connectivity.vertexOfEntry.data()};
  if (method == Method::Difference) return correctBy(difference);
  if (method == Method::Parallelogram) {
    ByParallelogram one{connectivity.parallelograms.data()};
    return correctBy(one);
  }
  if (method != Method::ConstrainedMultiParallelogram) return false;
  ByParallelograms several{connectivity.multiCounts.data(), connectivity.multiParallelograms.data(), difference,
                           creases};
  return correctBy(several) && several.creases.ok();
}

/// Twice the area of every triangle along its normal: exact, for components are below 2^34.
void findTriangleNormals(const DracoConnectivity& connectivity, const std::vector<std::uint16_t>& offsets,
                         std::vector<double>& normals) {
  normals.resize(connectivity.triangles.size());
  for (std::size_t i = 0; i < normals.size(); i += 3) {
    const std::uint16_t* a = offsets.data() + 3 * static_cast<std::size_t>(connectivity.triangles[i]);
    const std::uint16_t* b = offsets.data() + 3 * static_cast<std::size_t>(connectivity.triangles[i + 1]);
    const std::uint16_t* c = offsets.data() + 3 * static_cast<std::size_t>(connectivity.triangles[i + 2]);
    const double ux = b[0] - a[0], uy = b[1] - a[1], uz = b[2] - a[2];
    const double vx = c[0] - a[0], vy = c[1] - a[1], vz = c[2] - a[2];
    normals[i] = uy * vz - uz * vy;
    normals[i + 1] = uz * vx - ux * vz;
    normals[i + 2] = ux * vy - uy * vx;
  }
}

/// The octahedral normal of a vertex, predicted by the sum of the triangles' around it, turned round if flipped. As
/// libdraco finds it in integers: every sum is below 2^42, so a double holds it, and a quotient of such integers that
/// is none itself lies further from the next one than it can be rounded.
OctahedralPoint geometricNormal(double x, double y, double z, bool flipped, const DracoOctahedron& octahedron) {
  constexpr double kMost = 1 << 29;
  double sum = std::abs(x) + std::abs(y) + std::abs(z);
  if (sum > kMost) {
    const double divisor = std::trunc(sum / kMost);
    x = std::trunc(x / divisor);
    y = std::trunc(y / divisor);
    z = std::trunc(z / divisor);
    sum = std::abs(x) + std::abs(y) + std::abs(z);
  }
  const std::int32_t center = octahedron.center();
  std::int32_t vector[3] = {center, 0, 0};
  if (sum > 0) {
    vector[0] = static_cast<std::int32_t>(x * center / sum);
    vector[1] = static_cast<std::int32_t>(y * center / sum);
    const std::int32_t rest = center - std::abs(vector[0]) - std::abs(vector[1]);
    vector[2] = z >= 0 ? rest : -rest;
  }
  const std::int32_t sign = flipped ? -1 : 1;
  return octahedron.pointOf(sign * vector[0], sign * vector[1], sign * vector[2]);
}

/// Octahedral normals of unit length, by vertex.
class Normals {
 public:
  Normals(const DracoConnectivity& connectivity, TileMesh& mesh) : connectivity_(connectivity), mesh_(mesh) {}

  int bits() const noexcept { return bits_; }

  bool decode(DracoBytes& bytes, DracoScratch& scratch) {
    Method method{};
    std::int32_t mostQuantized = 0, center = 0;
    if (!takeMethod(bytes, Transform::CanonicalOctahedron, method) ||
        !scratch.symbols.begin(bytes, 2, connectivity_.vertexCount()) || !bytes.take(mostQuantized) ||
        !bytes.take(center))
      return false;
    bits_ = std::bit_width(static_cast<std::uint32_t>(mostQuantized));
    if (bits_ < 2 || bits_ > 16 || mostQuantized != (1 << bits_) - 1 || center != mostQuantized / 2) return false;
    mesh_.normals.resize(3 * connectivity_.vertexCount());
    if (method == Method::Difference) return scratch.symbols.read([&](auto reader) { return byDifference(reader); });
    DracoFlags flips;
    if (method != Method::GeometricNormal || !flips.begin(bytes)) return false;
    findTriangleNormals(connectivity_, mesh_.offsets, scratch.triangleNormals);
    return scratch.symbols.read([&](auto reader) { return byGeometry(reader, flips, scratch.triangleNormals.data()); });
  }

 private:
  /// Calls predict with the entry before and the entry's number.
  template <class Symbols, class Predict>
  bool correct(Symbols symbols, Predict predict) {
    const DracoOctahedron octahedron(bits_);
    draco::OctahedronToolBox toolBox;
    toolBox.SetQuantizationBits(bits_);
    const auto greatest = static_cast<std::uint32_t>(octahedron.greatest());
    bool outside = false;
    OctahedralPoint at;
    float* const normals = mesh_.normals.data();
    const std::span<const std::uint16_t> vertexOfEntry = connectivity_.vertexOfEntry;
    for (std::size_t entry = 0; entry < vertexOfEntry.size(); ++entry) {
      const OctahedralPoint predicted = predict(at, entry, octahedron);
      const auto [s, t] = symbols.template take<2>();
      outside |= s > greatest || t > greatest;
      at = octahedron.corrected(predicted, {static_cast<std::int32_t>(std::min(s, greatest)),
                                            static_cast<std::int32_t>(std::min(t, greatest))});
      toolBox.QuantizedOctahedralCoordsToUnitVector(at.s, at.t, normals + 3 * vertexOfEntry[entry]);
    }
    return symbols.ok() && !outside;
  }

  template <class Symbols>
  bool byDifference(Symbols symbols) {
    return correct(symbols, [](OctahedralPoint before, std::size_t, const DracoOctahedron&) { return before; });
  }

  template <class Symbols>
  bool byGeometry(Symbols symbols, DracoFlags flips, const double* triangleNormals) {
    const std::uint16_t* triangle = connectivity_.trianglesAround.data();
    const std::uint8_t* const counts = connectivity_.trianglesAroundCounts.data();
    return correct(symbols, [=](OctahedralPoint, std::size_t entry, const DracoOctahedron& octahedron) mutable {
      double x = 0, y = 0, z = 0;
      for (const std::uint16_t* const end = triangle + counts[entry]; triangle != end; ++triangle) {
        const double* normal = triangleNormals + 3 * static_cast<std::size_t>(*triangle);
        x += normal[0];
        y += normal[1];
        z += normal[2];
      }
      return geometricNormal(x, y, z, flips.next(), octahedron);
    });
  }

  const DracoConnectivity& connectivity_;
  TileMesh& mesh_;
  int bits_ = 0;
};

/// The grid indices are the same for all tiles of a kind, and so are their bytes.
bool decodeGrid(const DracoConnectivity& connectivity, DracoBytes& bytes, DracoScratch& scratch, TileMesh& mesh) {
  if (!connectivity.gridBytes.empty() && bytes.match(connectivity.gridBytes)) {
    mesh.gridIndices = connectivity.gridIndices;
    return true;
  }
  return decodeIntegers<1>(connectivity, bytes, scratch.symbols, mesh.gridIndices);
}

/// After all values: how positions and normals are quantised. Positions by whole steps: origin 0, range 65535, 16 bits.
bool quantizationIsOurs(DracoBytes& bytes, int normalBits) {
  std::array<float, 3> origin{};
  float range = 0;
  std::uint8_t positionBits = 0, bits = 0;
  if (!bytes.take(origin) || !bytes.take(range) || !bytes.take(positionBits) || !bytes.take(bits)) return false;
  const bool atZero = std::ranges::all_of(origin, [](float x) { return x == 0 && !std::signbit(x); });
  return atZero && range == 65535.0f && positionBits == 16 && bits == normalBits;
}

std::optional<TileMesh> decode(const DracoConnectivity& connectivity, std::span<const std::uint8_t> stream,
                               DracoScratch& scratch, std::span<const std::uint8_t>& gridBytes) {
  TileMesh mesh;
  DracoBytes bytes(stream, connectivity.headBytes);
  Normals normals(connectivity, mesh);
  if (!decodeIntegers<3>(connectivity, bytes, scratch.symbols, mesh.offsets)) return std::nullopt;
  if (!normals.decode(bytes, scratch)) return std::nullopt;
  if (connectivity.colors && !decodeIntegers<3>(connectivity, bytes, scratch.symbols, mesh.colors)) return std::nullopt;
  const std::size_t gridBegin = bytes.position();
  if (!decodeGrid(connectivity, bytes, scratch, mesh)) return std::nullopt;
  gridBytes = bytes.since(gridBegin);
  if (!quantizationIsOurs(bytes, normals.bits())) return std::nullopt;
  mesh.triangles = connectivity.triangles;
  return mesh;
}

}  // namespace

std::optional<TileMesh> decodeDracoValues(const DracoConnectivity& connectivity, std::span<const std::uint8_t> bytes,
                                          DracoScratch& scratch) {
  std::span<const std::uint8_t> gridBytes;
  return decode(connectivity, bytes, scratch, gridBytes);
}

std::optional<TileMesh> learnDracoGrid(DracoConnectivity& connectivity, std::span<const std::uint8_t> bytes,
                                       DracoScratch& scratch) {
  std::span<const std::uint8_t> gridBytes;
  auto mesh = decode(connectivity, bytes, scratch, gridBytes);
  if (mesh) {
    connectivity.gridBytes.assign(gridBytes.begin(), gridBytes.end());
    connectivity.gridIndices = mesh->gridIndices;
  }
  return mesh;
}

}  // namespace terrane
