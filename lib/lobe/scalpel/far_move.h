// When a blade goes too far in a frame: it cuts the tissue where that was at the start of the frame.
#pragma once

namespace lobe {

inline constexpr double far_move = 3;  // least far move in a frame, in mean edges of the mesh

}  // namespace lobe
