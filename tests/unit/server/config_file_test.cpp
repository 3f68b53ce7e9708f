#include "server/config/config_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

namespace terrane {
namespace {

using testing::ElementsAre;
using testing::StartsWith;

TEST(ConfigFile, FlagsHaveValuesInQuotesOrWithoutListsAndLines) {
  const auto entries = parseConfig(
      "# a comment\n\nscene = \"a #1.toml\"\nthreads=4 ; INI\r\n  simd = v3  \nlog-level = 'off' # TOML\n"
      "listen = [\"127.0.0.1:1\", '[::1]:2',\n  host:3, # three\n]\ncheck",
      "f");
  ASSERT_TRUE(entries) << entries.error().text();
  std::vector<std::string> keys;
  std::vector<std::size_t> lines;
  for (const ConfigEntry& entry : *entries) {
    keys.push_back(entry.key);
    lines.push_back(entry.line);
  }
  EXPECT_THAT(keys, ElementsAre("scene", "threads", "simd", "log-level", "listen", "check"));
  EXPECT_THAT(lines, ElementsAre(3u, 4u, 5u, 6u, 7u, 10u));
  EXPECT_THAT((*entries)[0].values, ElementsAre("a #1.toml"));
  EXPECT_THAT((*entries)[1].values, ElementsAre("4"));
  EXPECT_THAT((*entries)[2].values, ElementsAre("v3"));
  EXPECT_THAT((*entries)[3].values, ElementsAre("off"));
  EXPECT_THAT((*entries)[4].values, ElementsAre("127.0.0.1:1", "[::1]:2", "host:3"));
  EXPECT_THAT((*entries)[5].values, ElementsAre("true"));
}

TEST(ConfigFile, AnEmptyFileSetsNothing) {
  for (const char* text : {"", "\n", "  ", "# only this", "\r\n; and\n", "\xEF\xBB\xBF# a mark"})
    EXPECT_TRUE(parseConfig(text, "f")->empty());
}

TEST(ConfigFile, WhatIsWrongHasFileLineAndKeyInOnePrintableLine) {
  const std::string binary("\x7f\x45\x4c\x46\x02\x01\x00\x00\n\x1b[31m", 13);
  const std::vector<std::pair<std::string, std::string>> cases{
      {"\n[server]\n", "f:2: sections"},
      {"a = 1\n= 2", "f:2: no flag"},
      {"threads 4", "f:1: threads: no ="},
      {"threads =\n", "f:1: threads: has no value"},
      {"threads = \"\"\n", "f:1: threads: has no value"},
      {"\n\nscene = \"moon\n", "f:3: scene: the quotes"},
      {"scene = \"moon\" 7", "f:1: scene: something follows"},
      {"scene = \"\x1b[31m\"", "f:1: scene: a control character"},
      {"scene = \"mo\\u006fn\"", "f:1: scene: a backslash has no meaning"},
      {"listen = []", "f:1: listen: the list is empty"},
      {"listen = [\"a\"\n", "f:2: listen: the list does not end"},
      {"listen = [", "f:1: listen: the list does not end"},
      {"listen = [\"a\" \"b\"]", "f:1: listen: no comma"},
      {"listen = [a,,b]", "f:1: listen: has no value"},
      {"threads = 1\nio-threads = 2\nthreads = 3", "f:3: threads: line 1 has it already"},
      {"threads = 1\nscene = \xff\xfe", "f:2: not UTF-8"},
      {binary, "f:1: no flag"},
      {std::string(100'000, 'a'), "f: the file has more than"},
      {"\xf0\x9f\x8c\x99 = 1", "f:1: no flag"},
  };
  for (const auto& [text, begin] : cases) {
    const auto entries = parseConfig(text, "f");
    ASSERT_FALSE(entries) << begin;
    EXPECT_THAT(entries.error().text(), StartsWith(begin));
    EXPECT_TRUE(std::ranges::all_of(entries.error().text(), [](char c) { return c >= ' ' && c < 0x7f; })) << begin;
  }
}

TEST(ConfigFile, AFolderAndNoFileNameTheFlag) {
  for (const char* file : {"/", "/no/such/file"}) {
    const auto entries = readConfigFile(file);
    ASSERT_FALSE(entries) << file;
    EXPECT_EQ(entries.error().field, "--config");
    EXPECT_THAT(entries.error().message, StartsWith(file));
  }
}

}  // namespace
}  // namespace terrane
