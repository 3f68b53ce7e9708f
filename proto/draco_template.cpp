#include "proto/draco_template.h"

#include <draco/compression/attributes/normal_compression_utils.h>
#include <draco/compression/attributes/prediction_schemes/prediction_scheme_normal_octahedron_canonicalized_encoding_transform.h>
#include <draco/compression/mesh/mesh_edgebreaker_encoder.h>

#include <algorithm>
#include <cstdint>
#include <exception>
#include <random>
#include <span>
#include <string>

#include "common/numerics/strict_math.h"
#include "proto/draco_input.h"
#include "proto/symbol_encoder.h"

namespace terrane {
namespace {

/// The speeds at which libdraco predicts positions, colours and indices by single parallelograms and normals by the one
/// before.
constexpr int kLeastSpeed = 4, kGreatestSpeed = 7;
/// After all values: the quantisation of positions (origin 3 x 4 bytes, range 4, bits 1) and of normals (bits 1).
constexpr std::size_t kTailBytes = 18;

/// libdraco's encoder, which tells where the values begin and in which order they come.
class ListeningEncoder : public draco::MeshEdgebreakerEncoder {
 public:
  std::size_t headBytes = 0;

 protected:
  bool EncodeAllAttributes() override {
    headBytes = buffer()->size();
    return draco::MeshEdgebreakerEncoder::EncodeAllAttributes();
  }
};

/// Working memory of one encode.
struct Scratch {
  std::vector<std::int32_t> values;  ///< in the order of entries
  std::vector<std::uint32_t> symbols;
};
Scratch& scratchOfThread() {
  thread_local Scratch scratch;
  return scratch;
}

std::uint32_t symbolOf(std::int32_t correction) noexcept {
  return correction >= 0 ? static_cast<std::uint32_t>(correction) << 1
                         : (static_cast<std::uint32_t>(-(correction + 1)) << 1) | 1u;
}

/// The residual of a value known to lie in [least, greatest], brought into half of that range on either side of zero.
class WrappedResidual {
 public:
  explicit WrappedResidual(std::span<const std::int32_t> values) {
    const auto [least, greatest] = std::ranges::minmax(values);
    least_ = least;
    greatest_ = greatest;
    range_ = 1 + greatest - least;
    lowest_ = -(range_ / 2);
    highest_ = range_ % 2 == 0 ? range_ / 2 - 1 : range_ / 2;
  }
  std::int32_t operator()(std::int32_t value, std::int32_t predicted) const noexcept {
    std::int32_t residual = value - std::clamp(predicted, least_, greatest_);
    residual += residual < lowest_ ? range_ : 0;
    residual -= residual > highest_ ? range_ : 0;
    return residual;
  }
  std::int32_t least() const noexcept { return least_; }
  std::int32_t greatest() const noexcept { return greatest_; }

 private:
  std::int32_t least_, greatest_, range_, lowest_, highest_;
};

enum class Method : std::int8_t { Difference = 0, Parallelogram = 1 };
enum class Transform : std::int8_t { Wrap = 1, CanonicalOctahedron = 3 };

void beginAttribute(Method method, Transform transform, draco::EncoderBuffer& out) {
  out.Encode(static_cast<std::int8_t>(method));
  out.Encode(static_cast<std::int8_t>(transform));
  out.Encode(std::uint8_t{1});  // entropy coded
}

bool encodeSymbols(std::span<const std::uint32_t> symbols, int components, int speed, draco::EncoderBuffer& out) {
  thread_local SymbolEncoder encoder;
  thread_local std::vector<std::uint8_t> bytes;
  if (!encoder.begin(symbols, components, 10 - speed)) return false;
  RansStream* const streams[] = {&encoder.stream()};
  encodeStreams(streams);
  bytes.clear();
  encoder.append(bytes);
  return out.Encode(bytes.data(), bytes.size());
}

/// Values of one attribute, predicted by parallelograms.
template <int kComponents, class T, class Parallelograms>
bool encodePredicted(const std::vector<T>& source, std::span<const std::uint32_t> pointOfEntry,
                     const Parallelograms& parallelograms, int speed, draco::EncoderBuffer& out) {
  constexpr std::size_t kStride = kComponents;
  Scratch& scratch = scratchOfThread();
  const std::size_t count = pointOfEntry.size();
  scratch.values.resize(kStride * count);
  scratch.symbols.resize(kStride * count);
  for (std::size_t entry = 0; entry < count; ++entry)
    for (std::size_t c = 0; c < kStride; ++c)
      scratch.values[kStride * entry + c] = source[kStride * pointOfEntry[entry] + c];

  const WrappedResidual residual(scratch.values);
  const std::int32_t* values = scratch.values.data();
  for (std::size_t c = 0; c < kStride; ++c) scratch.symbols[c] = symbolOf(residual(values[c], 0));
  for (std::size_t entry = 1; entry < count; ++entry) {
    const auto& [next, previous, opposite] = parallelograms[entry - 1];
    for (std::size_t c = 0; c < kStride; ++c) {
      const std::int32_t predicted =
          values[kStride * next + c] + values[kStride * previous + c] - values[kStride * opposite + c];
      scratch.symbols[kStride * entry + c] = symbolOf(residual(values[kStride * entry + c], predicted));
    }
  }
  beginAttribute(Method::Parallelogram, Transform::Wrap, out);
  if (!encodeSymbols(scratch.symbols, kComponents, speed, out)) return false;
  out.Encode(residual.least());
  out.Encode(residual.greatest());
  return true;
}

/// Octahedral normals, each predicted by the one before.
bool encodeNormals(const std::vector<float>& normals, std::span<const std::uint32_t> pointOfEntry,
                   const DracoSettings& settings, draco::EncoderBuffer& out) {
  draco::OctahedronToolBox octahedron;
  if (!octahedron.SetQuantizationBits(settings.normalBits)) return false;
  draco::PredictionSchemeNormalOctahedronCanonicalizedEncodingTransform<std::int32_t> transform(
      octahedron.max_quantized_value());
  Scratch& scratch = scratchOfThread();
  scratch.symbols.resize(2 * pointOfEntry.size());
  std::int32_t before[2] = {0, 0};
  for (std::size_t entry = 0; entry < pointOfEntry.size(); ++entry) {
    std::int32_t value[2], correction[2];
    octahedron.FloatVectorToQuantizedOctahedralCoords(&normals[3 * static_cast<std::size_t>(pointOfEntry[entry])],
                                                      &value[0], &value[1]);
    transform.ComputeCorrection(value, before, correction);
    for (std::size_t c = 0; c < 2; ++c) {
      scratch.symbols[2 * entry + c] = static_cast<std::uint32_t>(correction[c]);
      before[c] = value[c];
    }
  }
  beginAttribute(Method::Difference, Transform::CanonicalOctahedron, out);
  return encodeSymbols(scratch.symbols, 2, settings.speed, out) && transform.EncodeTransformData(&out);
}

/// Data that takes no pattern: all that an encoder may choose by data it meets in this or in smooth ground.
TileMesh noiseOn(const TileMesh& model) {
  TileMesh noise = model;
  std::minstd_rand random(1);
  const auto draw = [&] { return static_cast<std::uint32_t>(random()) >> 4; };
  for (auto& offset : noise.offsets) offset = static_cast<std::uint16_t>(draw());
  for (auto& color : noise.colors) color = static_cast<std::uint8_t>(draw());
  for (auto& component : noise.normals) component = static_cast<float>(draw() % 2001) - 1000.5f;
  return noise;
}

}  // namespace

/// Fills a template from what libdraco wrote.
class DracoTemplate::Learner {
 public:
  static std::shared_ptr<const DracoTemplate> learn(const TileMesh& model, const DracoSettings& settings) {
    const TileMesh noise = noiseOn(model);
    const Result<DracoBuffer> smooth = encodeDraco(model, settings);
    if (smooth.has_error()) return nullptr;
    const std::shared_ptr<DracoTemplate> learnt(new DracoTemplate);
    learnt->settings_ = settings;
    learnt->triangles_ = model.triangles;
    learnt->gridIndices_ = model.gridIndices;
    learnt->colors_ = !model.colors.empty();
    learnt->ids_ = *smooth;
    learnt->ids_.bytes.clear();
    std::vector<std::uint8_t> noiseBytes;
    if (!listen(noise, *learnt, noiseBytes)) return nullptr;
    const auto gives = [&](const TileMesh& mesh, const std::vector<std::uint8_t>& expected) {
      const Result<DracoBuffer> encoded = learnt->encodeFitting(mesh);
      return encoded.has_value() && encoded->bytes == expected;
    };
    if (!gives(model, smooth->bytes) || !gives(noise, noiseBytes)) return nullptr;
    return learnt;
  }

 private:
  /// stream: what libdraco wrote.
  static bool listen(const TileMesh& mesh, DracoTemplate& out, std::vector<std::uint8_t>& stream) {
    const DracoInput input(mesh);
    ListeningEncoder encoder;
    draco::EncoderBuffer buffer;
    if (!input.encode(encoder, out.settings_, buffer)) return false;
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(buffer.data());
    stream.assign(bytes, bytes + buffer.size());
    if (buffer.size() < encoder.headBytes + kTailBytes) return false;
    out.head_.assign(bytes, bytes + encoder.headBytes);
    out.tail_.assign(bytes + buffer.size() - kTailBytes, bytes + buffer.size());

    const auto* order = encoder.GetAttributeEncodingData(out.ids_.positionId);
    const draco::CornerTable* corners = encoder.GetCornerTable();
    if (order == nullptr || corners == nullptr) return false;
    takeOrder(input.mesh(), *order, *corners, out);
    if (out.pointOfEntry_.size() != mesh.vertexCount()) return false;
    draco::EncoderBuffer grid;
    if (!encodePredicted<1>(mesh.gridIndices, out.pointOfEntry_, out.parallelograms_, out.settings_.speed, grid))
      return false;
    out.grid_.assign(grid.data(), grid.data() + grid.size());
    return true;
  }

  static void takeOrder(const draco::Mesh& mesh, const draco::MeshAttributeIndicesEncodingData& order,
                        const draco::CornerTable& corners, DracoTemplate& out) {
    const auto& cornerOfEntry = order.encoded_attribute_value_index_to_corner_map;
    const auto entryAt = [&](draco::CornerIndex corner) {
      return static_cast<std::uint32_t>(
          order.vertex_to_encoded_attribute_value_index_map[corners.Vertex(corner).value()]);
    };
    for (std::uint32_t entry = 0; entry < cornerOfEntry.size(); ++entry) {
      out.pointOfEntry_.push_back(mesh.CornerToPointId(cornerOfEntry[entry]).value());
      if (entry == 0) continue;
      // Without three earlier entries around it, an entry is predicted by the one before.
      Parallelogram by{entry - 1, entry - 1, entry - 1};
      if (const draco::CornerIndex across = corners.Opposite(cornerOfEntry[entry]);
          across != draco::kInvalidCornerIndex) {
        const Parallelogram around{entryAt(corners.Next(across)), entryAt(corners.Previous(across)), entryAt(across)};
        if (std::max({around.next, around.previous, around.opposite}) < entry) by = around;
      }
      out.parallelograms_.push_back(by);
    }
  }
};

std::shared_ptr<const DracoTemplate> DracoTemplate::learn(const TileMesh& model, const DracoSettings& settings) {
  if (settings.speed < kLeastSpeed || settings.speed > kGreatestSpeed) return nullptr;
  try {
    return Learner::learn(model, settings);
  } catch (const std::exception&) {
    return nullptr;  // out of memory: encodeDraco will say so
  }
}

bool DracoTemplate::fits(const TileMesh& mesh) const noexcept {
  return mesh.colors.empty() != colors_ && mesh.gridIndices == gridIndices_ && mesh.triangles == triangles_;
}

Result<DracoBuffer> DracoTemplate::encode(const TileMesh& mesh) const {
  if (!fits(mesh)) return encodeDraco(mesh, settings_);
  if (auto checked = checkDracoMesh(mesh); !checked) return checked.error();
  try {
    return encodeFitting(mesh);
  } catch (const std::exception& e) {
    return makeError(ErrorKind::Internal, "draco", e.what());
  }
}

Result<DracoBuffer> DracoTemplate::encodeFitting(const TileMesh& mesh) const {
  draco::EncoderBuffer buffer;
  buffer.Encode(head_.data(), head_.size());
  const int speed = settings_.speed;
  const bool encoded =
      encodePredicted<3>(mesh.offsets, pointOfEntry_, parallelograms_, speed, buffer) &&
      encodeNormals(mesh.normals, pointOfEntry_, settings_, buffer) &&
      (mesh.colors.empty() || encodePredicted<3>(mesh.colors, pointOfEntry_, parallelograms_, speed, buffer));
  if (!encoded) return makeError(ErrorKind::Internal, "draco", "refused to encode the symbols of a tile");
  buffer.Encode(grid_.data(), grid_.size());
  buffer.Encode(tail_.data(), tail_.size());
  DracoBuffer out = ids_;
  out.bytes.assign(buffer.data(), buffer.data() + buffer.size());
  return out;
}

}  // namespace terrane
