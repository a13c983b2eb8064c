#include "tests/contract/store_contract.h"

namespace uplink::testing {

INSTANTIATE_TEST_SUITE_P(Stores, StoreContract, ::testing::Values(FakeKind(), SqliteKind()),
                         [](const ::testing::TestParamInfo<StoreKind>& kind) {
                           return std::string(kind.param.name);
                         });

}  // namespace uplink::testing
