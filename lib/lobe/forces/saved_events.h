// Private to the library: how events are stored with the force terms that report them.
#pragma once

#include "lobe/file/fields.h"
#include "lobe/forces/event.h"

namespace lobe::io {

template <>
inline constexpr int enum_size<Event::Kind> = int(std::size(event_names));

}  // namespace lobe::io
