// What libFuzzer calls with one input after the other; run_corpus.cpp with the committed ones.
#pragma once

#include <cstddef>
#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
