#pragma once

#include <string_view>
#include <vector>

#include "storage/decide.h"
#include "storage/postgres/link/connection.h"
#include "storage/tables/reports.h"

namespace uplink::storage::postgres {

/// What a batch writes of drones that call, beside what robots report too: the memory of their
/// samples, and their requests to operators. The views and pointers lead into the batch and into
/// what is known of it; both must outlive this.
class DroneRows final {
 public:
  /// What is remembered of samples of one type, and that the drone's claim was used.
  void Keep(std::string_view ruri, const KnownSamples& samples) {
    kept_.push_back({ruri, &samples});
  }
  /// A request that is opened or closed, in order.
  void Add(const OpenedRequest& change) { requests_.push_back(change); }

  void MoveInto(std::vector<StoreCall>& calls) const;

 private:
  struct Kept {
    std::string_view ruri;
    const KnownSamples* samples = nullptr;
  };
  void AddSamples(std::vector<StoreCall>& calls) const;
  void AddRequests(std::vector<StoreCall>& calls) const;

  std::vector<Kept> kept_;
  std::vector<OpenedRequest> requests_;
};

}  // namespace uplink::storage::postgres
