#include "client/tiles/disk_cache.h"

#include <sys/stat.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <limits>
#include <mutex>
#include <thread>
#include <unordered_map>
#include <utility>

#include "client/tiles/sqlite_statement.h"

namespace terrane {
namespace {

constexpr int kApplicationId = 0x54524e43;  // "TRNC"
constexpr int kFormatVersion = 1;
constexpr int kBusyTimeoutMs = 2000;
constexpr std::size_t kTouchesKept = 256;  // last uses are written in batches: a read must not cost a write
constexpr std::int64_t kPinned = std::numeric_limits<std::int64_t>::max();

constexpr const char* kSchema = R"sql(
  CREATE TABLE IF NOT EXISTS media(key TEXT PRIMARY KEY, content BLOB);
  CREATE TABLE IF NOT EXISTS usage(key TEXT PRIMARY KEY, bytes INTEGER NOT NULL, hash INTEGER NOT NULL,
                                   lastUse INTEGER NOT NULL) WITHOUT ROWID;
  CREATE INDEX IF NOT EXISTS usageByAge ON usage(lastUse);
)sql";

std::int64_t contentHash(std::span<const std::uint8_t> content) {
  return static_cast<std::int64_t>(XXH3_64bits(content.data(), content.size()));
}

bool isDamage(int code) { return (code & 0xff) == SQLITE_CORRUPT || (code & 0xff) == SQLITE_NOTADB; }

/// Which file a path leads to now; 0 if none.
ino_t fileIdentity(const std::string& file) {
  struct stat info {};
  return ::stat(file.c_str(), &info) == 0 ? info.st_ino : 0;
}

}  // namespace

struct DiskCache::State {
  std::string file;
  std::size_t budget = 0;
  mutable std::mutex mutex;
  SqliteDatabase database;
  ino_t identity = 0;
  SqliteStatement select, insertMedia, insertUsage, removeMedia, removeUsage, touch, total, oldest;
  std::unordered_map<std::string, std::int64_t> touches;
  std::size_t stored = 0;
  std::int64_t lastTick = 0;
  std::string notice;
  bool broken = false;  ///< could not be opened again: everything is a miss

  ~State() {
    if (database) writeTouches();
  }

  int openFile() {
    sqlite3* raw = nullptr;
    const int opened =
        sqlite3_open_v2(file.c_str(), &raw, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX, nullptr);
    database.reset(raw);
    if (opened != SQLITE_OK) return opened;
    sqlite3_extended_result_codes(raw, 1);
    sqlite3_busy_timeout(raw, kBusyTimeoutMs);
    identity = fileIdentity(file);
    return SQLITE_OK;
  }

  int execute(const std::string& sql) { return sqlite3_exec(database.get(), sql.c_str(), nullptr, nullptr, nullptr); }

  std::int64_t pragma(const char* sql, int& code) {
    SqliteStatement query(database.get(), sql);
    const std::int64_t value = query.step() ? query.integerColumn(0) : 0;
    code = query.code() == SQLITE_ROW ? SQLITE_OK : query.code();
    return value;
  }

  /// SQLite does not wait by itself here when another viewer is opening the same file.
  int enterWriteAheadMode() {
    int code = execute("PRAGMA journal_mode=WAL");
    for (int waitedMs = 0; (code & 0xff) == SQLITE_BUSY && waitedMs < kBusyTimeoutMs; waitedMs += 10) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      code = execute("PRAGMA journal_mode=WAL");
    }
    return code;
  }

  enum class Opened : std::uint8_t { Yes, Damaged, Foreign, Failed };

  /// Opens, checks that the file is ours, makes the tables.
  Opened prepare() {
    int code = openFile();
    if (code != SQLITE_OK) return isDamage(code) ? Opened::Damaged : Opened::Failed;
    // The marks are written before the tables: with this order of reading, another viewer that is making the file
    // cannot be mistaken for a stranger.
    const std::int64_t tables = pragma("SELECT count(*) FROM sqlite_master", code);
    if (code != SQLITE_OK) return isDamage(code) ? Opened::Damaged : Opened::Failed;
    const std::int64_t owner = pragma("PRAGMA application_id", code);
    const std::int64_t version = pragma("PRAGMA user_version", code);
    if (tables > 0 && (owner != kApplicationId || version != kFormatVersion)) return Opened::Foreign;

    // WAL lets another viewer read while this one writes; a power cut may lose the last tiles, which are fetched again.
    code = enterWriteAheadMode();
    if (code != SQLITE_OK) return isDamage(code) ? Opened::Damaged : Opened::Failed;
    code = execute(
        "PRAGMA synchronous=NORMAL; PRAGMA cache_size=-2048; PRAGMA application_id=" + std::to_string(kApplicationId) +
        "; PRAGMA user_version=" + std::to_string(kFormatVersion) + ";" + kSchema);
    if (code == SQLITE_OK) code = prepareStatements();
    if (code == SQLITE_OK) code = countBytes();
    if (code == SQLITE_OK) return Opened::Yes;
    return isDamage(code) ? Opened::Damaged : Opened::Failed;
  }

  int prepareStatements() {
    sqlite3* raw = database.get();
    select = SqliteStatement(raw, "SELECT content, hash FROM media JOIN usage USING(key) WHERE key=?1");
    insertMedia = SqliteStatement(raw, "INSERT OR REPLACE INTO media(key, content) VALUES(?1, ?2)");
    insertUsage =
        SqliteStatement(raw, "INSERT OR REPLACE INTO usage(key, bytes, hash, lastUse) VALUES(?1, ?2, ?3, ?4)");
    removeMedia = SqliteStatement(raw, "DELETE FROM media WHERE key=?1");
    removeUsage = SqliteStatement(raw, "DELETE FROM usage WHERE key=?1");
    touch = SqliteStatement(raw, "UPDATE usage SET lastUse=?2 WHERE key=?1 AND lastUse<?2");
    total =
        SqliteStatement(raw, "SELECT coalesce(sum(bytes), 0), coalesce(max(lastUse), 0) FROM usage WHERE lastUse<=?1");
    oldest = SqliteStatement(raw, "SELECT key, bytes FROM usage ORDER BY lastUse LIMIT 64");
    for (const SqliteStatement* statement :
         {&select, &insertMedia, &insertUsage, &removeMedia, &removeUsage, &touch, &total, &oldest}) {
      if (statement->code() != SQLITE_OK) return statement->code();
    }
    return SQLITE_OK;
  }

  int countBytes() {
    total.integer(1, kPinned);
    if (total.step()) stored = static_cast<std::size_t>(std::max<std::int64_t>(0, total.integerColumn(0)));
    const int code = total.reset();
    return code == SQLITE_ROW ? SQLITE_OK : code;
  }

  void closeDatabase() {
    for (SqliteStatement* statement :
         {&select, &insertMedia, &insertUsage, &removeMedia, &removeUsage, &touch, &total, &oldest}) {
      *statement = SqliteStatement();
    }
    database.reset();
  }

  /// Microseconds, never the same twice, so that two viewers agree on what is old.
  std::int64_t tick() {
    const std::int64_t now =
        std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::system_clock::now().time_since_epoch())
            .count();
    return lastTick = std::max(lastTick + 1, now);
  }

  /// The file is damaged: puts it aside, unless another viewer already has, and begins a new one.
  void recover() {
    const ino_t damaged = identity;
    closeDatabase();
    if (fileIdentity(file) == damaged || damaged == 0) {
      const std::string aside = moveAside();
      notice = aside.empty() ? "the tile cache " + file + " is damaged and cannot be put aside: going on without it"
                             : "the tile cache was damaged; it is kept as " + aside + ", a new one was begun";
      if (aside.empty()) {
        broken = true;
        return;
      }
    }
    touches.clear();
    stored = 0;
    if (prepare() != Opened::Yes) {
      closeDatabase();
      broken = true;
      notice = "the tile cache " + file + " is damaged and no new one can be made: going on without it";
    }
  }

  /// The new name; empty on failure. Never overwrites an earlier one. The log goes along: a database is not whole
  /// without it.
  std::string moveAside() {
    namespace fs = std::filesystem;
    for (int number = 1; number < 1000; ++number) {
      std::string name = file + ".corrupt";
      if (number > 1) name.append("-").append(std::to_string(number));
      std::error_code failure;
      if (fs::exists(name, failure) || failure) continue;
      fs::rename(file, name, failure);
      if (failure) return {};
      for (const char* suffix : {"-wal", "-shm"}) {
        std::error_code ignored;
        fs::rename(file + suffix, name + suffix, ignored);
      }
      return name;
    }
    return {};
  }

  /// True if the statement's outcome is no damage.
  bool usable(int code) {
    if (code == SQLITE_OK || code == SQLITE_DONE || code == SQLITE_ROW) return true;
    if (isDamage(code)) {
      recover();
    } else if ((code & 0xff) == SQLITE_FULL || (code & 0xff) == SQLITE_IOERR || (code & 0xff) == SQLITE_READONLY) {
      notice = std::string("the tile cache cannot be written (") + sqlite3_errstr(code) + "): it keeps what it has";
    }
    return false;
  }

  void writeTouches() {
    if (touches.empty() || broken) return;
    if (execute("BEGIN IMMEDIATE") != SQLITE_OK) return;  // another viewer writes: later
    for (const auto& [key, when] : touches) {
      touch.text(1, key).integer(2, when).step();
      touch.reset();
    }
    touches.clear();
    finishTransaction(SQLITE_OK);
  }

  int finishTransaction(int code) {
    if (code == SQLITE_OK) code = execute("COMMIT");
    if (code != SQLITE_OK) execute("ROLLBACK");
    return code;
  }

  int deleteRow(std::string_view key) {
    removeMedia.text(1, key).step();
    const int media = removeMedia.reset();
    removeUsage.text(1, key).step();
    const int usage = removeUsage.reset();
    return media != SQLITE_DONE ? media : usage != SQLITE_DONE ? usage : SQLITE_OK;
  }

  int insertRow(std::string_view key, std::span<const std::uint8_t> content, Keep keep) {
    insertMedia.text(1, key).blob(2, content).step();
    if (const int code = insertMedia.reset(); code != SQLITE_DONE) return code;
    insertUsage.text(1, key).integer(2, static_cast<std::int64_t>(content.size() + key.size()));
    insertUsage.integer(3, contentHash(content)).integer(4, keep == Keep::Always ? kPinned : tick()).step();
    const int code = insertUsage.reset();
    return code == SQLITE_DONE ? SQLITE_OK : code;
  }

  /// Deletes the least recently used down to 7/8 of the budget, so that not every put pays for it. Inside a
  /// transaction.
  int trim() {
    // Another viewer may have stored or deleted: count afresh before anything goes.
    if (const int code = countBytes(); code != SQLITE_OK) return code;
    while (stored > budget - budget / 8) {
      std::vector<std::pair<std::string, std::size_t>> victims;
      while (oldest.step())
        victims.emplace_back(oldest.textColumn(0), static_cast<std::size_t>(oldest.integerColumn(1)));
      if (const int code = oldest.reset(); code != SQLITE_DONE) return code;
      if (victims.empty()) return SQLITE_OK;
      for (const auto& [key, bytes] : victims) {
        if (stored <= budget - budget / 8) break;
        if (const int code = deleteRow(key); code != SQLITE_OK) return code;
        stored -= std::min(stored, bytes);
      }
    }
    return SQLITE_OK;
  }
};

DiskCache::DiskCache(std::unique_ptr<State> state) : state_(std::move(state)) {}
DiskCache::~DiskCache() = default;

Result<std::unique_ptr<DiskCache>> DiskCache::open(const std::string& file, std::size_t budgetBytes) {
  auto state = std::make_unique<State>();
  state->file = file;
  state->budget = budgetBytes;
  const auto parent = std::filesystem::path(file).parent_path();
  std::error_code failure;
  if (!parent.empty()) std::filesystem::create_directories(parent, failure);
  if (failure) return makeError(ErrorKind::Io, file, "cannot make its folder: " + failure.message());
  if (std::filesystem::exists(file, failure) && !std::filesystem::is_regular_file(file, failure)) {
    return makeError(ErrorKind::Io, file, "is no file");
  }
  switch (state->prepare()) {
    case State::Opened::Yes:
      break;
    case State::Opened::Damaged:
      state->recover();
      if (state->broken) return makeError(ErrorKind::Io, file, state->notice);
      break;
    case State::Opened::Foreign:
      return makeError(ErrorKind::Io, file,
                       "is a database, but no tile cache of this version: choose another file or move it away");
    case State::Opened::Failed: {
      const std::string why = state->database ? sqlite3_errmsg(state->database.get()) : "out of memory";
      return makeError(ErrorKind::Io, file, "cannot open the tile cache: " + why);
    }
  }
  return std::unique_ptr<DiskCache>(new DiskCache(std::move(state)));
}

std::optional<std::vector<std::uint8_t>> DiskCache::get(std::string_view key) {
  const std::lock_guard lock(state_->mutex);
  State& state = *state_;
  if (state.broken) return std::nullopt;
  std::optional<std::vector<std::uint8_t>> content;
  std::int64_t hash = 0;
  if (state.select.text(1, key).step()) {
    const auto bytes = state.select.blobColumn(0);
    content.emplace(bytes.begin(), bytes.end());
    hash = state.select.integerColumn(1);
  }
  const int code = state.select.reset();
  if (!state.usable(code) || !content) return std::nullopt;
  if (hash != contentHash(*content)) {
    state.usable(state.deleteRow(key));
    return std::nullopt;
  }
  state.touches[std::string(key)] = state.tick();
  if (state.touches.size() >= kTouchesKept) state.writeTouches();
  return content;
}

void DiskCache::put(std::string_view key, std::span<const std::uint8_t> content, Keep keep) {
  const std::lock_guard lock(state_->mutex);
  State& state = *state_;
  if (state.broken || content.size() + key.size() > state.budget) return;
  int code = state.execute("BEGIN IMMEDIATE");
  if (code != SQLITE_OK) {
    state.usable(code);
    return;
  }
  code = state.insertRow(key, content, keep);
  if (code == SQLITE_OK) {
    state.stored += content.size() + key.size();
    for (const auto& [used, when] : state.touches) {
      state.touch.text(1, used).integer(2, when).step();
      state.touch.reset();
    }
    if (state.stored > state.budget) code = state.trim();
  }
  state.touches.clear();
  state.usable(state.finishTransaction(code));
}

void DiskCache::remove(std::string_view key) {
  const std::lock_guard lock(state_->mutex);
  if (state_->broken) return;
  state_->usable(state_->deleteRow(key));
}

std::size_t DiskCache::storedBytes() const {
  const std::lock_guard lock(state_->mutex);
  State& state = *state_;
  if (!state.broken) state.usable(state.countBytes());
  return state.stored;
}

std::string DiskCache::notice() const {
  const std::lock_guard lock(state_->mutex);
  return state_->notice;
}

}  // namespace terrane
