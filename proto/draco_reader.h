#pragma once
// Decodes Draco streams that share a connectivity several times faster than libdraco does, to the same meshes. All
// tiles of a kind have the same triangles, so their streams begin with the same bytes: what these say is learnt from
// libdraco at the first tile, and the next ones cost their values only. What is not read here, and all damage, goes to
// decodeDraco, whose answer it then is.

#include <cstdint>
#include <memory>
#include <span>

#include "proto/draco_mesh.h"

namespace terrane {

/// Thread-safe. Remembers the kinds of streams that came last: at most kMostKinds, 3 MB each at the largest that
/// DecodeLimits allow and half a megabyte for a tile of 64 cells; and 2 MB for each thread that decodes.
class DracoReader {
 public:
  static constexpr std::size_t kMostKinds = 8;

  DracoReader();
  ~DracoReader();
  DracoReader(const DracoReader&) = delete;
  DracoReader& operator=(const DracoReader&) = delete;

  /// What decodeDraco returns, bit for bit, errors too.
  Result<TileMesh> decode(std::span<const std::uint8_t> bytes, const DracoAttributeIds& ids,
                          const DecodeLimits& limits);

  /// Streams so far: read here, and by libdraco (first ones of their kind, errors and strangers).
  struct Counts {
    std::uint64_t quick = 0, byLibdraco = 0;
  };
  Counts counts() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace terrane
