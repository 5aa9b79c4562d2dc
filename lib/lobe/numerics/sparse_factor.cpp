#include "lobe/numerics/sparse_factor.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <span>

#include "lobe/numerics/fill_ordering.h"

namespace lobe {
namespace {

using Simplicial = Eigen::SimplicialLDLT<SparseFactor::Matrix, Eigen::Lower, FillOrdering>;

class Ldlt : public SparseFactor {
 public:
  const char* name() const override { return "Eigen simplicial LDLT, " LOBE_FILL_ORDERING; }
  bool takes_indefinite() const override { return true; }
  void analyse(const Matrix& A) override {
    const auto lock = lock_fill_ordering();
    factor_.analyzePattern(A);
  }

  // By Sylvester's law D has as many negative entries as A has negative eigenvalues.
  bool factorise(const Matrix& A, Eigen::Index negative) override {
    factor_.factorize(A);
    if (factor_.info() != Eigen::Success) return false;
    const Eigen::VectorXd D = factor_.vectorD();
    return D.allFinite() && (D.array() < 0).count() == negative;
  }
  Eigen::Index size() const override { return factor_.rows(); }
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const override { return factor_.solve(b); }
  Eigen::MatrixXd inverse_block(const std::vector<int>& rows, const std::vector<int>& columns) const override;
  long long nonzeros() const override { return L().nonZeros(); }

 private:
  const Matrix& L() const { return factor_.matrixL().nestedExpression(); }  // without its diagonal of ones

  Simplicial factor_;
};

// Several right-hand sides at once, one row per unknown, so that L is read once for all of them.
constexpr int batch = 32;
using Rows = Eigen::Matrix<double, Eigen::Dynamic, batch, Eigen::RowMajor>;

#if defined(LOBE_X86_KERNELS) && defined(__ELF__)  // Windows has no functions that are chosen at load
#define LOBE_WIDE [[gnu::target_clones("default", "avx2", "avx512f")]]
#else
#define LOBE_WIDE
#endif

struct Column {  // of L, below its diagonal
  const int* row;
  const double* value;
  int count;
};
Column column(const SparseFactor::Matrix& L, Eigen::Index j) {
  const int begin = L.outerIndexPtr()[j];
  return {L.innerIndexPtr() + begin, L.valuePtr() + begin, L.outerIndexPtr()[j + 1] - begin};
}

// x_row −= value × own, for all rows of the column.
LOBE_WIDE void subtract_column(Column column, const double* __restrict x_column, double* __restrict x) {
  for (int e = 0; e < column.count; ++e) {
    double* other = x + std::ptrdiff_t(batch) * column.row[e];
    for (int k = 0; k < batch; ++k) other[k] -= column.value[e] * x_column[k];
  }
}

// own −= Σ value × x_row.
LOBE_WIDE void subtract_rows(Column column, const double* x, double* x_column) {
  double sum[batch];
  for (int k = 0; k < batch; ++k) sum[k] = x_column[k];
  for (int e = 0; e < column.count; ++e) {
    const double* other = x + std::ptrdiff_t(batch) * column.row[e];
    for (int k = 0; k < batch; ++k) sum[k] -= column.value[e] * other[k];
  }
  for (int k = 0; k < batch; ++k) x_column[k] = sum[k];
}

// x = L⁻¹ b. It skips columns that b does not reach: a few unknowns reach only their ancestors in the
// elimination tree.
void forward(const SparseFactor::Matrix& L, Rows& x) {
  for (Eigen::Index j = 0; j < L.cols(); ++j) {
    const Eigen::Matrix<double, 1, batch> row = x.row(j);
    if (!row.isZero(0)) subtract_column(column(L, j), row.data(), x.data());
  }
}

// x = L⁻ᵀ b for the unknowns that are wanted. This takes their ancestors, too.
void backward(const SparseFactor::Matrix& L, const std::vector<char>& wanted, Rows& x) {
  for (Eigen::Index j = L.cols(); j-- > 0;)
    if (wanted[std::size_t(j)]) subtract_rows(column(L, j), x.data(), x.row(j).data());
}

std::vector<char> with_ancestors(const SparseFactor::Matrix& L, std::vector<char> wanted) {
  for (Eigen::Index j = 0; j < L.cols(); ++j) {
    const SparseFactor::Matrix::InnerIterator parent(L, j);
    if (wanted[std::size_t(j)] && parent) wanted[std::size_t(parent.row())] = 1;
  }
  return wanted;
}

Eigen::MatrixXd Ldlt::inverse_block(const std::vector<int>& rows, const std::vector<int>& columns) const {
  const auto& place = factor_.permutationP().indices();
  std::vector<char> wanted(std::size_t(L().cols()), 0);
  for (int i : rows) wanted[std::size_t(place[i])] = 1;
  wanted = with_ancestors(L(), std::move(wanted));
  const Eigen::VectorXd inverse_D = factor_.vectorD().cwiseInverse();
  Eigen::MatrixXd block(Eigen::Index(rows.size()), Eigen::Index(columns.size()));
  Rows x(L().cols(), batch);
  for (Eigen::Index first = 0; first < block.cols(); first += batch) {
    const Eigen::Index count = std::min<Eigen::Index>(batch, block.cols() - first);
    x.setZero();
    for (Eigen::Index c = 0; c < count; ++c) x(place[columns[std::size_t(first + c)]], c) = 1;
    forward(L(), x);
    x.array().colwise() *= inverse_D.array();
    backward(L(), wanted, x);
    for (Eigen::Index i = 0; i < block.rows(); ++i)
      block.row(i).segment(first, count) = x.row(place[rows[std::size_t(i)]]).head(count);
  }
  return block;
}

}  // namespace

Eigen::MatrixXd SparseFactor::solve_all(const Eigen::MatrixXd& B) const {
  Eigen::MatrixXd X(B.rows(), B.cols());
  for (Eigen::Index c = 0; c < B.cols(); ++c) X.col(c) = solve(B.col(c));
  return X;
}

Eigen::MatrixXd SparseFactor::inverse_block(const std::vector<int>& rows,
                                            const std::vector<int>& columns) const {
  Eigen::MatrixXd block(Eigen::Index(rows.size()), Eigen::Index(columns.size()));
  for (std::size_t c = 0; c < columns.size(); ++c)
    block.col(Eigen::Index(c)) = solve(Eigen::VectorXd::Unit(size(), columns[c]))(rows);
  return block;
}

std::unique_ptr<SparseFactor> make_ldlt() { return std::make_unique<Ldlt>(); }

}  // namespace lobe
