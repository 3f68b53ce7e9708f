#include "server/config/config_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <optional>
#include <utility>

#include "server/scenes/scene_file.h"
#include "server/scenes/scene_text.h"

namespace terrane {
namespace {

bool isKeyCharacter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
}
bool isControl(char c) { return (static_cast<unsigned char>(c) < 0x20 && c != '\t') || c == 0x7f; }
bool isComment(char c) { return c == '#' || c == ';'; }

class ConfigReader {
 public:
  ConfigReader(std::string_view text, std::string_view fileName) : rest_(text), fileName_(fileName) {}

  Result<std::vector<ConfigEntry>> read() {
    std::vector<ConfigEntry> entries;
    if (rest_.starts_with("\xEF\xBB\xBF")) skip(3);  // a byte order mark
    for (skipLines(); !rest_.empty(); skipLines()) {
      ConfigEntry entry;
      key_.clear();
      if (!readEntry(entry)) return *std::move(error_);
      const auto same = std::ranges::find(entries, entry.key, &ConfigEntry::key);
      if (same != entries.end()) {
        fail(fmt::format("line {} has it already", same->line));
        return *std::move(error_);
      }
      entries.push_back(std::move(entry));
    }
    return entries;
  }

 private:
  bool fail(std::string_view what) {
    error_ = makeError(ErrorKind::Malformed, "",
                       fmt::format("{}:{}: {}{}{}", fileName_, line_, key_, key_.empty() ? "" : ": ", what));
    return false;
  }

  char next() const { return rest_.empty() ? '\n' : rest_.front(); }
  void skip(std::size_t count) { rest_.remove_prefix(count); }
  void skipBlanks() { skip(std::min(rest_.find_first_not_of(" \t\r"), rest_.size())); }

  /// Blanks, and a comment if there is one, to the end of the line.
  bool atLineEnd() {
    skipBlanks();
    if (isComment(next())) skip(std::min(rest_.find('\n'), rest_.size()));
    return next() == '\n';
  }

  void skipLines() {
    while (atLineEnd() && !rest_.empty()) {
      skip(1);
      ++line_;
    }
  }

  bool readEntry(ConfigEntry& entry) {
    if (next() == '[') return fail("sections have no meaning here; allowed: lines like threads = 4");
    const auto end = std::ranges::find_if_not(rest_, isKeyCharacter);
    entry.key = std::string(rest_.begin(), end);
    entry.line = line_;
    if (entry.key.empty()) return fail("no flag at the start of the line; allowed: lines like threads = 4");
    key_ = entry.key;
    skip(entry.key.size());
    if (atLineEnd()) {
      entry.values.emplace_back("true");
      return true;
    }
    if (next() != '=') return fail("no = after it; allowed: lines like threads = 4");
    skip(1);
    skipBlanks();
    if (next() == '[' ? !readList(entry) : !readValue(entry, "#;\n")) return false;
    return atLineEnd() || fail("something follows its value");
  }

  bool readList(ConfigEntry& entry) {
    skip(1);
    for (;;) {
      skipLines();
      if (next() == ']') {
        skip(1);
        return !entry.values.empty() || fail("the list is empty");
      }
      if (rest_.empty()) return fail("the list does not end");
      if (!readValue(entry, ",]#;\n")) return false;
      skipLines();
      if (next() == ',')
        skip(1);
      else if (next() != ']')
        return fail(rest_.empty() ? "the list does not end" : "no comma between the values of a list");
    }
  }

  /// Quoted, or bare up to one of the characters that end it.
  bool readValue(ConfigEntry& entry, std::string_view ends) {
    std::string_view value;
    if (const char quote = next(); quote == '"' || quote == '\'') {
      const std::size_t end = rest_.find_first_of(quote == '"' ? "\"\n" : "'\n", 1);
      if (end == std::string_view::npos || rest_[end] == '\n') return fail("the quotes do not end");
      value = rest_.substr(1, end - 1);
      if (quote == '"' && value.find('\\') != value.npos)
        return fail("a backslash has no meaning between these quotes; allowed: '...'");
      skip(end + 1);
    } else {
      value = rest_.substr(0, rest_.find_first_of(ends));
      skip(value.size());
      value = value.substr(0, value.find_last_not_of(" \t\r") + 1);
    }
    if (value.empty()) return fail("has no value");
    if (std::ranges::any_of(value, isControl)) return fail("a control character is in its value");
    entry.values.emplace_back(value);
    return true;
  }

  std::string_view rest_, fileName_;
  std::size_t line_ = 1;
  std::string key_;
  std::optional<Error> error_;
};

}  // namespace

Result<std::vector<ConfigEntry>> parseConfig(std::string_view text, std::string_view fileName) {
  if (std::optional<Error> error = checkSceneText(text, fileName)) return *std::move(error);
  return ConfigReader(text, fileName).read();
}

Result<std::vector<ConfigEntry>> readConfigFile(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return makeError(ErrorKind::Io, "--config", file + ": cannot be opened");
  std::string text(kMaxSceneFileBytes + 1, '\0');
  if (!stream.read(text.data(), static_cast<std::streamsize>(text.size())) && !stream.eof())
    return makeError(ErrorKind::Io, "--config", file + ": cannot be read");
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return parseConfig(text, file);
}

}  // namespace terrane
