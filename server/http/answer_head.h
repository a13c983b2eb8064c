#pragma once

#include <boost/beast/http/fields.hpp>

#include "server/http/message.h"

namespace uplink::http {

/// Sets the headers that follow from the answer alone, its length among them.
void SetHeaders(const Response& answer, boost::beast::http::fields& head);

}  // namespace uplink::http
