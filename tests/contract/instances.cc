#include "tests/contract/present_contract.h"
#include "tests/contract/store_contract.h"

namespace uplink::testing {

INSTANTIATE_TEST_SUITE_P(Stores, StoreContract, ::testing::Values(FakeKind(), SqliteKind(), PostgresKind()),
                         NameOfKind);
INSTANTIATE_TEST_SUITE_P(Stores, PresentContract, ::testing::Values(FakeKind(), SqliteKind(), PostgresKind()),
                         NameOfKind);

}  // namespace uplink::testing
