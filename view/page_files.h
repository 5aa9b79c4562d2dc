// The files of the page, which are compiled into the program.
#pragma once

#include <span>

#include "server.h"

namespace lobe::view {

std::span<const PageFile> page_files();

}  // namespace lobe::view
