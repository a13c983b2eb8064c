#pragma once

#include "storage/forget_store.h"
#include "tests/support/fake_forget_requests.h"
#include "tests/support/fake_robot_removal.h"

namespace uplink::testing {

/// Both fakes as one store. For one thread.
class FakeForgetStore final : public storage::ForgetStore {
 public:
  FakeRobotRemoval& removal() override { return removal_; }
  FakeForgetRequests& requests() override { return requests_; }

 private:
  FakeRobotRemoval removal_;
  FakeForgetRequests requests_;
};

}  // namespace uplink::testing
