#pragma once
// What the head of an edgebreaker stream (all before the attributes' values) says of a mesh, as far as the values need
// it. Equal heads say equal things: a tile whose stream begins with a known head needs no connectivity decoded. Private
// to proto. Immutable once learnt; thread-safe.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "proto/draco_listener.h"

namespace terrane {

/// Vertices that predict another across their common edge: next + previous - opposite. All three are the same where
/// that one predicts alone.
struct DracoParallelogram {
  std::uint16_t next, previous, opposite;
  bool operator==(const DracoParallelogram&) const = default;
};

struct DracoConnectivity {
  /// Larger ones are not learnt. One for a tile of 64 cells takes 0.4 MB, one at these limits 3 MB.
  static constexpr std::size_t kMostVertices = 20000, kMostTriangles = 40000, kMostHeadBytes = 64u << 10;

  /// Null for what Terrane does not write (other attributes, another order of them, a vertex without a value of its
  /// own) and beyond the limits above. Throws std::exception where memory or the corner table's own indices run out.
  static std::shared_ptr<DracoConnectivity> learn(const DracoDecoded& decoded, const DracoAttributeIds& ids);

  std::size_t vertexCount() const noexcept { return vertexOfEntry.size(); }
  bool operator==(const DracoConnectivity&) const = default;

  std::size_t headBytes = 0;
  bool colors = false;
  std::vector<std::uint32_t> triangles;  ///< 3 vertices each
  /// Entry i of every attribute is the value of this vertex.
  std::vector<std::uint16_t> vertexOfEntry;
  /// What predicts entry i: its first parallelogram, or the entry before where it has none. Entry 0 by itself.
  std::vector<DracoParallelogram> parallelograms;
  /// All parallelograms of entry i, up to four: as many as the count says, the entries' lists one after the other.
  std::vector<DracoParallelogram> multiParallelograms;
  std::vector<std::uint8_t> multiCounts;
  /// Likewise the triangles around entry i.
  std::vector<std::uint16_t> trianglesAround;
  std::vector<std::uint8_t> trianglesAroundCounts;
  /// The grid indices' bytes as they first came, and their values by vertex.
  std::vector<std::uint8_t> gridBytes;
  std::vector<std::uint16_t> gridIndices;
};

}  // namespace terrane
