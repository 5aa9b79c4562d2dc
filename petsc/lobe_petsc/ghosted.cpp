#include "lobe_petsc/ghosted.h"

namespace lobe::petsc {
namespace {

// Access to the memory of the owned vertices and the ghosts, while the object lives.
class Memory {
 public:
  explicit Memory(Vec vec) : vec_(vec) {
    check(VecGhostGetLocalForm(vec_, &form_));
    check(VecGetArray(form_, &data_));
  }
  ~Memory() {
    VecRestoreArray(form_, &data_);
    VecGhostRestoreLocalForm(vec_, &form_);
  }
  Memory(const Memory&) = delete;
  Memory& operator=(const Memory&) = delete;
  Eigen::Map<Mat3X<double>> columns(Index count) const { return {data_, 3, count}; }

 private:
  Vec vec_, form_ = nullptr;
  PetscScalar* data_ = nullptr;
};

}  // namespace

Ghosted::Ghosted(const Ranks& ranks, const Part& part)
    : owned_(part.owned), ghosts_(part.mesh.vertex_count() - part.owned) {
  check(VecCreateGhostBlock(ranks.comm(), 3, 3 * owned_, PETSC_DETERMINE, ghosts_,
                            part.global.data() + owned_, vec_.fill()));
}

Mat3X<double> Ghosted::local() const { return Memory(vec_).columns(owned_ + ghosts_); }

void Ghosted::set_owned(const Mat3X<double>& local) { Memory(vec_).columns(owned_) = local.leftCols(owned_); }

void Ghosted::sum(const Mat3X<double>& local) {
  Memory(vec_).columns(owned_ + ghosts_) = local;
  check(VecGhostUpdateBegin(vec_, ADD_VALUES, SCATTER_REVERSE));
  check(VecGhostUpdateEnd(vec_, ADD_VALUES, SCATTER_REVERSE));
}

void Ghosted::update_ghosts() {
  check(VecGhostUpdateBegin(vec_, INSERT_VALUES, SCATTER_FORWARD));
  check(VecGhostUpdateEnd(vec_, INSERT_VALUES, SCATTER_FORWARD));
}

std::vector<char> any_rank(Ghosted& scratch, const std::vector<char>& mine) {
  Mat3X<double> values = Mat3X<double>::Zero(3, Eigen::Index(mine.size()));
  for (std::size_t v = 0; v < mine.size(); ++v) values(0, Eigen::Index(v)) = mine[v] ? 1 : 0;
  scratch.sum(values);
  scratch.update_ghosts();
  values = scratch.local();
  std::vector<char> any(mine.size());
  for (std::size_t v = 0; v < mine.size(); ++v) any[v] = values(0, Eigen::Index(v)) > 0;
  return any;
}

}  // namespace lobe::petsc
