// Bad input: thrown while loading or building, never by a time step.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace lobe {

// One fault: where it is ("liver.vtu: tetrahedron 12", "/regions/2/model"), and what was found, what was
// expected, and the remedy.
struct Fault {
  std::string place;
  std::string message;
};

// Everything that is wrong with one input, so that the user sees all of it at once.
class InputError : public std::runtime_error {
 public:
  explicit InputError(std::vector<Fault> faults);
  InputError(const std::string& place, const std::string& message);

  const std::vector<Fault>& faults() const { return faults_; }

 private:
  std::vector<Fault> faults_;
};

}  // namespace lobe
