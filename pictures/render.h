// One picture, from its request to its file.
#pragma once

#include "request.h"

namespace picture {

// Throws std::runtime_error with one line. The file is whole or absent.
void render(const Picture& picture);

}  // namespace picture
