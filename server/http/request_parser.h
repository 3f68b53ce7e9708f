#pragma once
// Reads one request's header with Beast's parser and keeps only what the service looks at, in strings that a session
// uses again for every request: nothing is allocated in the steady state. Included by http_server.cpp alone.

#include <boost/beast/http/basic_parser.hpp>
#include <string>

#include "server/http/tile_service.h"

namespace terrane {

struct RequestFields {
  HttpMethod method = HttpMethod::Other;
  std::string target;
  std::string ifNoneMatch;
  int version = 11;  ///< 10 or 11
  int hostFields = 0;
  bool requestLineRead = false;

  void clear() noexcept {
    method = HttpMethod::Other;
    target.clear();
    ifNoneMatch.clear();
    version = 11;
    hostFields = 0;
    requestLineRead = false;
  }
};

class RequestParser final : public boost::beast::http::basic_parser<true> {
 public:
  using error_code = boost::beast::error_code;
  using string_view = boost::beast::string_view;

  explicit RequestParser(RequestFields& fields) : fields_(&fields) { fields.clear(); }

 private:
  void on_request_impl(boost::beast::http::verb method, string_view, string_view target, int version,
                       error_code&) override {
    using boost::beast::http::verb;
    fields_->method = method == verb::get       ? HttpMethod::Get
                      : method == verb::head    ? HttpMethod::Head
                      : method == verb::options ? HttpMethod::Options
                                                : HttpMethod::Other;
    fields_->target.assign(target.data(), target.size());
    fields_->version = version;
    fields_->requestLineRead = true;
  }

  void on_field_impl(boost::beast::http::field name, string_view, string_view value, error_code&) override {
    using boost::beast::http::field;
    if (name == field::host) ++fields_->hostFields;
    if (name == field::if_none_match) {
      if (!fields_->ifNoneMatch.empty()) fields_->ifNoneMatch += ',';
      fields_->ifNoneMatch.append(value.data(), value.size());
    }
  }

  // Bodies are not read: a request that has one is refused.
  void on_response_impl(int, string_view, int, error_code&) override {}
  void on_header_impl(error_code&) override {}
  void on_body_init_impl(const boost::optional<std::uint64_t>&, error_code&) override {}
  std::size_t on_body_impl(string_view body, error_code&) override { return body.size(); }
  void on_chunk_header_impl(std::uint64_t, string_view, error_code&) override {}
  std::size_t on_chunk_body_impl(std::uint64_t, string_view body, error_code&) override { return body.size(); }
  void on_finish_impl(error_code&) override {}

  RequestFields* fields_;
};

}  // namespace terrane
