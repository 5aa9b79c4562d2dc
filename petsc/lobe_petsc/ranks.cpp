#include "lobe_petsc/ranks.h"

#include <optional>
#include <string>

namespace lobe::petsc {
namespace {

std::string first_message;  // of PETSc since the last check()

PetscErrorCode keep_message(MPI_Comm, int, const char*, const char*, PetscErrorCode code, PetscErrorType type,
                            const char* message, void*) {
  if (type == PETSC_ERROR_INITIAL) first_message = message ? message : "";
  return code;
}

}  // namespace

void check(PetscErrorCode code) {
  if (code == 0) return;
  const char* text = nullptr;
  PetscErrorMessage(code, &text, nullptr);
  std::string message = "PETSc: " + std::string(text ? text : "error " + std::to_string(code));
  if (!first_message.empty()) message += ": " + std::exchange(first_message, "");
  throw Failure(message);
}

Library::Library(int argc, char** argv) {
  check(PetscInitialize(&argc, &argv, nullptr, nullptr));
  PetscPopSignalHandler();
  check(PetscPushErrorHandler(keep_message, nullptr));
}
Library::~Library() { PetscFinalize(); }

Ranks::Ranks(MPI_Comm comm) : comm_(comm) {
  MPI_Comm_rank(comm_, &rank_);
  MPI_Comm_size(comm_, &count_);
}

std::int64_t Ranks::sum_before(std::int64_t mine) const {
  std::int64_t before = 0;
  MPI_Exscan(&mine, &before, 1, MPI_INT64_T, MPI_SUM, comm_);
  return rank_ == 0 ? 0 : before;
}

std::vector<double> Ranks::gather(double mine) const {
  std::vector<double> all(static_cast<std::size_t>(count_));
  MPI_Allgather(&mine, 1, MPI_DOUBLE, all.data(), 1, MPI_DOUBLE, comm_);
  return all;
}

void Ranks::together(const std::function<void()>& alone) const {
  std::optional<InputError> mine;
  try {
    alone();
  } catch (const InputError& error) {
    mine = error;
  }
  const auto first = int(min(mine ? rank_ : count_));
  if (first == count_) return;
  // Place and message of each fault, each with its end.
  std::string text;
  if (mine && rank_ == first)
    for (const Fault& fault : mine->faults()) text += fault.place + '\0' + fault.message + '\0';
  auto length = static_cast<unsigned long long>(text.size());
  MPI_Bcast(&length, 1, MPI_UNSIGNED_LONG_LONG, first, comm_);
  text.resize(length);
  MPI_Bcast(text.data(), int(length), MPI_CHAR, first, comm_);
  std::vector<Fault> faults;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t middle = text.find('\0', at), end = text.find('\0', middle + 1);
    faults.push_back({text.substr(at, middle - at), text.substr(middle + 1, end - middle - 1)});
    at = end + 1;
  }
  throw InputError(std::move(faults));
}

}  // namespace lobe::petsc
