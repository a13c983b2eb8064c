// A target needs a source; precompiled headers are made for this one.
