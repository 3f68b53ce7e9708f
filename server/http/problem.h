#pragma once
// Errors as HTTP answers: one function maps kinds to statuses, one writes application/problem+json (RFC 9457).
// Thread-safe.

#include <string>
#include <string_view>

#include "common/result.h"

namespace terrane {

int httpStatus(const Error& error) noexcept;
std::string_view reasonPhrase(int status) noexcept;

/// {"type", "title", "status", "detail", "field", "instance"} and, where it is not empty, "revision": the current one.
/// Any bytes may stand in the texts: the document is valid UTF-8 JSON. instance: the request's target, empty if it was
/// not read.
std::string problemJson(const Error& error, int status, std::string_view instance, std::string_view revision = {});

}  // namespace terrane
