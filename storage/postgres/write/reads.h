#pragma once

#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include <absl/status/status.h>

#include "storage/postgres/link/connection.h"

namespace uplink::storage::postgres {

/// The calls of a pipeline and what becomes of their answers.
class Reads final {
 public:
  using Take = std::function<void(const Result&)>;
  void Add(
      StoreCall call, Take take = [](const Result&) {}) {
    calls_.push_back(std::move(call));
    takes_.push_back(std::move(take));
  }
  absl::Status Run(Connection& connection) {
    const auto results = connection.Run(calls_, "read what a batch touches");
    if (!results.ok()) return results.status();
    for (std::size_t i = 0; i < takes_.size(); ++i) takes_[i]((*results)[i]);
    return absl::OkStatus();
  }

 private:
  std::vector<StoreCall> calls_;
  std::vector<Take> takes_;
};

}  // namespace uplink::storage::postgres
