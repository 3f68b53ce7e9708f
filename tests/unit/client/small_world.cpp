#include "tests/unit/client/small_world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

#include "proto/tile_url.h"

namespace terrane::testing {
namespace {

using namespace std::chrono_literals;
constexpr auto kGenerous = 60s;
constexpr auto kPoll = 2ms;  // for what no wake tells: the passing of time

}  // namespace

FacePath path(std::string_view text) { return *FacePath::parse(text); }

std::vector<WantedTile> chain(const FacePath& leaf, double errorPixels) {
  std::vector<WantedTile> wanted;
  for (int level = 0; level <= leaf.level(); ++level) {
    wanted.push_back({leaf.ancestor(level), errorPixels * (leaf.level() - level + 1), level == leaf.level()});
  }
  return wanted;
}

std::vector<WantedTile> together(std::initializer_list<std::vector<WantedTile>> sets) {
  std::vector<WantedTile> all;
  std::set<FacePath> seen;
  for (const auto& set : sets) {
    for (const WantedTile& tile : set) {
      if (seen.insert(tile.path).second) all.push_back(tile);
    }
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.path.level() < b.path.level(); });
  return all;
}

std::string target(const FacePath& tile, const std::string& revision) { return tileTarget({revision, "moon", tile}); }

void SmallWorld::start() {
  server_.reset();
  server_ = std::make_unique<FakeServer>([this](const std::string& target) { return answer(target); }, port_);
  port_ = server_->port();
}

int SmallWorld::port() {
  if (port_ == 0) port_ = unusedPort();
  return port_;
}

std::string SmallWorld::url() { return "http://127.0.0.1:" + std::to_string(port()); }

void SmallWorld::setRule(Rule rule) {
  const std::lock_guard lock(mutex_);
  rule_ = std::move(rule);
}

void SmallWorld::setRevision(const std::string& revision) {
  const std::lock_guard lock(mutex_);
  revision_ = revision;
}

int SmallWorld::asked(const std::string& ending) const {
  const std::lock_guard lock(mutex_);
  int count = 0;
  for (const auto& [target, times] : asked_) count += target.ends_with(ending) ? times : 0;
  return count;
}

int SmallWorld::tilesAsked() const { return asked(".glb"); }

FakeReply SmallWorld::answer(const std::string& target) {
  const std::lock_guard lock(mutex_);
  ++asked_[target];
  FakeReply reply;
  if (target == kSceneTarget) {
    reply.body = writeSceneJson(smallScene(revision_));
  } else if (const auto route = parseTarget(target); route && std::holds_alternative<TileAddress>(*route)) {
    const auto& address = std::get<TileAddress>(*route);
    if (address.revision == revision_) {
      reply.body = smallTileBytes(address.path);
    } else {
      reply.status = 410;
    }
  } else {
    reply.status = 404;
  }
  return rule_ ? rule_(target, reply) : reply;
}

SmallWorld::Rule wrongAtFirst(const std::string& ending, int times, const FakeReply& wrong) {
  return [=, left = times](const std::string& asked, const FakeReply& usual) mutable {
    return asked.ends_with(ending) && left-- > 0 ? wrong : usual;
  };
}

SmallWorld::Rule holding(const std::string& ending) {
  return [ending](const std::string& asked, const FakeReply& usual) {
    FakeReply reply = usual;
    reply.hold = asked.ends_with(ending);
    return reply;
  };
}

RunningWorld::RunningWorld(Rule rule) {
  setRule(std::move(rule));
  start();
}

StreamOptions quickOptions(const std::string& url) {
  StreamOptions options;
  options.serverUrl = url;
  options.graceTime = 0ms;
  options.firstBackoff = 5ms;
  options.longestBackoff = 20ms;
  return options;
}

SmallViewer::SmallViewer(const StreamOptions& options) {
  auto stream = TileStream::open(options, [bell = bell_] {
    const std::lock_guard lock(bell->mutex);
    bell->ringing = true;
    bell->rung.notify_all();
  });
  EXPECT_TRUE(stream) << stream.error().text();
  stream_ = std::move(*stream);
}

bool SmallViewer::waitForScene() {
  const auto deadline = std::chrono::steady_clock::now() + kGenerous;
  while (!stream_->scene()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::unique_lock lock(bell_->mutex);
    bell_->rung.wait_for(lock, kPoll);
  }
  stream_->selectBody(0);
  return true;
}

void SmallViewer::frame(const std::vector<WantedTile>& wanted) {
  stream_->want(wanted);
  for (const ArrivedTile& arrived : stream_->takeDecoded(1 << 20)) {
    stream_->markResident(arrived, kGpuBytes);
    uploaded.insert(arrived.tile->metadata.path);
    ++uploads;
  }
  std::vector<FacePath> draw;
  for (const WantedTile& tile : wanted) {
    if (tile.leaf && stream_->resident(tile.path)) draw.push_back(tile.path);
  }
  for (const FacePath& gone : stream_->evict(draw)) {
    evicted.push_back(gone);
    uploaded.erase(gone);
  }
}

bool SmallViewer::settle(const std::vector<WantedTile>& wanted) {
  return stepUntil(wanted, [&] { return stream_->idle(); });
}

bool SmallViewer::stepUntil(const std::vector<WantedTile>& wanted, const std::function<bool()>& reached) {
  const auto deadline = std::chrono::steady_clock::now() + kGenerous;
  for (;;) {
    frame(wanted);
    if (reached()) return true;
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::unique_lock lock(bell_->mutex);
    bell_->rung.wait_for(lock, kPoll);
  }
}

bool SmallViewer::waitForWake() {
  std::unique_lock lock(bell_->mutex);
  const bool rung = bell_->rung.wait_for(lock, kGenerous, [&] { return bell_->ringing; });
  bell_->ringing = false;
  return rung;
}

}  // namespace terrane::testing
