// The key to the page: who does not name it may not connect.
#pragma once

#include <filesystem>
#include <string>

namespace lobe::view {

std::string random_token();  // 120 random bits in 24 characters

// The token in a file, which nobody but its owner can read from the moment in which it is there. A new one is
// made if there is none; or if others can read the file, or write to it, or it holds no token. If the file
// cannot be written, the token is good for this run only.
std::string kept_token(const std::filesystem::path& file);

// $XDG_STATE_HOME/lobe/view_token, ~/.local/state where that is unset; empty without a home.
std::filesystem::path token_file();

}  // namespace lobe::view
