#include "server/ingest/allowances.h"

#include <utility>

namespace uplink::ingest {

void Allowances::Set(const Allowance& allowance) {
  auto shared = std::make_shared<const Allowance>(allowance);
  const std::lock_guard lock(mutex_);
  allowance_ = std::move(shared);
  version_.fetch_add(1, std::memory_order_release);
}

std::shared_ptr<const Allowance> Allowances::Get() const {
  const std::lock_guard lock(mutex_);
  return allowance_;
}

}  // namespace uplink::ingest
