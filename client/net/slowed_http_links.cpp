#include "client/net/slowed_http_links.h"

#include <utility>

namespace terrane {

using Clock = std::chrono::steady_clock;

class SlowedHttpLinks::Link final : public HttpLink, public std::enable_shared_from_this<Link> {
 public:
  Link(SlowedHttpLinks& owner, std::shared_ptr<HttpLink> wire) : owner_(owner), wire_(std::move(wire)) {}

  void get(const std::string& target, std::function<void(HttpAnswer)> done) override {
    done_ = std::move(done);
    made_ = Clock::now();
    // Not owning: the wire keeps this while it is closed too, and is owned by the link.
    wire_->get(target, [link = weak_from_this()](HttpAnswer answer) {
      const auto self = link.lock();
      if (!self) return;
      self->held_ = std::move(answer);
      self->owner_.hold(self, self->made_, self->held_->bytes);
    });
  }

  bool cheapToFinish() const override { return held_ || wire_->cheapToFinish(); }
  bool used() const override { return wire_->used(); }
  std::size_t bytesReceived() const override { return wire_->bytesReceived(); }

  void close() override {
    if (done_ && !held_) owner_.abandon(made_, wire_->bytesReceived());
    done_ = nullptr;
    wire_->close();
  }

  void release() {
    auto done = std::exchange(done_, nullptr);
    auto answer = std::exchange(held_, std::nullopt);
    if (done) done(std::move(*answer));
  }

 private:
  SlowedHttpLinks& owner_;
  const std::shared_ptr<HttpLink> wire_;
  Clock::time_point made_;
  std::function<void(HttpAnswer)> done_;
  std::optional<HttpAnswer> held_;
};

std::shared_ptr<HttpLink> SlowedHttpLinks::slowed(std::shared_ptr<HttpLink> link) {
  return std::make_shared<Link>(*this, std::move(link));
}

void SlowedHttpLinks::hold(std::shared_ptr<Link> link, SimulatedLink::Time made, std::size_t bytes) {
  const SimulatedLink::Id id = nextId_++;
  held_.emplace(id, std::move(link));
  model_.answered(id, made, Clock::now(), bytes);
  armTimer();
}

void SlowedHttpLinks::abandon(SimulatedLink::Time made, std::size_t bytes) {
  if (bytes > 0) model_.answered(SimulatedLink::kNobody, made, Clock::now(), bytes);
}

void SlowedHttpLinks::armTimer() {
  const auto next = model_.nextDelivery();
  if (!next) return;
  timer_.expires_at(*next);
  timer_.async_wait([this](const boost::system::error_code& code) {
    if (!code) deliver();
  });
}

void SlowedHttpLinks::deliver() {
  for (const SimulatedLink::Id id : model_.deliver(Clock::now()))
    if (const auto held = held_.extract(id)) held.mapped()->release();
  armTimer();
}

}  // namespace terrane
