#pragma once

#include <memory>
#include <string>

#include "tests/bench/store_load.h"

struct pg_conn;

namespace uplink::bench {

/// The comparator: a loop on libpq alone with the store's own statements, one pipeline a batch.
/// What can be made once is made once; only the numbers are new in each batch. Confined to one
/// thread.
class BarePostgres final {
 public:
  /// Opens the robots and sessions of the shape for `writer`; aborts with libpq's words.
  BarePostgres(const std::string& url, const LoadShape& shape, std::size_t writer);
  /// Commits the next batch; returns its rows.
  std::size_t CommitOne();

 private:
  struct Close {
    void operator()(pg_conn* connection) const;
  };
  void Send(const char* name, const std::vector<std::string>& values);
  void ReadToSync();

  std::unique_ptr<pg_conn, Close> connection_;
  const LoadShape shape_;
  std::vector<std::string> robots_;
  std::string session_;
  /// Parameters that never change, in the order of their statements.
  std::vector<std::string> begin_values_, insert_values_, raise_values_;
  std::uint64_t base_ = 0;
};

}  // namespace uplink::bench
