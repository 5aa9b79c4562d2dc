// What force terms draw: threads, and the strands of attachments.
#pragma once

#include <string>
#include <vector>

#include "lobe/types.h"

namespace lobe {

// Straight segments of one thread, or of one attachment.
struct TermLines {
  std::string term;                // name of the force term: "threads", "attachments"
  std::string name;                // of the thread or of the attachment
  int number = 0;                  // of the thread, or of the attachment among those that there are
  Mat3X<double> ends{3, 0};        // 3 × 2 #segments: where each begins and ends [m]
  std::vector<double> tensions{};  // per segment [N]
  std::vector<double> damages{};   // per segment: 0 whole … 1 torn; empty: there is none
};

}  // namespace lobe
