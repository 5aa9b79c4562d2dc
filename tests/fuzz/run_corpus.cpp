// Without libFuzzer: every file of the folders that are named is one input, and so is each with one byte
// changed.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "fuzz/target.h"

namespace {

void run(const std::string& bytes) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

}  // namespace

int main(int argc, char** argv) {
  std::size_t inputs = 0;
  for (int i = 1; i < argc; ++i)
    for (const auto& entry : std::filesystem::directory_iterator(argv[i])) {
      std::ifstream in(entry.path(), std::ios::binary);
      const std::string bytes(std::istreambuf_iterator<char>(in), {});
      run(bytes);
      const std::size_t stride = std::max<std::size_t>(1, bytes.size() / 200);
      for (std::size_t at = 0; at < bytes.size(); at += stride) {
        std::string changed = bytes;
        changed[at] = static_cast<char>(changed[at] ^ 0x15);
        run(changed);
      }
      ++inputs;
    }
  std::printf("%zu files\n", inputs);
  return inputs > 0 ? 0 : 1;
}
