#include "storage/postgres/link_options.h"

#include <utility>

namespace uplink::storage::postgres {
namespace {

/// How much longer than a statement of a reader may take its answer may.
constexpr milliseconds kAnswerSlack{500};

template <typename Options>
absl::StatusOr<Link::Options> ServerOf(const Options& options) {
  absl::StatusOr<Url> url = ParseUrl(options.url);
  if (!url.ok()) return url.status();
  Link::Options link;
  link.connection.url = *std::move(url);
  link.connection.password_file = options.password_file;
  link.connection.connect_timeout = options.connect_timeout;
  return link;
}

}  // namespace

absl::StatusOr<Link::Options> LinkOptionsOf(const StoreOptions& options) {
  absl::StatusOr<Link::Options> link = ServerOf(options);
  if (!link.ok()) return link;
  link->connection.call_timeout = options.call_timeout;
  link->connection.session_settings = SessionSettings(Purpose::kWrite, options.call_timeout);
  link->connection.wants_writes = true;
  link->accept_unsafe = options.accept_unsafe;
  return link;
}

absl::StatusOr<Link::Options> LinkOptionsOf(const ReaderOptions& options) {
  absl::StatusOr<Link::Options> link = ServerOf(options);
  if (!link.ok()) return link;
  // The server ends a statement first; this is for one that does not answer at all.
  link->connection.call_timeout = options.statement_timeout + kAnswerSlack;
  link->connection.session_settings = SessionSettings(Purpose::kRead, options.statement_timeout);
  link->purpose = Purpose::kRead;
  return link;
}

}  // namespace uplink::storage::postgres
