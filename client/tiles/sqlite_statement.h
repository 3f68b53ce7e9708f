#pragma once
// SQLite's handles as values that close themselves, and a prepared statement that is used again and again: bind, step,
// read, reset. One thread at a time.

#include <sqlite3.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace terrane {

struct CloseSqliteDatabase {
  void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
};
struct FinalizeSqliteStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
using SqliteDatabase = std::unique_ptr<sqlite3, CloseSqliteDatabase>;

/// A prepared statement, reset after each use.
class SqliteStatement {
 public:
  SqliteStatement() = default;
  SqliteStatement(sqlite3* database, const char* sql) {
    sqlite3_stmt* raw = nullptr;
    code_ = sqlite3_prepare_v3(database, sql, -1, SQLITE_PREPARE_PERSISTENT, &raw, nullptr);
    statement_.reset(raw);
  }
  int code() const { return code_; }
  SqliteStatement& text(int index, std::string_view value) {
    sqlite3_bind_text(statement_.get(), index, value.data(), static_cast<int>(value.size()), SQLITE_STATIC);
    return *this;
  }
  SqliteStatement& blob(int index, std::span<const std::uint8_t> value) {
    sqlite3_bind_blob(statement_.get(), index, value.empty() ? static_cast<const void*>("") : value.data(),
                      static_cast<int>(value.size()), SQLITE_STATIC);
    return *this;
  }
  SqliteStatement& integer(int index, std::int64_t value) {
    sqlite3_bind_int64(statement_.get(), index, value);
    return *this;
  }
  bool step() {
    if (statement_) code_ = sqlite3_step(statement_.get());
    return code_ == SQLITE_ROW;
  }
  std::int64_t integerColumn(int column) const { return sqlite3_column_int64(statement_.get(), column); }
  std::span<const std::uint8_t> blobColumn(int column) const {
    const void* data = sqlite3_column_blob(statement_.get(), column);
    return {static_cast<const std::uint8_t*>(data),
            static_cast<std::size_t>(sqlite3_column_bytes(statement_.get(), column))};
  }
  std::string textColumn(int column) const {
    const auto bytes = blobColumn(column);
    return std::string(bytes.begin(), bytes.end());
  }
  int reset() {
    sqlite3_reset(statement_.get());
    sqlite3_clear_bindings(statement_.get());
    return code_;
  }

 private:
  std::unique_ptr<sqlite3_stmt, FinalizeSqliteStatement> statement_;
  int code_ = SQLITE_OK;
};

}  // namespace terrane
