#include "lobe/instruction_set.h"

#include <cstdlib>
#include <string>

#include "lobe/error.h"

namespace lobe {

const char* name(InstructionSet set) {
  switch (set) {
    case InstructionSet::baseline:
      return "baseline";
    case InstructionSet::avx2:
      return "avx2";
    case InstructionSet::avx512:
      return "avx512";
  }
  return "";
}

std::vector<InstructionSet> available_instruction_sets() {
  std::vector<InstructionSet> sets;
#ifdef LOBE_HAS_BASELINE
  sets.push_back(InstructionSet::baseline);
#endif
#ifdef LOBE_HAS_AVX2
  if (__builtin_cpu_supports("avx2")) sets.push_back(InstructionSet::avx2);
#endif
#ifdef LOBE_HAS_AVX512
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw"))
    sets.push_back(InstructionSet::avx512);
#endif
  return sets;
}

InstructionSet chosen_instruction_set() {
  const std::vector<InstructionSet> sets = available_instruction_sets();
  if (sets.empty())
    throw InputError("processor",
                     "this program was compiled only for another kind of processor (LOBE_NATIVE_KERNELS)");
  const char* wanted = std::getenv("LOBE_INSTRUCTION_SET");
  if (!wanted) return sets.back();
  std::string there;
  for (InstructionSet set : sets) {
    if (std::string(wanted) == name(set)) return set;
    there += std::string(there.empty() ? "" : ", ") + name(set);
  }
  throw InputError("LOBE_INSTRUCTION_SET",
                   "\"" + std::string(wanted) +
                       "\" is not among the sets that this processor and this program have: " + there);
}

}  // namespace lobe
