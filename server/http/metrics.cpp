#include "server/http/metrics.h"

#include <fmt/format.h>

#include <cstdint>
#include <iterator>

namespace terrane {
namespace {

void appendHeader(std::string& out, std::string_view name, std::string_view help, std::string_view type) {
  fmt::format_to(std::back_inserter(out), "# HELP {0} {1}\n# TYPE {0} {2}\n", name, help, type);
}

void appendValue(std::string& out, std::string_view name, std::string_view help, std::string_view type,
                 std::uint64_t value) {
  appendHeader(out, name, help, type);
  fmt::format_to(std::back_inserter(out), "{} {}\n", name, value);
}

void appendCoders(std::string& out, std::span<const BodyInfo> bodies, std::span<const std::string> whyStockDraco) {
  if (whyStockDraco.empty()) return;
  constexpr std::string_view kName = "terrane_draco_template";
  appendHeader(out, kName, "1 if a template learnt from libdraco encodes the body's tiles, 0 if libdraco each of them.",
               "gauge");
  // A body's name holds nothing that a label's value would have to escape: scenes with others are refused.
  for (std::size_t i = 0; i < bodies.size(); ++i)
    fmt::format_to(std::back_inserter(out), "{}{{body=\"{}\"}} {}\n", kName, bodies[i].name,
                   whyStockDraco[i].empty() ? 1 : 0);
}

}  // namespace

std::string metricsText(const TileCacheStats& cache, std::span<const BodyInfo> bodies,
                        std::span<const std::string> whyStockDraco) {
  std::string out;
  const auto counter = [&](std::string_view name, std::string_view help, std::uint64_t value) {
    appendValue(out, name, help, "counter", value);
  };
  const auto gauge = [&](std::string_view name, std::string_view help, std::uint64_t value) {
    appendValue(out, name, help, "gauge", value);
  };
  counter("terrane_tile_hits_total", "Requests for tiles that were in memory.", cache.hits);
  counter("terrane_tile_misses_total", "Requests for tiles that were not in memory.", cache.misses);
  counter("terrane_tile_joined_total", "Requests that waited for a build already under way.", cache.joined);
  counter("terrane_tile_builds_total", "Builds begun.", cache.builds);
  counter("terrane_tile_builds_dropped_total", "Builds that nobody waited for any more before they began.",
          cache.dropped);
  counter("terrane_tile_builds_refused_total", "Requests refused because too many builds waited.", cache.refused);
  counter("terrane_tile_evictions_total", "Tiles that made room in memory for others.", cache.evicted);
  gauge("terrane_tile_builds_in_flight", "Builds that wait or are under way.", cache.inFlight);
  gauge("terrane_tile_memory_bytes", "Memory that tiles take.", cache.bytes);
  gauge("terrane_tile_memory_entries", "Tiles in memory.", cache.entries);
  appendCoders(out, bodies, whyStockDraco);
  return out;
}

}  // namespace terrane
