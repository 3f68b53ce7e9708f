#include "common/command_line.h"

#include <gtest/gtest.h>

#include <vector>

namespace terrane {
namespace {

Result<void> check(const std::vector<std::string>& words) {
  return checkFlagValues(words, [](std::string_view flag) {
    if (flag == "--server" || flag == "--camera") return FlagKind::TakesValue;
    return flag == "--headless" ? FlagKind::Switch : FlagKind::Unknown;
  });
}

TEST(CommandLine, AFlagThatNeedsAValueDoesNotSwallowTheNextFlag) {
  const auto swallowed = check({"--headless", "--server", "--settle"});
  ASSERT_FALSE(swallowed);
  EXPECT_EQ(swallowed.error().field, "--server");
  EXPECT_NE(swallowed.error().message.find("\"--settle\""), std::string::npos) << swallowed.error().message;
  EXPECT_FALSE(check({"--server", "--"}));
  EXPECT_TRUE(check({"--server=--settle"})) << "said outright";
  EXPECT_TRUE(check({"--server"})) << "the parser's to refuse";
}

TEST(CommandLine, AnEmptyValueIsNone) {
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"--server", "", "--headless"}, {"--server="}, {"--server=", "x"}}) {
    const auto empty = check(words);
    ASSERT_FALSE(empty);
    EXPECT_EQ(empty.error().field, "--server");
  }
  EXPECT_TRUE(check({"--headless", ""})) << "no value of that flag";
}

TEST(CommandLine, ASwitchTakesNoValue) {
  for (const char* word : {"--headless=7", "--headless=true", "--headless="}) {
    const auto given = check({"--server", "x", word});
    ASSERT_FALSE(given) << word;
    EXPECT_EQ(given.error().field, "--headless");
  }
  EXPECT_TRUE(check({"--headless", "7"})) << "a stray word, the parser's to refuse";
  EXPECT_TRUE(check({"--hedless=7"})) << "no such flag: the parser says so";
}

TEST(CommandLine, WhatBeginsWithOneDashIsAValue) {
  EXPECT_TRUE(check({"--camera", "-20,10,5", "--server", "-"}));
  EXPECT_TRUE(check({"--camera=-20,10,5"}));
  EXPECT_TRUE(check({"--server", "x", "--", "--server", ""})) << "after -- there are no flags";
}

TEST(CommandLine, OnlyWhatTheUserWroteIsWrongUsage) {
  EXPECT_EQ(exitStatus(makeError(ErrorKind::InvalidArgument, "--x", "")), 2);
  for (const ErrorKind kind : {ErrorKind::Io, ErrorKind::Timeout, ErrorKind::Internal, ErrorKind::Unsupported})
    EXPECT_EQ(exitStatus(makeError(kind, "--x", "")), 1);
}

}  // namespace
}  // namespace terrane
