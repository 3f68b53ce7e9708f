#include "proto/draco_reader.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <exception>
#include <list>
#include <mutex>
#include <optional>
#include <vector>

#include "proto/draco_connectivity.h"
#include "proto/draco_listener.h"
#include "proto/draco_values.h"

namespace terrane {
namespace {

/// A head that came. Without connectivity its streams are libdraco's.
struct Kind {
  std::vector<std::uint8_t> head;
  DracoAttributeIds ids;
  std::shared_ptr<const DracoConnectivity> connectivity;

  bool fits(std::span<const std::uint8_t> bytes, const DracoAttributeIds& wanted) const {
    return bytes.size() >= head.size() && ids == wanted && std::memcmp(bytes.data(), head.data(), head.size()) == 0;
  }
};

DracoScratch& scratchOfThread() {
  thread_local DracoScratch scratch;
  return scratch;
}

template <class T>
bool sameBits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool sameBits(const TileMesh& a, const TileMesh& b) {
  return sameBits(a.offsets, b.offsets) && sameBits(a.normals, b.normals) && sameBits(a.colors, b.colors) &&
         sameBits(a.gridIndices, b.gridIndices) && sameBits(a.triangles, b.triangles);
}

std::optional<TileMesh> decodeQuickly(const DracoConnectivity& connectivity, std::span<const std::uint8_t> bytes) {
  try {
    return decodeDracoValues(connectivity, bytes, scratchOfThread());
  } catch (const std::exception&) {
    return std::nullopt;  // out of memory: libdraco will say so
  }
}

/// Whether libdraco finds the same connectivity when all bits after the head are others. It lets a head that lies about
/// its length read on into the values.
bool dependsOnItsHeadAlone(const DracoConnectivity& learnt, std::span<const std::uint8_t> bytes,
                           const DracoAttributeIds& ids) {
  std::vector<std::uint8_t> others(bytes.begin(), bytes.end());
  for (std::size_t i = learnt.headBytes; i < others.size(); ++i) others[i] = static_cast<std::uint8_t>(~others[i]);
  bool same = false;
  decodeDracoConnectivity(others, ids, [&](const DracoDecoded& decoded) {
    const auto again = DracoConnectivity::learn(decoded, ids);
    same = again && *again == learnt;
  });
  return same;
}

/// Null unless the stream that it was learnt from decodes to libdraco's mesh.
std::shared_ptr<const DracoConnectivity> learnChecked(const DracoDecoded& decoded, const TileMesh& mesh,
                                                      std::span<const std::uint8_t> bytes,
                                                      const DracoAttributeIds& ids) {
  const auto learnt = DracoConnectivity::learn(decoded, ids);
  if (!learnt || !dependsOnItsHeadAlone(*learnt, bytes, ids)) return nullptr;
  const auto quick = learnDracoGrid(*learnt, bytes, scratchOfThread());
  return quick && sameBits(*quick, mesh) ? learnt : nullptr;
}

}  // namespace

struct DracoReader::State {
  std::mutex mutex;
  std::list<std::shared_ptr<const Kind>> kinds;  ///< the one asked for last is the first
  std::atomic<std::uint64_t> quick{0}, byLibdraco{0};

  std::shared_ptr<const Kind> find(std::span<const std::uint8_t> bytes, const DracoAttributeIds& ids) {
    const std::lock_guard lock(mutex);
    const auto found = std::ranges::find_if(kinds, [&](const auto& kind) { return kind->fits(bytes, ids); });
    if (found == kinds.end()) return nullptr;
    kinds.splice(kinds.begin(), kinds, found);
    return kinds.front();
  }

  void learn(const DracoDecoded& decoded, const TileMesh& mesh, std::span<const std::uint8_t> bytes,
             const DracoAttributeIds& ids) {
    if (decoded.head.size() > DracoConnectivity::kMostHeadBytes) return;
    auto kind = std::make_shared<Kind>();
    kind->head.assign(decoded.head.begin(), decoded.head.end());
    kind->ids = ids;
    kind->connectivity = learnChecked(decoded, mesh, bytes, ids);
    const std::lock_guard lock(mutex);
    // Another thread may have learnt the same meanwhile.
    std::erase_if(kinds, [&](const auto& known) { return known->ids == kind->ids && known->head == kind->head; });
    kinds.push_front(std::move(kind));
    if (kinds.size() > kMostKinds) kinds.pop_back();
  }
};

DracoReader::DracoReader() : state_(std::make_unique<State>()) {}
DracoReader::~DracoReader() = default;

DracoReader::Counts DracoReader::counts() const noexcept { return {state_->quick, state_->byLibdraco}; }

Result<TileMesh> DracoReader::decode(std::span<const std::uint8_t> bytes, const DracoAttributeIds& ids,
                                     const DecodeLimits& limits) {
  if (const auto checked = checkDracoStream(bytes, ids, limits); !checked) return checked.error();
  const auto known = state_->find(bytes, ids);
  if (known && known->connectivity) {
    if (auto mesh = decodeQuickly(*known->connectivity, bytes)) {
      ++state_->quick;
      return std::move(*mesh);
    }
  }
  ++state_->byLibdraco;
  if (known) return decodeDraco(bytes, ids, limits);
  return decodeDraco(bytes, ids, limits, [&](const DracoDecoded& decoded, const TileMesh& mesh) {
    try {
      state_->learn(decoded, mesh, bytes, ids);
    } catch (const std::exception&) {
      // Out of memory, or corners that do not exist: the mesh is good, but nothing is learnt from it.
    }
  });
}

}  // namespace terrane
