// What force terms draw: threads, and the strands of attachments.
#pragma once

#include <string>
#include <vector>

#include "lobe/types.h"

namespace lobe {

// Straight segments of one thread, or of one attachment.
struct TermLines {
  std::string term;                // name of the force term: "threads", "attachments"
  std::string name;                // name of the thread or of the attachment
  int number = 0;                  // number of the thread, or of the attachment among those present
  Mat3X<double> ends{3, 0};        // 3 × 2 #segments: where each begins and ends [m]
  std::vector<double> tensions{};  // tension of each segment [N]
  std::vector<double> damages{};   // damage of each segment: 0 whole … 1 torn; empty: there is none
};

}  // namespace lobe
