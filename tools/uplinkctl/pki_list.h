#pragma once

#include "server/config/flags.h"

namespace uplink::ctl {

/// Adds `pki list` and `pki show`.
void AddPkiList(config::Flags& noun);

}  // namespace uplink::ctl
