// Private to the library: how what force terms keep is read back.
#pragma once

#include <iterator>

#include "lobe/file/fields.h"
#include "lobe/forces/event.h"
#include "lobe/setup/attachment_setup.h"

namespace lobe::io {

template <>
inline constexpr int enum_size<Event::Kind> = int(std::size(event_names));

// One that ends in the world has no second point, which a point by itself may not lack.
template <>
inline void get(ByteReader& in, StrandSetup& strand) {
  get(in, strand.from);
  get(in, strand.to.tet);
  get(in, strand.to.weights);
  get(in, strand.anchor);
  for (double* value : {&strand.length, &strand.stiffness, &strand.area, &strand.reached}) get(in, *value);
  in.expect(strand.is_valid());
}

}  // namespace lobe::io
