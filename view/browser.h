// Opens an address in the browser of the desktop.
#pragma once

#include <string>

namespace lobe::view {

// Starts xdg-open, if there is a display. The browser is no child of this program, has a session of its own,
// so that Ctrl+C does not reach it, and has none of its files and sockets.
void open_browser(const std::string& address);

}  // namespace lobe::view
