// Chooses the vector instructions of the wide kernels when the program starts, so that one binary runs
// anywhere. Every set gives the same bits, because all do the same operations in the same order, without
// fused ones.
#pragma once

#include <vector>

namespace lobe {

enum class InstructionSet { baseline, avx2, avx512 };  // baseline: the set of the whole library

const char* name(InstructionSet set);

// The sets that this processor has and that were compiled, the widest last.
std::vector<InstructionSet> available_instruction_sets();

// The widest of them, or the one named by the environment variable LOBE_INSTRUCTION_SET. Throws InputError if
// it is not available.
InstructionSet chosen_instruction_set();

}  // namespace lobe
