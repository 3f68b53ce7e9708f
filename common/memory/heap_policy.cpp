#include "common/memory/heap_policy.h"

#include <malloc.h>

#include <algorithm>
#include <limits>

namespace terrane {

void keepFreedMemory(std::size_t mostBytes) noexcept {
#if defined(__GLIBC__)
  const auto most = static_cast<int>(std::min<std::size_t>(mostBytes, std::numeric_limits<int>::max()));
  // NOLINTBEGIN(concurrency-mt-unsafe): the caller has one thread yet
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, most);
  mallopt(M_TOP_PAD, 1 << 20);
  // NOLINTEND(concurrency-mt-unsafe)
#else
  (void)mostBytes;
#endif
}

}  // namespace terrane
