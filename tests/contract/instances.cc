#include "tests/contract/present_contract.h"
#include "tests/contract/store_contract.h"

namespace uplink::testing {

INSTANTIATE_TEST_SUITE_P(Stores, StoreContract, EveryStore(), NameOfKind);
INSTANTIATE_TEST_SUITE_P(Stores, PresentContract, EveryStore(), NameOfKind);

}  // namespace uplink::testing
