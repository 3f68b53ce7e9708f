#pragma once
// Connections to the server behind a SimulatedLink: answers that have come are held until the model says that they are
// through. The fetch queue makes one only when there is something to simulate; otherwise it talks to the wire, and
// there is no timer and no copy. I/O thread only.
//
// Time limits watch the wire and not the model: an answer that is here and only held is no sign of a dead server, so
// whatever latency and bandwidth are asked for, requests become slow and none of them fails. New connections cost no
// round trip of their own. A held answer that is no longer wanted is read to its end: its connection is free when a
// real one would be.

#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <memory>
#include <unordered_map>

#include "client/net/http_link.h"
#include "client/net/simulated_link.h"

namespace terrane {

class SlowedHttpLinks {
 public:
  SlowedHttpLinks(boost::asio::io_context& io, const NetworkConditions& conditions) : timer_(io), model_(conditions) {}

  /// The links must be closed, or the io_context stopped for good, before this goes.
  std::shared_ptr<HttpLink> slowed(std::shared_ptr<HttpLink> link);

 private:
  class Link;
  void hold(std::shared_ptr<Link> link, SimulatedLink::Time made, std::size_t bytes);
  void abandon(SimulatedLink::Time made, std::size_t bytes);
  void armTimer();
  void deliver();

  boost::asio::steady_timer timer_;
  SimulatedLink model_;
  SimulatedLink::Id nextId_ = SimulatedLink::kNobody + 1;
  std::unordered_map<SimulatedLink::Id, std::shared_ptr<Link>> held_;
};

}  // namespace terrane
