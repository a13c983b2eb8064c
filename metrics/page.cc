#include "metrics/page.h"

namespace uplink::metrics {

std::string PageText(std::span<const PageSource> sources, Format format) {
  Exposition page;
  for (const PageSource& add_to : sources) add_to(page);
  return page.Text(format);
}

}  // namespace uplink::metrics
