#pragma once
// How a process should hold its heap that takes and frees megabytes over and over.

#include <cstddef>

namespace terrane {

/// Left to its defaults glibc gives freed memory back to the system each time, and getting it again costs up to half of
/// what encoding a tile with Draco does (bench_tile_build with and without --default-heap), and more than a frame of
/// software GL does, which sorts its triangles into tens of megabytes (bench_viewer, likewise). Keeps up to mostBytes
/// at the top of each thread's heap instead. Call once, before any thread is started; does nothing with another C
/// library.
void keepFreedMemory(std::size_t mostBytes) noexcept;

/// Some megabytes a tile, a thread.
inline constexpr std::size_t kHeapKeptByServer = 16u << 20;
/// A frame's triangles, and what decoding leaves.
inline constexpr std::size_t kHeapKeptByViewer = 48u << 20;

}  // namespace terrane
