#include "server/build/heap_policy.h"

#include <malloc.h>

namespace terrane {

void keepFreedMemory() noexcept {
#if defined(__GLIBC__)
  // NOLINTBEGIN(concurrency-mt-unsafe): the caller has one thread yet
  mallopt(M_MMAP_THRESHOLD, 32 << 20);
  mallopt(M_TRIM_THRESHOLD, 16 << 20);
  mallopt(M_TOP_PAD, 1 << 20);
  // NOLINTEND(concurrency-mt-unsafe)
#endif
}

}  // namespace terrane
