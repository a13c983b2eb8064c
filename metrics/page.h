#pragma once

#include <functional>
#include <span>
#include <string>

#include "metrics/exposition.h"
#include "metrics/format.h"

namespace uplink::metrics {

/// Adds the samples of one component to a page, read from its probe. Any thread.
using PageSource = std::function<void(Exposition&)>;

/// The text of one scrape: a page to which each of the sources adds its samples, in their order.
[[nodiscard]] std::string PageText(std::span<const PageSource> sources, Format format);

}  // namespace uplink::metrics
