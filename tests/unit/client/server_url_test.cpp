#include "client/net/server_url.h"

#include <gtest/gtest.h>

namespace terrane {
namespace {

TEST(ServerUrl, ReadsNamesAddressesAndPorts) {
  struct Case {
    const char* text;
    const char* host;
    int port;
    const char* authority;
    const char* origin;
  };
  for (const Case& c : {Case{"http://127.0.0.1:8080", "127.0.0.1", 8080, "127.0.0.1:8080", "http://127.0.0.1:8080"},
                        Case{"http://localhost", "localhost", 80, "localhost", "http://localhost:80"},
                        Case{"http://tiles.example.org:81/", "tiles.example.org", 81, "tiles.example.org:81",
                             "http://tiles.example.org:81"},
                        Case{"HTTP://moon/", "moon", 80, "moon", "http://moon:80"},
                        Case{"http://[::1]:9000", "::1", 9000, "[::1]:9000", "http://[::1]:9000"},
                        Case{"http://[fe80::1:2]/", "fe80::1:2", 80, "[fe80::1:2]", "http://[fe80::1:2]:80"},
                        Case{"http://[::ffff:10.0.0.1]:1", "::ffff:10.0.0.1", 1, "[::ffff:10.0.0.1]:1",
                             "http://[::ffff:10.0.0.1]:1"}}) {
    const auto url = parseServerUrl(c.text);
    ASSERT_TRUE(url) << c.text << ": " << url.error().text();
    EXPECT_EQ(url->host, c.host) << c.text;
    EXPECT_EQ(url->port, c.port) << c.text;
    EXPECT_EQ(url->authority(), c.authority) << c.text;
    EXPECT_EQ(url->origin(), c.origin) << c.text;
  }
}

TEST(ServerUrl, RefusesEverythingElseNamingTheFlag) {
  const std::string_view nul("http://a\0b", 10);
  for (const std::string_view text : {std::string_view(""),
                                      std::string_view("127.0.0.1:8080"),
                                      std::string_view("https://host"),
                                      std::string_view("ftp://host"),
                                      std::string_view("http://"),
                                      std::string_view("http:///"),
                                      std::string_view("http://:80"),
                                      std::string_view("http://host:"),
                                      std::string_view("http://host:0"),
                                      std::string_view("http://host:65536"),
                                      std::string_view("http://host:-1"),
                                      std::string_view("http://host:8x"),
                                      std::string_view("http://host:80/path"),
                                      std::string_view("http://host?query"),
                                      std::string_view("http://user@host"),
                                      std::string_view("http://ho st"),
                                      std::string_view("http://[::1"),
                                      std::string_view("http://[]"),
                                      std::string_view("http://[host]"),
                                      std::string_view("http://[::1]x"),
                                      std::string_view("http://h\r\nX: y"),
                                      std::string_view("http://host:80//"),
                                      nul}) {
    const auto url = parseServerUrl(text);
    ASSERT_FALSE(url) << text;
    EXPECT_EQ(url.error().kind, ErrorKind::InvalidArgument);
    EXPECT_EQ(url.error().field, "--server");
    EXPECT_EQ(url.error().message.find('\n'), std::string::npos);
  }
  EXPECT_FALSE(parseServerUrl("http://" + std::string(300, 'a')));
}

}  // namespace
}  // namespace terrane
