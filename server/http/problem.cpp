#include "server/http/problem.h"

#include <fmt/format.h>

namespace terrane {
namespace {

constexpr std::size_t kLongestInstance = 256;

/// Bytes beyond ASCII become U+FFFD: all texts here are ours or a peer's, and a peer's are not to be trusted to be
/// UTF-8.
void appendJsonString(std::string& out, std::string_view text) {
  out += '"';
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (byte < 0x20 || byte == 0x7f) {
      out += fmt::format("\\u{:04x}", byte);
    } else if (byte >= 0x80) {
      out += "\\ufffd";
    } else {
      out += c;
    }
  }
  out += '"';
}

void appendMember(std::string& out, std::string_view key, std::string_view value) {
  out += out.empty() ? "{\"" : ",\"";
  out += key;
  out += "\":";
  appendJsonString(out, value);
}

/// A URI reference: what may not stand in one is escaped again.
std::string asUriReference(std::string_view target) {
  std::string uri;
  for (const char c : target.substr(0, kLongestInstance)) {
    const auto byte = static_cast<unsigned char>(c);
    const bool allowed =
        byte > 0x20 && byte < 0x7f && std::string_view("\"<>\\^`{|}").find(c) == std::string_view::npos;
    if (allowed)
      uri += c;
    else
      uri += fmt::format("%{:02X}", byte);
  }
  return uri;
}

}  // namespace

int httpStatus(const Error& error) noexcept {
  switch (error.kind) {
    case ErrorKind::InvalidArgument:
    case ErrorKind::Malformed:
    case ErrorKind::Unsupported:
      return 400;
    case ErrorKind::NotFound:
      return 404;
    case ErrorKind::TooLarge:
      return error.field == "target" ? 414 : 413;
    case ErrorKind::Gone:
      return 410;
    case ErrorKind::Overloaded:
    case ErrorKind::Cancelled:
    case ErrorKind::Timeout:
      return 503;
    case ErrorKind::Io:
    case ErrorKind::Internal:
      return 500;
  }
  return 500;
}

std::string_view reasonPhrase(int status) noexcept {
  switch (status) {
    case 200:
      return "OK";
    case 204:
      return "No Content";
    case 304:
      return "Not Modified";
    case 400:
      return "Bad Request";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 408:
      return "Request Timeout";
    case 410:
      return "Gone";
    case 413:
      return "Content Too Large";
    case 414:
      return "URI Too Long";
    case 431:
      return "Request Header Fields Too Large";
    case 500:
      return "Internal Server Error";
    case 503:
      return "Service Unavailable";
    case 505:
      return "HTTP Version Not Supported";
    default:
      return "Unknown";
  }
}

std::string problemJson(const Error& error, int status, std::string_view instance, std::string_view revision) {
  std::string json;
  appendMember(json, "type", fmt::format("urn:terrane:error:{}", errorKindName(error.kind)));
  appendMember(json, "title", reasonPhrase(status));
  json += fmt::format(",\"status\":{}", status);
  appendMember(json, "detail", error.message);
  if (!error.field.empty()) appendMember(json, "field", error.field);
  if (!instance.empty()) appendMember(json, "instance", asUriReference(instance));
  if (!revision.empty()) appendMember(json, "revision", revision);
  json += "}\n";
  return json;
}

}  // namespace terrane
