// A target needs a source; the precompiled header of all tests is made for this one.
