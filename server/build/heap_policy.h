#pragma once
// How a process that builds tiles should hold its heap.

namespace terrane {

/// Draco takes and frees some megabytes a tile. Left to its defaults glibc gives them back to the system each time, and
/// getting them again costs up to half of what the encoding itself does (bench_tile_build with and without
/// --default-heap; more in a process that allocates nothing else). Keeps up to 16 MiB a thread instead. Call once,
/// before any thread is started; does nothing with another C library.
void keepFreedMemory() noexcept;

}  // namespace terrane
