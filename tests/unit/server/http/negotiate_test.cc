#include "server/http/negotiate.h"

#include <gtest/gtest.h>

namespace uplink::http {
namespace {

using metrics::Coding;
using metrics::Format;

TEST(Negotiate, OpenMetricsWhereItIsAskedForAndLikedNoLess) {
  for (const char* accept :
       {"application/openmetrics-text", "application/openmetrics-text; version=1.0.0",
        "application/openmetrics-text;version=1.0.0,application/openmetrics-text;version=0.0.1;"
        "q=0.75,text/plain;version=0.0.4;q=0.5,*/*;q=0.1",
        "text/plain;q=0.5, Application/OpenMetrics-Text ; VERSION=1.0.0 ; Q=0.5"}) {
    EXPECT_EQ(FormatFor(accept), Format::kOpenMetrics) << accept;
  }
  for (const char* accept :
       {"", "*/*", "text/plain", "text/plain;version=0.0.4", "application/json",
        "application/openmetrics-text;q=0", "application/openmetrics-text;version=0.0.1",
        "application/openmetrics-text;q=0.3,text/plain", "application/openmetrics-text;q=x",
        "application/openmetrics-text;q=2", ";;,,;=,q", "openmetrics-text"}) {
    EXPECT_EQ(FormatFor(accept), Format::kText) << accept;
  }
}

TEST(Negotiate, LinesWhereTheyAreNamedAndLikedNoLessThanJson) {
  for (const char* accept :
       {"application/x-ndjson", "application/json;q=0.5, application/X-NDJSON;q=0.5",
        "application/x-ndjson;q=0.1, */*", "application/x-ndjson, application/json"}) {
    EXPECT_TRUE(PrefersLines(accept)) << accept;
  }
  for (const char* accept :
       {"", "*/*", "application/*", "application/json", "application/x-ndjson;q=0",
        "application/x-ndjson;q=0.5, application/json", "application/x-ndjson;q=x", "x-ndjson"}) {
    EXPECT_FALSE(PrefersLines(accept)) << accept;
  }
}

TEST(Negotiate, GzipWhereItIsTaken) {
  for (const char* accept :
       {"gzip", "deflate, gzip", "GZIP;q=0.1", "*", "identity;q=0.5, *;q=0.2"}) {
    EXPECT_EQ(CodingFor(accept), Coding::kGzip) << accept;
  }
  for (const char* accept :
       {"", "identity", "deflate, br", "gzip;q=0", "gzip;q=0, *", "*;q=0", "gzip;q=", "gzipped"}) {
    EXPECT_EQ(CodingFor(accept), Coding::kPlain) << accept;
  }
}

}  // namespace
}  // namespace uplink::http
