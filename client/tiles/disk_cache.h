#pragma once
// Tiles kept on disk between runs: one SQLite file, table media(key, content), bounded in bytes, least recently used
// out first. Keys are request targets, which name a revision (a hash of all that shapes the bytes), so that what is
// stored never goes stale. Thread-safe; calls take tens of microseconds, but may wait for the disk: not for the GL
// thread. Two viewers may share a file.
//
// Nothing here can fail in a way that stops a viewer: a damaged file is renamed aside and a new one begun, damaged
// content is deleted and fetched again, a full disk keeps what it has; notice() says so in one line.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.h"

namespace terrane {

class DiskCache {
 public:
  /// Makes the file and its folders if need be. Errors (Io) name the file: it cannot be opened or written, or it is
  /// somebody else's database.
  static Result<std::unique_ptr<DiskCache>> open(const std::string& file, std::size_t budgetBytes);
  ~DiskCache();
  DiskCache(const DiskCache&) = delete;
  DiskCache& operator=(const DiskCache&) = delete;

  /// Empty if it is not there, or was stored damaged (then it is deleted).
  std::optional<std::vector<std::uint8_t>> get(std::string_view key);
  enum class Keep : std::uint8_t { WhileUsed, Always };
  /// Replaces. What is kept Always is the last to go.
  void put(std::string_view key, std::span<const std::uint8_t> content, Keep keep = Keep::WhileUsed);
  void remove(std::string_view key);

  /// Of all content, with its keys.
  std::size_t storedBytes() const;
  /// What the user should know, one line; empty when all is well.
  std::string notice() const;

 private:
  struct State;
  explicit DiskCache(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace terrane
