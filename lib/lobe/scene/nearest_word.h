// Finds the known word that is nearest to a misspelt one, for "did you mean …?".
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace lobe {

// The known word nearest to a misspelt one by edit distance (insert, delete, replace, swap neighbours), or ""
// if none is near: at most one edit per three letters. O(#known × length²); words over 64 bytes have no
// neighbour.
std::string nearest_word(std::string_view word, const std::vector<std::string>& known);

}  // namespace lobe
