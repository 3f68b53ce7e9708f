#include "common/byte_size.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace terrane {
namespace {

TEST(ByteSize, ReadsNumbersWithBinaryAndDecimalUnits) {
  const auto bytes = [](std::string_view text) { return parseByteSize(text, "--memory-cache").value(); };
  EXPECT_EQ(bytes("256MiB"), 256u << 20);
  EXPECT_EQ(bytes("1 GiB"), 1u << 30);
  EXPECT_EQ(bytes("64KiB"), 65536u);
  EXPECT_EQ(bytes("500MB"), 500'000'000u);
  EXPECT_EQ(bytes("3kB"), 3000u);
  EXPECT_EQ(bytes("0"), 0u);
  EXPECT_EQ(bytes("1000000"), 1'000'000u);
  EXPECT_EQ(bytes("7B"), 7u);
  EXPECT_EQ(bytes("1.5GiB"), 3u << 29);
  EXPECT_EQ(bytes("0.3kB"), 300u);
  EXPECT_EQ(bytes("2.9999 KiB"), 3071u);
}

TEST(ByteSize, RefusesEverythingElseAndNamesTheFlag) {
  for (const std::string_view text : {"",
                                      "MiB",
                                      "-1MiB",
                                      "1.GiB",
                                      "1..5GiB",
                                      "1.5B",
                                      "1.5",
                                      ".5GiB",
                                      "1.5e3KiB",
                                      "1.nanMiB",
                                      "256M",
                                      "256mib",
                                      "256 MiB ",
                                      " 256MiB",
                                      "256  MiB",
                                      "1 ",
                                      "0x10",
                                      "1e6",
                                      "+1",
                                      "18446744073709551616",
                                      "99999999999TiB"}) {
    const Result<std::size_t> size = parseByteSize(text, "--memory-cache");
    ASSERT_FALSE(size) << text;
    EXPECT_EQ(size.error().field, "--memory-cache");
    EXPECT_THAT(size.error().message, testing::HasSubstr("MiB")) << text;
  }
}

TEST(ByteSize, IsPrintedAsItIsRead) {
  EXPECT_EQ(formatByteSize(256u << 20), "256 MiB");
  EXPECT_EQ(formatByteSize(1536), "1.5 KiB");
  EXPECT_EQ(formatByteSize(12), "12 B");
}

}  // namespace
}  // namespace terrane
