#include "proto/draco_connectivity.h"

#include <draco/compression/config/compression_shared.h>
#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/mesh/corner_table.h>
#include <draco/mesh/corner_table_iterators.h>
#include <draco/mesh/mesh.h>

#include <algorithm>
#include <array>
#include <optional>

namespace terrane {
namespace {

constexpr std::size_t kMostParallelograms = 4;
constexpr std::size_t kMostTrianglesAround = UINT8_MAX;

/// Whether the attributes are Terrane's, in the order in which it writes them: POSITION quantised, NORMAL octahedral,
/// then COLOR, if any, and grid index as integers. The head ends with a byte for each that says how it is coded.
bool attributesAreKnown(const draco::Mesh& mesh, std::span<const std::uint8_t> head, const DracoAttributeIds& ids) {
  std::vector<int> expectedIds{ids.position, ids.normal};
  if (ids.color >= 0) expectedIds.push_back(ids.color);
  expectedIds.push_back(ids.grid);
  const auto count = expectedIds.size();
  if (static_cast<std::size_t>(mesh.num_attributes()) != count || head.size() < count) return false;
  const auto coders = head.last(count);
  for (std::size_t i = 0; i < count; ++i) {
    const int coder = i == 0   ? draco::SEQUENTIAL_ATTRIBUTE_ENCODER_QUANTIZATION
                      : i == 1 ? draco::SEQUENTIAL_ATTRIBUTE_ENCODER_NORMALS
                               : draco::SEQUENTIAL_ATTRIBUTE_ENCODER_INTEGER;
    if (static_cast<int>(mesh.attribute(static_cast<int>(i))->unique_id()) != expectedIds[i] || coders[i] != coder)
      return false;
  }
  return true;
}

/// Reads libdraco's corner table as entries see it.
class Learner {
 public:
  Learner(const draco::MeshEdgebreakerDecoder& decoder, const draco::Mesh& mesh, DracoConnectivity& out)
      : mesh_(mesh),
        corners_(*decoder.GetCornerTable()),
        cornerOfEntry_(decoder.GetAttributeEncodingData(0)->encoded_attribute_value_index_to_corner_map),
        entryOfVertex_(decoder.GetAttributeEncodingData(0)->vertex_to_encoded_attribute_value_index_map),
        out_(out) {}

  bool learn() {
    if (!takeOrder()) return false;
    for (std::uint32_t i = 0; i < mesh_.num_faces(); ++i)
      for (const draco::PointIndex& corner : mesh_.face(draco::FaceIndex(i))) out_.triangles.push_back(corner.value());
    for (std::uint32_t entry = 0; entry < cornerOfEntry_.size(); ++entry) {
      if (!takeCornersAround(entry)) return false;
      takeParallelograms(entry);
    }
    return true;
  }

 private:
  /// False unless every vertex has one entry.
  bool takeOrder() {
    if (cornerOfEntry_.size() != mesh_.num_points()) return false;
    std::vector<bool> seen(mesh_.num_points());
    for (const draco::CornerIndex& corner : cornerOfEntry_) {
      const std::uint32_t vertex = mesh_.CornerToPointId(corner).value();
      if (vertex >= seen.size() || seen[vertex]) return false;
      seen[vertex] = true;
      out_.vertexOfEntry.push_back(static_cast<std::uint16_t>(vertex));
    }
    return true;
  }

  /// In libdraco's order: from the entry's corner to the left, and where the mesh ends, from there to the right.
  bool takeCornersAround(std::uint32_t entry) {
    around_.clear();
    for (draco::VertexCornersIterator<draco::CornerTable> at(&corners_, cornerOfEntry_[entry]); !at.End(); at.Next()) {
      if (around_.size() == kMostTrianglesAround) return false;
      around_.push_back(at.Corner());
      out_.trianglesAround.push_back(static_cast<std::uint16_t>(corners_.Face(at.Corner()).value()));
    }
    out_.trianglesAroundCounts.push_back(static_cast<std::uint8_t>(around_.size()));
    return true;
  }

  std::int32_t entryAt(draco::CornerIndex corner) const {
    return entryOfVertex_.at(static_cast<std::size_t>(corners_.Vertex(corner).value()));
  }

  /// Across the edge opposite to the corner, if all of it comes before the entry.
  std::optional<DracoParallelogram> parallelogramAt(draco::CornerIndex corner, std::uint32_t entry) const {
    const draco::CornerIndex across = corners_.Opposite(corner);
    if (across == draco::kInvalidCornerIndex) return std::nullopt;
    const std::array<std::int32_t, 3> entries{entryAt(corners_.Next(across)), entryAt(corners_.Previous(across)),
                                              entryAt(across)};
    if (std::ranges::max(entries) >= static_cast<std::int32_t>(entry)) return std::nullopt;
    const auto vertex = [&](std::int32_t of) { return out_.vertexOfEntry.at(static_cast<std::size_t>(of)); };
    return DracoParallelogram{vertex(entries[0]), vertex(entries[1]), vertex(entries[2])};
  }

  void takeParallelograms(std::uint32_t entry) {
    const std::uint16_t before = out_.vertexOfEntry[entry == 0 ? 0 : entry - 1];
    out_.parallelograms.push_back(
        parallelogramAt(around_.front(), entry).value_or(DracoParallelogram{before, before, before}));
    std::uint8_t count = 0;
    for (const draco::CornerIndex& corner : around_) {
      if (count == kMostParallelograms) break;
      const auto parallelogram = parallelogramAt(corner, entry);
      if (!parallelogram) continue;
      out_.multiParallelograms.push_back(*parallelogram);
      ++count;
    }
    out_.multiCounts.push_back(count);
  }

  const draco::Mesh& mesh_;
  const draco::CornerTable& corners_;
  const std::vector<draco::CornerIndex>& cornerOfEntry_;
  const std::vector<std::int32_t>& entryOfVertex_;
  DracoConnectivity& out_;
  std::vector<draco::CornerIndex> around_;  ///< corners at the vertex of the entry in hand
};

}  // namespace

std::shared_ptr<DracoConnectivity> DracoConnectivity::learn(const DracoDecoded& decoded, const DracoAttributeIds& ids) {
  const draco::Mesh& mesh = decoded.mesh;
  const auto head = decoded.head;
  if (head.size() > kMostHeadBytes || mesh.num_points() > kMostVertices || mesh.num_faces() > kMostTriangles)
    return nullptr;
  if (decoded.decoder.GetCornerTable() == nullptr || !attributesAreKnown(mesh, head, ids)) return nullptr;
  const auto learnt = std::make_shared<DracoConnectivity>();
  learnt->headBytes = head.size();
  learnt->colors = ids.color >= 0;
  return Learner(decoded.decoder, mesh, *learnt).learn() ? learnt : nullptr;
}

}  // namespace terrane
