#include "server/http/http_session.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <exception>
#include <string_view>

#include "server/http/problem.h"

namespace terrane::http {

void IoThread::run() {
  for (;;) {
    try {
      context.run();
      return;
    } catch (const std::exception& error) {
      spdlog::error("an I/O thread went on after: {}", error.what());
    }
  }
}

void IoThread::armTick() {
  if (tickArmed || sessions.empty()) return;
  tickArmed = true;
  const auto shortest = std::min({options.headerTimeout, options.idleTimeout, options.writeTimeout,
                                  options.responseTimeout, options.shutdownGrace, kLingerTimeout});
  tick.expires_after(std::clamp(shortest / 4, std::chrono::milliseconds(5), std::chrono::milliseconds(500)));
  tick.async_wait([this](error_code failure) {
    tickArmed = false;
    if (failure) return;
    checkDeadlines();
    armTick();
  });
}

void IoThread::checkDeadlines() {
  const Clock::time_point now = Clock::now();
  const bool graceOver = stopping && now >= graceEnd;
  for (Session* session : sessions) {
    if (graceOver) {
      session->close();
    } else if (now >= session->deadline) {
      session->timedOut = true;
      session->interrupt();
    }
  }
}

void IoThread::beginStop() {
  stopping = true;
  graceEnd = Clock::now() + options.shutdownGrace;
  for (Session* session : sessions)
    if (session->betweenRequests()) session->interrupt();
  work.reset();
}

namespace {

constexpr int kMaxEmptyLines = 4;

/// "METHOD target HTTP/2.0": well formed, of a version that is not served. (Beast calls more than that a bad version.)
bool namesAnotherVersion(std::string_view input) {
  const std::size_t end = input.find("\r\n");
  if (end == std::string_view::npos || end < 8 || std::ranges::count(input.substr(0, end), ' ') != 2) return false;
  const std::string_view version = input.substr(end - 8, 8);
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  return version.starts_with("HTTP/") && digit(version[5]) && version[6] == '.' && digit(version[7]);
}

ReadOutcome classify(const error_code& failure, const Session& session) {
  using Http = boost::beast::http::error;
  if (failure == Http::header_limit)
    return session.fields.requestLineRead ? ReadOutcome::HeaderTooLarge : ReadOutcome::LineTooLong;
  if (failure == Http::bad_version && namesAnotherVersion({session.input.data(), session.used}))
    return ReadOutcome::BadVersion;
  return ReadOutcome::Malformed;
}

}  // namespace

bool beginsRequest(Session& session) {
  const auto input = [&] { return std::string_view(session.input.data(), session.used); };
  if (session.headerBytes > 0) return true;
  for (; session.emptyLines < kMaxEmptyLines && input().starts_with("\r\n"); ++session.emptyLines) session.consume(2);
  return !input().empty() && input() != "\r";
}

std::optional<ReadOutcome> parseInput(Session& session) {
  error_code failure;
  const std::size_t taken = session.parser->put(net::const_buffer(session.input.data(), session.used), failure);
  session.headerBytes += taken;
  session.consume(taken);
  if (session.headerBytes > session.io.options.maxHeaderBytes) return ReadOutcome::HeaderTooLarge;
  if (failure && failure != boost::beast::http::error::need_more) return classify(failure, session);
  if (session.parser->is_header_done()) return ReadOutcome::Request;
  if (session.used == session.input.size())
    return session.fields.requestLineRead ? ReadOutcome::HeaderTooLarge : ReadOutcome::LineTooLong;
  return std::nullopt;
}

std::optional<ServiceResponse> refusal(const Session& session, ReadOutcome outcome) {
  const std::string& target = session.fields.target;
  switch (outcome) {
    case ReadOutcome::Request:
      break;
    case ReadOutcome::Closed:
      return std::nullopt;
    case ReadOutcome::TimedOut:
      return problemResponse(makeError(ErrorKind::Timeout, "header", "the request's header did not end in time"), 408,
                             target);
    case ReadOutcome::LineTooLong:
      return problemResponse(makeError(ErrorKind::TooLarge, "target", "the request line is too long"), 414, "");
    case ReadOutcome::HeaderTooLarge:
      return problemResponse(
          makeError(ErrorKind::TooLarge, "header",
                    fmt::format("the header is too large; allowed: {} bytes", session.io.options.maxHeaderBytes)),
          431, target);
    case ReadOutcome::BadVersion:
      return problemResponse(makeError(ErrorKind::Unsupported, "version", "allowed: HTTP/1.1 and HTTP/1.0"), 505, "");
    case ReadOutcome::Malformed:
      return problemResponse(makeError(ErrorKind::Malformed, "header", "not an HTTP/1.1 request"), 400, target);
  }
  const bool hasBody = session.parser->chunked() || session.parser->content_length().value_or(0) > 0;
  if (hasBody && session.fields.method != HttpMethod::Other)
    return problemResponse(makeError(ErrorKind::TooLarge, "body", "requests here have no body"), 413, target);
  if (session.fields.version == 11 && session.fields.hostFields != 1)
    return problemResponse(makeError(ErrorKind::InvalidArgument, "Host", "HTTP/1.1 requests have one Host field"), 400,
                           target);
  return std::nullopt;
}

}  // namespace terrane::http
