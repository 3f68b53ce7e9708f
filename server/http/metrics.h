#pragma once
// What whoever watches a server can read of it at /metrics: the text format of Prometheus, version 0.0.4. Thread-safe.

#include <span>
#include <string>
#include <string_view>

#include "proto/scene_json.h"
#include "server/store/tile_cache.h"

namespace terrane {

inline constexpr std::string_view kMetricsType = "text/plain; version=0.0.4; charset=utf-8";

/// whyStockDraco: of each body (TileBuilder::whyStockDraco), or empty where no builder makes the tiles.
std::string metricsText(const TileCacheStats& cache, std::span<const BodyInfo> bodies,
                        std::span<const std::string> whyStockDraco);

}  // namespace terrane
