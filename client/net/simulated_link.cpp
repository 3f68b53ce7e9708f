#include "client/net/simulated_link.h"

#include <algorithm>

namespace terrane {

void SimulatedLink::answered(Id id, Time made, Time now, std::size_t bytes) {
  onTheirWay_.insert({std::max(now, made + conditions_.latency), nextOrder_++, id, bytes});
}

SimulatedLink::Time SimulatedLink::throughPipe(const Answer& answer) const {
  constexpr std::uint64_t kNanoseconds = 1'000'000'000;
  const Time start = std::max(answer.reachesPipe, pipeFree_);
  if (conditions_.bytesPerSecond == 0) return start;
  // Rounded up, so that no answer is early: at most a nanosecond late each.
  const std::uint64_t product = std::min<std::uint64_t>(answer.bytes, kMostBytes) * kNanoseconds;
  const auto nanoseconds =
      static_cast<std::int64_t>((product + conditions_.bytesPerSecond - 1) / conditions_.bytesPerSecond);
  return start + std::chrono::nanoseconds(nanoseconds);
}

std::optional<SimulatedLink::Time> SimulatedLink::nextDelivery() const {
  if (onTheirWay_.empty()) return std::nullopt;
  return throughPipe(*onTheirWay_.begin());
}

std::vector<SimulatedLink::Id> SimulatedLink::deliver(Time now) {
  std::vector<Id> through;
  while (!onTheirWay_.empty()) {
    const auto first = onTheirWay_.begin();
    const Time time = throughPipe(*first);
    if (time > now) break;
    pipeFree_ = time;
    if (first->id != kNobody) through.push_back(first->id);
    onTheirWay_.erase(first);
  }
  return through;
}

}  // namespace terrane
