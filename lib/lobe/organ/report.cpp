#include "lobe/organ/report.h"

namespace lobe {

const char* name(Condition::Kind kind) {
  switch (kind) {
    case Condition::Kind::diverged:
      return "diverged";
    case Condition::Kind::too_stiff:
      return "too_stiff";
    case Condition::Kind::sub_stepped:
      return "sub_stepped";
    case Condition::Kind::near_inversion:
      return "near_inversion";
    case Condition::Kind::pieces:
      return "pieces";
    case Condition::Kind::everything_cut:
      return "everything_cut";
    case Condition::Kind::unravelling:
      return "unravelling";
    case Condition::Kind::lumped:
      return "lumped";
    case Condition::Kind::scalpel:
      return "scalpel";
    case Condition::Kind::lost_force:
      return "lost_force";
    case Condition::Kind::clip:
      return "clip";
  }
  return "";
}

}  // namespace lobe
