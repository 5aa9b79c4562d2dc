// Private to io/: the arrays of a VTU file in all their encodings.
#pragma once

#include <pugixml.hpp>

#include "lobe/io/numeric.h"

namespace lobe::io {

// What a VTU file says about itself, and its appended data, which is cut away before the XML is parsed: raw
// bytes are no XML.
struct VtuContext {
  std::string file;
  std::string_view xml;       // the file without its appended data, for line numbers
  std::string_view appended;  // the appended data after its '_'
  bool appended_base64 = false;
  bool swap = false;
  bool wide_headers = false;  // 64-bit
  bool zlib = false;
};

// "cube.vtu:12: DataArray 'Points'"
std::string place_of(const VtuContext& context, const pugi::xml_node& node);

// The numbers of a DataArray, of strings their bytes; throws InputError.
std::vector<double> read_data_array(const VtuContext& context, const pugi::xml_node& array);

}  // namespace lobe::io
