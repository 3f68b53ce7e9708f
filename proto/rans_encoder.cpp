#include "proto/rans_encoder.h"

#include <algorithm>
#include <functional>

#include "proto/little_endian.h"

namespace terrane {
namespace {

/// A stream under way.
struct Lane {
  const std::uint32_t* next = nullptr;  ///< behind the symbol to come
  const std::uint32_t* rankOfSymbol = nullptr;
  const RansSymbol* table = nullptr;
  std::uint64_t state = 0;
  std::uint32_t precision = 0;
  std::uint8_t* out = nullptr;
  std::size_t left = 0;
  RansStream* stream = nullptr;
};

Lane begin(RansStream& stream) {
  // A symbol adds at most precisionBits, 20, to the state; four bytes are written at once, and four end the stream.
  stream.bytes.resize(std::max(stream.bytes.size(), 3 * stream.symbols.size() + 16));
  Lane lane;
  lane.next = stream.symbols.data() + stream.symbols.size();
  lane.rankOfSymbol = stream.rankOfSymbol;
  lane.table = stream.table;
  lane.precision = 1u << stream.precisionBits;
  lane.state = std::uint64_t{4} << stream.precisionBits;
  lane.out = stream.bytes.data();
  lane.left = stream.symbols.size();
  lane.stream = &stream;
  return lane;
}

/// The state without its lowest value, in as few bytes as hold it; the two highest bits say how many.
void finish(Lane& lane) {
  const auto state = static_cast<std::uint32_t>(lane.state) - 4 * lane.precision;
  const std::uint32_t more = state < (1u << 6) ? 0 : state < (1u << 14) ? 1 : state < (1u << 22) ? 2 : 3;
  putLittleEndian(lane.out, state | (more << (6 + 8 * more)));
  lane.stream->byteCount = static_cast<std::size_t>(lane.out - lane.stream->bytes.data()) + more + 1;
}

inline void push(Lane& lane) noexcept {
  const RansSymbol& symbol = lane.table[lane.rankOfSymbol[*--lane.next]];
  const std::uint64_t limit = static_cast<std::uint64_t>(symbol.probability) << 10;
  std::uint64_t state = lane.state;
  const unsigned bytes = static_cast<unsigned>(state >= limit) + static_cast<unsigned>(state >= limit << 8) +
                         static_cast<unsigned>(state >= limit << 16);
  putLittleEndian(lane.out, static_cast<std::uint32_t>(state));
  lane.out += bytes;
  state >>= 8 * bytes;
  const std::uint64_t quotient = (state * symbol.reciprocal) >> 50;
  lane.state = state + symbol.cumulative + quotient * (lane.precision - symbol.probability);
}

template <std::size_t kLanes>
void pushTogether(std::span<Lane> lanes, std::size_t count) {
  std::array<Lane, kLanes> local;
  std::copy_n(lanes.begin(), kLanes, local.begin());
  for (std::size_t i = 0; i < count; ++i)
    for (Lane& lane : local) push(lane);
  for (Lane& lane : local) lane.left -= count;
  std::copy_n(local.begin(), kLanes, lanes.begin());
}

}  // namespace

void encodeStreams(std::span<RansStream* const> streams) {
  std::array<Lane, 3> lanes;
  std::size_t active = 0;
  for (RansStream* stream : streams) {
    stream->byteCount = 0;
    if (!stream->symbols.empty()) lanes[active++] = begin(*stream);
  }
  while (active > 0) {
    const std::span<Lane> together(lanes.data(), active);
    std::ranges::sort(together, std::greater<>(), &Lane::left);
    const std::size_t count = together.back().left;
    if (active == 3) pushTogether<3>(together, count);
    if (active == 2) pushTogether<2>(together, count);
    if (active == 1) pushTogether<1>(together, count);
    for (; active > 0 && together[active - 1].left == 0; --active) finish(together[active - 1]);
  }
}

}  // namespace terrane
