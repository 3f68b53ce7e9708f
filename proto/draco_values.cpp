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

/// Values of `components` integers a vertex, by vertex.
template <std::size_t kComponents, class T>
class PredictedValues {
 public:
  PredictedValues(const DracoConnectivity& connectivity, std::vector<T>& values)
      : connectivity_(connectivity), values_(values) {}

  bool decode(DracoBytes& bytes, DracoScratch& scratch) {
    const std::size_t count = connectivity_.vertexCount();
    values_.resize(kComponents * count);
    scratch.corrections.resize(kComponents * count);
    Method method{};
    if (!takeMethod(bytes, Transform::Wrap, method) || !scratch.symbols.read(bytes, kComponents, scratch.corrections))
      return false;
    symbols_ = scratch.corrections.data();
    Creases creases;
    if (method == Method::ConstrainedMultiParallelogram && !creases.begin(bytes, connectivity_.triangles.size()))
      return false;
    if (!Unwrapping::take<T>(bytes, unwrapping_)) return false;
    correct(0, {});
    switch (method) {
      case Method::Difference:
        byDifference();
        break;
      case Method::Parallelogram:
        byParallelogram();
        break;
      case Method::ConstrainedMultiParallelogram:
        byParallelograms(creases);
        break;
      default:
        return false;
    }
    return creases.ok() && unwrapping_.ok();
  }

 private:
  using Entry = std::array<std::int32_t, kComponents>;

  T* at(std::uint16_t vertex) { return values_.data() + kComponents * vertex; }

  void correct(std::size_t entry, const Entry& predicted) {
    T* value = at(connectivity_.vertexOfEntry[entry]);
    for (std::size_t c = 0; c < kComponents; ++c)
      value[c] = static_cast<T>(unwrapping_(predicted[c], symbols_[kComponents * entry + c]));
  }

  void byDifference() {
    for (std::size_t entry = 1; entry < connectivity_.vertexCount(); ++entry) {
      const T* before = at(connectivity_.vertexOfEntry[entry - 1]);
      Entry predicted;
      for (std::size_t c = 0; c < kComponents; ++c) predicted[c] = before[c];
      correct(entry, predicted);
    }
  }

  void add(const DracoParallelogram& by, Entry& sum) {
    const T *next = at(by.next), *previous = at(by.previous), *opposite = at(by.opposite);
    for (std::size_t c = 0; c < kComponents; ++c) sum[c] += next[c] + previous[c] - opposite[c];
  }

  void byParallelogram() {
    for (std::size_t entry = 1; entry < connectivity_.vertexCount(); ++entry) {
      Entry predicted{};
      add(connectivity_.parallelograms[entry], predicted);
      correct(entry, predicted);
    }
  }

  void byParallelograms(Creases& creases) {
    const DracoParallelogram* parallelogram = connectivity_.multiParallelograms.data();
    for (std::size_t entry = 1; entry < connectivity_.vertexCount(); ++entry) {
      const std::size_t count = connectivity_.multiCounts[entry];
      Entry predicted{};
      std::int32_t used = 0;
      for (std::size_t i = 0; i < count; ++i, ++parallelogram) {
        if (creases.next(count)) continue;
        add(*parallelogram, predicted);
        ++used;
      }
      if (used == 0) {
        const T* before = at(connectivity_.vertexOfEntry[entry - 1]);
        std::copy_n(before, kComponents, predicted.begin());
      } else if (used > 1) {
        for (std::int32_t& component : predicted) component /= used;
      }
      correct(entry, predicted);
    }
  }

  const DracoConnectivity& connectivity_;
  std::vector<T>& values_;
  const std::uint32_t* symbols_ = nullptr;
  Unwrapping unwrapping_;
};

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
    std::vector<std::uint32_t>& corrections = scratch.corrections;
    corrections.resize(2 * connectivity_.vertexCount());
    Method method{};
    if (!takeMethod(bytes, Transform::CanonicalOctahedron, method) || !scratch.symbols.read(bytes, 2, corrections))
      return false;
    std::int32_t mostQuantized = 0, center = 0;
    if (!bytes.take(mostQuantized) || !bytes.take(center)) return false;
    bits_ = std::bit_width(static_cast<std::uint32_t>(mostQuantized));
    if (bits_ < 2 || bits_ > 16 || mostQuantized != (1 << bits_) - 1 || center != mostQuantized / 2) return false;
    const auto greatest = static_cast<std::uint32_t>(mostQuantized - 1);
    if (std::ranges::max(corrections) > greatest) return false;
    mesh_.normals.resize(3 * connectivity_.vertexCount());
    toolBox_.SetQuantizationBits(bits_);
    if (method == Method::Difference) {
      byDifference(corrections);
      return true;
    }
    return method == Method::GeometricNormal && byGeometry(bytes, scratch);
  }

 private:
  static OctahedralPoint correctionOf(const std::vector<std::uint32_t>& corrections, std::size_t entry) {
    return {static_cast<std::int32_t>(corrections[2 * entry]), static_cast<std::int32_t>(corrections[2 * entry + 1])};
  }

  void set(std::size_t entry, OctahedralPoint at) {
    float* normal = mesh_.normals.data() + 3 * static_cast<std::size_t>(connectivity_.vertexOfEntry[entry]);
    toolBox_.QuantizedOctahedralCoordsToUnitVector(at.s, at.t, normal);
  }

  void byDifference(const std::vector<std::uint32_t>& corrections) {
    const DracoOctahedron octahedron(bits_);
    OctahedralPoint at;
    for (std::size_t entry = 0; entry < connectivity_.vertexCount(); ++entry) {
      at = octahedron.corrected(at, correctionOf(corrections, entry));
      set(entry, at);
    }
  }

  bool byGeometry(DracoBytes& bytes, DracoScratch& scratch) {
    DracoFlags flips;
    if (!flips.begin(bytes)) return false;
    findTriangleNormals(connectivity_, mesh_.offsets, scratch.triangleNormals);
    const DracoOctahedron octahedron(bits_);
    const std::uint16_t* triangle = connectivity_.trianglesAround.data();
    for (std::size_t entry = 0; entry < connectivity_.vertexCount(); ++entry) {
      double x = 0, y = 0, z = 0;
      for (int i = 0; i < connectivity_.trianglesAroundCounts[entry]; ++i, ++triangle) {
        const double* normal = scratch.triangleNormals.data() + 3 * static_cast<std::size_t>(*triangle);
        x += normal[0];
        y += normal[1];
        z += normal[2];
      }
      const OctahedralPoint predicted = geometricNormal(x, y, z, flips.next(), octahedron);
      set(entry, octahedron.corrected(predicted, correctionOf(scratch.corrections, entry)));
    }
    return true;
  }

  const DracoConnectivity& connectivity_;
  TileMesh& mesh_;
  draco::OctahedronToolBox toolBox_;
  int bits_ = 0;
};

/// The grid indices are the same for all tiles of a kind, and so are their bytes.
bool decodeGrid(const DracoConnectivity& connectivity, DracoBytes& bytes, DracoScratch& scratch, TileMesh& mesh) {
  if (!connectivity.gridBytes.empty() && bytes.match(connectivity.gridBytes)) {
    mesh.gridIndices = connectivity.gridIndices;
    return true;
  }
  return PredictedValues<1, std::uint16_t>(connectivity, mesh.gridIndices).decode(bytes, scratch);
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
  if (!PredictedValues<3, std::uint16_t>(connectivity, mesh.offsets).decode(bytes, scratch)) return std::nullopt;
  if (!normals.decode(bytes, scratch)) return std::nullopt;
  if (connectivity.colors && !PredictedValues<3, std::uint8_t>(connectivity, mesh.colors).decode(bytes, scratch))
    return std::nullopt;
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
