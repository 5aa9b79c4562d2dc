// The files of the page, which are in the program itself.
#pragma once

#include <span>

#include "server.h"

namespace lobe::view {

std::span<const PageFile> page_files();

}  // namespace lobe::view
