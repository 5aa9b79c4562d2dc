#include "lobe/error.h"

namespace lobe {
namespace {

std::string one_line_each(const std::vector<Fault>& faults) {
  std::string text;
  for (const Fault& fault : faults) {
    if (!text.empty()) text += '\n';
    text += fault.place.empty() ? fault.message : fault.place + ": " + fault.message;
  }
  return text;
}

}  // namespace

InputError::InputError(std::vector<Fault> faults)
    : std::runtime_error(one_line_each(faults)), faults_(std::move(faults)) {}

InputError::InputError(const std::string& place, const std::string& message)
    : InputError(std::vector<Fault>{{place, message}}) {}

}  // namespace lobe
