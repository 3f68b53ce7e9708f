#pragma once
// The order in which a Draco stream visits a mesh's vertices, its entries, and by which earlier ones each is predicted:
// all that predictions need to know of the connectivity. Private to proto. Plain values.

#include <array>
#include <cstdint>
#include <vector>

namespace terrane {

/// Entries that predict another: next + previous - opposite.
struct Parallelogram {
  std::uint32_t next = 0, previous = 0, opposite = 0;
};

struct EntryOrder {
  std::vector<std::uint32_t> pointOfEntry;  ///< which vertex of the mesh is entry i
  /// Of entries 1 and up; without three earlier entries across its own triangle, an entry is predicted by the one
  /// before (all three are that).
  std::vector<Parallelogram> parallelograms;
  /// Of entry i, all around it, at most four: those from aroundBegin[i] up to aroundBegin[i + 1]. An entry without any
  /// is predicted by the one before.
  std::vector<std::uint32_t> aroundBegin;
  std::vector<Parallelogram> around;
  std::vector<std::array<std::uint32_t, 3>> faces;  ///< entries of each triangle
  std::uint32_t mostFacesAroundEntry = 0;

  std::size_t size() const noexcept { return pointOfEntry.size(); }
};

}  // namespace terrane
