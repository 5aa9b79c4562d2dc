// The processes of an MPI job, and how they exchange data while a problem is set up.
#pragma once

#include <petscsys.h>

#include <functional>
#include <numeric>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

#include "lobe/error.h"

namespace lobe::petsc {

// A call of PETSc or MPI that failed, with its message.
class Failure : public std::runtime_error {
  using std::runtime_error::runtime_error;
};
void check(PetscErrorCode code);

// Starts MPI and PETSc, and ends them when it is destroyed. Options of PETSc are read from the environment
// (PETSC_OPTIONS).
class Library {
 public:
  Library(int argc, char** argv);
  ~Library();
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
};

class Ranks {
 public:
  explicit Ranks(MPI_Comm comm);

  MPI_Comm comm() const { return comm_; }
  int rank() const { return rank_; }
  int count() const { return count_; }

  // The slice of 0 … n − 1 that a rank begins with: n r / #ranks.
  PetscInt first_of(PetscInt n, int rank) const { return PetscInt(std::int64_t(n) * rank / count_); }
  int holder_of(PetscInt n, PetscInt item) const {
    int rank = int(std::int64_t(item) * count_ / n);
    while (rank + 1 < count_ && first_of(n, rank + 1) <= item) ++rank;
    while (first_of(n, rank) > item) --rank;
    return rank;
  }

  std::int64_t sum(std::int64_t mine) const { return reduce(mine, MPI_INT64_T, MPI_SUM); }
  double sum(double mine) const { return reduce(mine, MPI_DOUBLE, MPI_SUM); }
  double max(double mine) const { return reduce(mine, MPI_DOUBLE, MPI_MAX); }
  double min(double mine) const { return reduce(mine, MPI_DOUBLE, MPI_MIN); }
  std::int64_t sum_before(std::int64_t mine) const;  // over the lower ranks
  std::vector<double> gather(double mine) const;     // each rank's number, on all ranks
  void wait() const { MPI_Barrier(comm_); }

  // Sends each rank its list; returns the list that each rank sent here. No list of more than 2^31 − 1 items.
  template <class Item>
  std::vector<std::vector<Item>> exchange(const std::vector<std::vector<Item>>& to) const {
    static_assert(std::is_trivially_copyable_v<Item>);
    std::vector<int> out(to.size()), in(to.size());
    for (std::size_t r = 0; r < to.size(); ++r) out[r] = int(to[r].size());
    MPI_Alltoall(out.data(), 1, MPI_INT, in.data(), 1, MPI_INT, comm_);
    std::vector<std::vector<Item>> from(to.size());
    std::vector<MPI_Request> requests;
    MPI_Datatype type;
    MPI_Type_contiguous(int(sizeof(Item)), MPI_BYTE, &type);
    MPI_Type_commit(&type);
    for (int r = 0; r < count_; ++r) {
      from[r].resize(std::size_t(in[r]));
      if (in[r] > 0) MPI_Irecv(from[r].data(), in[r], type, r, 0, comm_, &requests.emplace_back());
    }
    for (int r = 0; r < count_; ++r)
      if (out[r] > 0) MPI_Isend(to[r].data(), out[r], type, r, 0, comm_, &requests.emplace_back());
    MPI_Waitall(int(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
    MPI_Type_free(&type);
    return from;
  }
  template <class Item>
  std::vector<Item> gather(const std::vector<Item>& mine) const {  // in the order of ranks, on all ranks
    std::vector<Item> all;
    for (const auto& list : exchange(std::vector<std::vector<Item>>(std::size_t(count_), mine)))
      all.insert(all.end(), list.begin(), list.end());
    return all;
  }

  // Runs work that does not communicate. If it throws InputError on some ranks, all ranks throw that of the
  // lowest of these.
  void together(const std::function<void()>& alone) const;

 private:
  template <class Number>
  Number reduce(Number mine, MPI_Datatype type, MPI_Op operation) const {
    Number all;
    MPI_Allreduce(&mine, &all, 1, type, operation, comm_);
    return all;
  }

  MPI_Comm comm_;
  int rank_ = 0, count_ = 1;
};

// A PETSc object that is destroyed with its owner: Owned<Vec, VecDestroy>.
template <class Object, PetscErrorCode (*destroy)(Object*)>
class Owned {
 public:
  Owned() = default;
  Owned(Owned&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  Owned& operator=(Owned&& other) noexcept {
    std::swap(object_, other.object_);
    return *this;
  }
  ~Owned() {
    if (object_) destroy(&object_);
  }
  operator Object() const { return object_; }
  Object* fill() { return &object_; }

 private:
  Object object_ = nullptr;
};

}  // namespace lobe::petsc
