// Whatever the bytes, a request of the page is read or refused with an InputError, and so are the blocks of a
// frame.
#include <string_view>

#include "fuzz/target.h"
#include "lobe/error.h"
#include "protocol.h"

using namespace lobe;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes{reinterpret_cast<const char*>(data), size};
  try {
    view::parse_request(bytes);
  } catch (const InputError&) {
  }
  try {
    view::read_blocks(bytes);
  } catch (const InputError&) {
  }
  return 0;
}
