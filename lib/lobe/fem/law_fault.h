// Whether the moduli of a material make a solid of its law.
#pragma once

#include <string>

#include "lobe/fem/body.h"

namespace lobe {

std::string law_fault(const Elastic& elastic);  // why not; empty: they do

}  // namespace lobe
