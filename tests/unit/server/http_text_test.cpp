// The small texts of HTTP: listen addresses, dates, problem documents.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/http/http_date.h"
#include "server/http/listen_address.h"
#include "server/http/problem.h"

namespace terrane {
namespace {

TEST(ListenAddress, ReadsNamesAndBothKindsOfAddresses) {
  const auto parsed = [](std::string_view text) { return parseListenAddress(text).value(); };
  EXPECT_EQ(parsed("127.0.0.1:8080").host, "127.0.0.1");
  EXPECT_EQ(parsed("127.0.0.1:8080").port, 8080);
  EXPECT_EQ(parsed("[::1]:0").host, "::1");
  EXPECT_EQ(parsed("[::1]:0").port, 0);
  EXPECT_EQ(parsed("localhost:65535").port, 65535);
}

TEST(ListenAddress, RefusesEverythingElseAndNamesTheFlag) {
  for (const std::string_view text :
       {"", "8080", ":8080", "host", "host:", "host:http", "host:-1", "host:65536", "host:80x", "::1:8080", "[::1]",
        "[::1]8080", "[::1]:", "[]:80", "[localhost]:80", "127.0.0.1:80:80", "http://127.0.0.1:80"}) {
    const Result<ListenAddress> address = parseListenAddress(text);
    ASSERT_FALSE(address) << text;
    EXPECT_EQ(address.error().field, "--listen") << text;
    EXPECT_EQ(address.error().kind, ErrorKind::InvalidArgument) << text;
  }
}

TEST(HttpDate, HasTheFormOfRfc9110) {
  EXPECT_EQ(httpDate(784111777), "Sun, 06 Nov 1994 08:49:37 GMT");
  EXPECT_EQ(httpDate(0), "Thu, 01 Jan 1970 00:00:00 GMT");
}

TEST(HttpDate, HeadEndingsFollowTheClockAndTheConnection) {
  HeadEndings endings;
  EXPECT_EQ(endings.at(784111777, HeadEndings::Connection::KeptByDefault),
            "Date: Sun, 06 Nov 1994 08:49:37 GMT\r\n\r\n");
  EXPECT_EQ(endings.at(784111777, HeadEndings::Connection::Closed),
            "Date: Sun, 06 Nov 1994 08:49:37 GMT\r\nConnection: close\r\n\r\n");
  EXPECT_EQ(endings.at(784111778, HeadEndings::Connection::Kept),
            "Date: Sun, 06 Nov 1994 08:49:38 GMT\r\nConnection: keep-alive\r\n\r\n");
}

TEST(Problem, HoldsTheMembersOfRfc9457AndTheField) {
  const Error error = makeError(ErrorKind::Gone, "revision", "the current one is 12");
  EXPECT_EQ(problemJson(error, 410, "/v1/a", "12"),
            R"({"type":"urn:terrane:error:gone","title":"Gone","status":410,"detail":"the current one is 12",)"
            R"("field":"revision","instance":"/v1/a","revision":"12"})"
            "\n");
}

TEST(Problem, AnyBytesMakeValidJson) {
  std::string bytes;
  for (int i = 0; i < 256; ++i) bytes += static_cast<char>(i);
  const std::string json = problemJson(makeError(ErrorKind::Malformed, bytes, bytes), 400, bytes);
  for (const char c : json.substr(0, json.size() - 1)) {
    EXPECT_GE(static_cast<unsigned char>(c), 0x20);
    EXPECT_LT(static_cast<unsigned char>(c), 0x7f);
  }
  EXPECT_THAT(json, testing::HasSubstr(R"(\u0000\u0001)"));
  EXPECT_THAT(json, testing::HasSubstr(R"( !\"#)"));
  EXPECT_THAT(json, testing::HasSubstr(R"([\\])"));
  EXPECT_THAT(json, testing::HasSubstr("%00%01"));
}

TEST(Problem, EveryKindOfErrorHasAStatusThatIsAnError) {
  for (int kind = 0; kind <= static_cast<int>(ErrorKind::Internal); ++kind) {
    const int status = httpStatus(makeError(static_cast<ErrorKind>(kind), "", ""));
    EXPECT_GE(status, 400) << errorKindName(static_cast<ErrorKind>(kind));
    EXPECT_NE(reasonPhrase(status), "Unknown") << status;
  }
}

}  // namespace
}  // namespace terrane
