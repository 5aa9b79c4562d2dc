#include "lobe/numerics/supernodal_factor.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "lobe/numerics/fill_ordering.h"
#include "lobe/numerics/supernodes.h"
#include "lobe/numerics/symmetric_sweep.h"

namespace lobe {
namespace {

class Supernodal : public SparseFactor {
 public:
  using Dense = Eigen::MatrixXd;

  const char* name() const override { return "supernodal block LDLT, " LOBE_FILL_ORDERING; }
  bool takes_indefinite() const override { return false; }
  void analyse(const Matrix& A) override;
  bool factorise(const Matrix& A, Eigen::Index negative) override;
  Eigen::Index size() const override { return Eigen::Index(nodes_.place.size()); }
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const override { return solve_few(b); }
  Dense solve_all(const Dense& B) const override;
  Dense inverse_block(const std::vector<int>& rows, const std::vector<int>& columns) const override;
  long long nonzeros() const override { return static_cast<long long>(values_.size()); }

 private:
  using Block = Eigen::Map<const Dense>;
  using Marks = std::vector<char>;           // per supernode
  static constexpr std::size_t batch = 128;  // right-hand sides that are solved for at once
  static constexpr Eigen::Index few = 4;     // vectors, rather than a matrix

  struct Entry {  // of A, in the order: in a column of a supernode
    int row, column;
    int source;  // place among the values of A
  };

  const std::vector<int>& below(int s) const { return nodes_.below[std::size_t(s)]; }
  Block inverse_pivot(int s) const {
    return {values_.data() + begin_[std::size_t(s)], nodes_.width(s), nodes_.width(s)};
  }
  Block L(int s) const {  // below the pivot
    return {
        values_.data() + begin_[std::size_t(s)] + std::size_t(nodes_.width(s)) * std::size_t(nodes_.width(s)),
        Eigen::Index(below(s).size()), nodes_.width(s)};
  }
  void find_places();
  void assemble(const Matrix& A, int s, std::vector<Dense>& updates, std::vector<int>& at,
                Dense& front) const;
  Marks with_ancestors(const std::vector<int>& components) const;
  void solve(Dense& x, const Marks& given, const Marks& wanted) const;
  Dense solve_few(const Dense& B) const;

  Supernodes nodes_;
  std::vector<std::size_t> begin_;           // of each supernode's values, and the end
  std::vector<std::vector<int>> children_;   // of each supernode
  std::vector<std::vector<Entry>> entries_;  // of A, per supernode
  std::vector<double> values_;               // inverse pivot and L of each
};

void Supernodal::analyse(const Matrix& A) {
  nodes_ = find_supernodes(A);
  find_places();
  entries_.assign(std::size_t(nodes_.count()), {});
  for (Eigen::Index j = 0; j < A.cols(); ++j)
    for (int e = A.outerIndexPtr()[j]; e < A.outerIndexPtr()[j + 1]; ++e) {
      const auto [column, row] =
          std::minmax(nodes_.place[std::size_t(j)], nodes_.place[std::size_t(A.innerIndexPtr()[e])]);
      entries_[std::size_t(nodes_.of[std::size_t(column)])].push_back({row, column, e});
    }
}

void Supernodal::find_places() {
  begin_.assign(1, 0);
  children_.assign(std::size_t(nodes_.count()), {});
  for (int s = 0; s < nodes_.count(); ++s) {
    const auto width = std::size_t(nodes_.width(s));
    begin_.push_back(begin_.back() + width * (width + below(s).size()));
    if (const int parent = nodes_.parent(s); parent >= 0) children_[std::size_t(parent)].push_back(s);
  }
}

// Assembles the front of a supernode: the entries of A in its columns, and the updates of its children.
void Supernodal::assemble(const Matrix& A, int s, std::vector<Dense>& updates, std::vector<int>& at,
                          Dense& front) const {
  const int first = nodes_.first[std::size_t(s)], width = nodes_.width(s);
  for (int i = 0; i < width; ++i) at[std::size_t(first + i)] = i;
  for (std::size_t i = 0; i < below(s).size(); ++i)
    at[std::size_t(below(s)[i])] = width + static_cast<int>(i);
  const auto size = width + Eigen::Index(below(s).size());
  front.setZero(size, size);
  for (const Entry& e : entries_[std::size_t(s)])
    front(at[std::size_t(e.row)], e.column - first) = A.valuePtr()[e.source];
  for (int child : children_[std::size_t(s)]) {
    Dense& update = updates[std::size_t(child)];
    const std::vector<int>& rows = below(child);
    for (std::size_t j = 0; j < rows.size(); ++j) {
      double* column = &front(0, at[std::size_t(rows[j])]);
      for (std::size_t i = j; i < rows.size(); ++i)
        column[at[std::size_t(rows[i])]] += update(Eigen::Index(i), Eigen::Index(j));
    }
    update = {};
  }
}

bool Supernodal::factorise(const Matrix& A, Eigen::Index negative) {
  constexpr double loose = 1e-13;  // a pivot of that share of the diagonal's entry is rounding
  values_.resize(begin_.back());
  std::vector<Dense> updates(std::size_t(nodes_.count()));
  std::vector<int> at(nodes_.place.size());
  DenseProducts products;
  Dense front;
  for (int s = 0; s < nodes_.count(); ++s) {
    assemble(A, s, updates, at, front);
    const Eigen::Index width = nodes_.width(s), rows = Eigen::Index(below(s).size());
    if (!sweep(front, width, loose, products)) return false;
    double* values = values_.data() + begin_[std::size_t(s)];
    Eigen::Map<Dense>(values, width, width) =
        -Dense(front.topLeftCorner(width, width).selfadjointView<Eigen::Lower>());
    Eigen::Map<Dense>(values + width * width, rows, width) = front.bottomLeftCorner(rows, width);
    updates[std::size_t(s)] = front.bottomRightCorner(rows, rows);
  }
  return negative == 0;
}

// Marks the supernodes of components, which are given by their places, and all that depend on them.
Supernodal::Marks Supernodal::with_ancestors(const std::vector<int>& components) const {
  Marks marks(std::size_t(nodes_.count()), 0);
  for (int i : components)
    for (int s = nodes_.of[std::size_t(i)]; s >= 0 && !marks[std::size_t(s)]; s = nodes_.parent(s))
      marks[std::size_t(s)] = 1;
  return marks;
}

// Solves for the right-hand sides in the rows of x, which are given in some supernodes and wanted in others.
void Supernodal::solve(Dense& x, const Marks& given, const Marks& wanted) const {
  DenseProducts products;
  for (int s = 0; s < nodes_.count(); ++s) {
    if (!given[std::size_t(s)]) continue;
    auto part = x.middleCols(nodes_.first[std::size_t(s)], nodes_.width(s));
    const Dense others = products.product({part}, {L(s), true});
    for (std::size_t i = 0; i < below(s).size(); ++i) x.col(below(s)[i]) -= others.col(Eigen::Index(i));
    part = products.product({part}, {inverse_pivot(s)});
  }
  for (int s = nodes_.count(); s-- > 0;)
    if (wanted[std::size_t(s)]) {
      const Dense others = x(Eigen::all, below(s));
      products.add(-1, {others}, {L(s)}, x.middleCols(nodes_.first[std::size_t(s)], nodes_.width(s)));
    }
}

// Solves for a few columns. Each supernode of the factor is read once for all of them.
Supernodal::Dense Supernodal::solve_few(const Dense& B) const {
  Dense X(B.rows(), B.cols());
  X(nodes_.place, Eigen::all) = B;
  for (int s = 0; s < nodes_.count(); ++s)
    for (auto x : X.colwise()) {
      auto part = x.segment(nodes_.first[std::size_t(s)], nodes_.width(s));
      const Eigen::VectorXd others = L(s) * part;
      for (std::size_t i = 0; i < below(s).size(); ++i) x[below(s)[i]] -= others[Eigen::Index(i)];
      part = inverse_pivot(s) * Eigen::VectorXd(part);
    }
  for (int s = nodes_.count(); s-- > 0;)
    for (auto x : X.colwise())
      x.segment(nodes_.first[std::size_t(s)], nodes_.width(s)) -= L(s).transpose() * x(below(s));
  return X(nodes_.place, Eigen::all);
}

Supernodal::Dense Supernodal::solve_all(const Dense& B) const {
  if (B.cols() <= few) return solve_few(B);
  Dense X(B.rows(), B.cols());
  for (Eigen::Index begin = 0; begin < B.cols(); begin += batch) {
    const auto b = B.middleCols(begin, std::min(Eigen::Index(batch), B.cols() - begin));
    Dense x(b.cols(), size());
    std::vector<int> given;
    for (Eigen::Index i = 0; i < size(); ++i) {
      const int place = nodes_.place[std::size_t(i)];
      x.col(place) = b.row(i).transpose();
      if (!b.row(i).isZero(0)) given.push_back(place);
    }
    solve(x, with_ancestors(given), Marks(std::size_t(nodes_.count()), 1));
    X.middleCols(begin, b.cols()) = x(Eigen::all, nodes_.place).transpose();
  }
  return X;
}

// Takes columns in the order of the factor, so that those that are solved for at once depend on about the
// same supernodes.
Supernodal::Dense Supernodal::inverse_block(const std::vector<int>& rows,
                                            const std::vector<int>& columns) const {
  const auto place = [&](int i) { return nodes_.place[std::size_t(i)]; };
  std::vector<int> order(columns.size()), places;
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int a, int b) { return place(columns[std::size_t(a)]) < place(columns[std::size_t(b)]); });
  for (int i : rows) places.push_back(place(i));
  const Marks wanted = with_ancestors(places);
  Dense block(Eigen::Index(rows.size()), Eigen::Index(columns.size()));
  for (std::size_t begin = 0; begin < order.size(); begin += batch) {
    const std::size_t count = std::min(batch, order.size() - begin);
    Dense x = Dense::Zero(Eigen::Index(count), size());
    std::vector<int> given;
    for (std::size_t c = 0; c < count; ++c) {
      given.push_back(place(columns[std::size_t(order[begin + c])]));
      x(Eigen::Index(c), given.back()) = 1;
    }
    solve(x, with_ancestors(given), wanted);
    for (std::size_t c = 0; c < count; ++c) block.col(order[begin + c]) = x.row(Eigen::Index(c))(places);
  }
  return block;
}

}  // namespace

std::unique_ptr<SparseFactor> make_supernodal() { return std::make_unique<Supernodal>(); }

}  // namespace lobe
